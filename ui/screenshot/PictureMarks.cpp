// SPDX-License-Identifier: MIT
#include "ui/screenshot/PictureMarks.h"

#include "ui/marks/ScaleBar.h"
#include "ui/measure/MeasurePainting.h"

#include <QImage>
#include <QPainter>

#include <algorithm>

namespace punctum::ui
{

namespace
{

constexpr double kPictureEdge = 12.0;  ///< px of the marks, between them and the picture's edge
constexpr double kUsualWidth = 1280.0, kUsualHeight = 800.0;  // px

}  // namespace

double markScaleFor(int width, int height)
{
    return std::max(1.0, std::min(width / kUsualWidth, height / kUsualHeight));
}

void paintMarks(QImage& picture, const PictureMarks& marks)
{
    const double scale = marks.style.scale;
    QPainter painter(&picture);
    painter.setRenderHint(QPainter::Antialiasing);

    // These find their places by the camera, in px of the marks.
    const QSizeF logical = QSizeF(picture.size()) / scale;
    painter.save();
    painter.scale(scale, scale);
    painter.setFont(marks.style.font);
    if (marks.ruler) paintRuler(painter, *marks.ruler, marks.camera, logical);
    for (const Measurement& measurement : marks.measurements)
        paintMeasurement(painter, measurement, marks.camera, logical, false);
    painter.restore();

    const double edge = kPictureEdge * scale, width = picture.width(), height = picture.height();
    double barRight = 0.0, barTop = height;
    if (marks.scaleBar || marks.northArrow) {
        ScaleBar bar = scaleBarOf(marks.camera, height, scale, marks.unit);
        bar.bar = bar.bar && marks.scaleBar;
        bar.arrow = marks.northArrow;
        const QSizeF size = scaleBarSize(bar, marks.style);
        const QPointF corner(edge, height - edge - size.height());
        paintScaleBar(painter, corner, bar, marks.style);
        barRight = edge + size.width();
        barTop = corner.y();
    }
    if (marks.legend.empty()) return;
    const QSizeF whole(width - 2 * edge, height - 2 * edge);
    QSizeF room = whole;
    if (width - edge - legendSize(marks.legend, marks.style, whole).width() <= barRight)
        room.setHeight(barTop - 2 * edge);
    const QSizeF size = legendSize(marks.legend, marks.style, room);
    const double bottom = room.height() < whole.height() ? barTop : height;
    paintLegend(painter, {width - edge - size.width(), bottom - edge - size.height()}, marks.legend, marks.style,
                room);
}

}  // namespace punctum::ui
