// SPDX-License-Identifier: MIT
#pragma once

#include "core/measure/Measurement.h"
#include "render/camera/Camera.h"
#include "ui/marks/Legend.h"
#include "ui/marks/MarkStyle.h"
#include "ui/section/SectionOverlays.h"

#include <QString>

#include <optional>
#include <vector>

class QImage;

namespace punctum::ui
{

/// What is drawn on a picture that is saved: a value that knows no view, so that a job or the command line draws
/// it.
struct PictureMarks {
    MarkStyle style;        ///< its scale: px of the picture for each px of the marks
    render::Camera camera;  ///< that took the picture
    Legend legend;          ///< empty: none
    bool scaleBar = false, northArrow = false;
    QString unit;  ///< of what the camera sees, "" where it is not known
    std::vector<Measurement> measurements;
    std::optional<RulerMarks> ruler;  ///< of a section
};

/// How much larger marks are on a picture of this size than on a usual window, so that they stay readable when it
/// is looked at as a whole: at least 1.
double markScaleFor(int width, int height);

/// Draws them: the bar at the lower left, the legend at the lower right, or above the bar where both do not fit
/// beside each other. Any thread.
void paintMarks(QImage& picture, const PictureMarks& marks);

}  // namespace punctum::ui
