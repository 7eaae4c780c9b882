// SPDX-License-Identifier: MIT
#pragma once

#include "render/camera/Camera.h"
#include "ui/marks/MarkStyle.h"

#include <QPointF>
#include <QSizeF>
#include <QString>

namespace punctum::ui
{

/// The north arrow and the scale bar of a camera; the scale holds at the depth of its pivot.
struct ScaleBar {
    double yaw = 0.0;     ///< of the camera, radians
    double length = 0.0;  ///< of the bar, px of the mark (before MarkStyle::scale)
    QString text;         ///< "50 m"; "50 units" where nobody knows of what
    bool arrow = true;    ///< whether there is a north arrow ...
    bool bar = true;      ///< ... and a bar
    friend bool operator==(const ScaleBar&, const ScaleBar&) = default;
};

/// `pictureHeightPx`: of the whole picture; `scale`: as in the MarkStyle that it is drawn with; `unit`: of what the
/// camera sees, "" where it is not known. A camera that has never been pointed at anything, since there are no
/// points, has no bar.
ScaleBar scaleBarOf(const render::Camera& camera, double pictureHeightPx, double scale, const QString& unit);

/// Width and height in px of the painter.
QSizeF scaleBarSize(const ScaleBar& bar, const MarkStyle& style);
/// Draws north arrow and bar, of scaleBarSize(), with the top left corner at `corner`.
void paintScaleBar(QPainter& painter, QPointF corner, const ScaleBar& bar, const MarkStyle& style);

/// 1, 2 or 5 times a power of ten: the longest round length that is not above `limit`. 0 for limits <= 0.
double roundLengthUpTo(double limit);
/// "50 m", "2 km", "5 mm", "20 ft", "50 units": a round length with its unit.
QString roundLengthText(double length, const QString& unit);

}  // namespace punctum::ui
