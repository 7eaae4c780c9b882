// SPDX-License-Identifier: MIT
#pragma once

#include "core/measure/Measurement.h"
#include "render/camera/Camera.h"

#include <QSizeF>

class QPainter;

namespace punctum::ui
{

/// Draws a measurement over a picture of this size (logical px) that the camera took: its points, lines, and its
/// value as far as it has one. `unfinished`: as one that is being made. Any thread, as painting on images is.
void paintMeasurement(QPainter& painter, const Measurement& measurement, const render::Camera& camera, QSizeF size,
                      bool unfinished);

}  // namespace punctum::ui
