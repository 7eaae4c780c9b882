// SPDX-License-Identifier: MIT
#include "ui/measure/MeasurePainting.h"

#include "ui/measure/Measurements.h"

#include <QPainter>

#include <algorithm>
#include <array>
#include <optional>

namespace punctum::ui
{

namespace
{

constexpr double kDot = 4.0;  ///< px, radius of a point's mark
const QColor kLine(255, 209, 92);
const QColor kUnfinishedLine(255, 255, 255);
const QColor kPlate(12, 14, 16, 215);
const QColor kPlateText(240, 242, 245);

/// The edges of the box between two opposite corners, as pairs of its eight corners; bit k: the second on axis k.
constexpr std::array<std::array<int, 2>, 12> kEdges{
    {{0, 1}, {2, 3}, {4, 5}, {6, 7}, {0, 2}, {1, 3}, {4, 6}, {5, 7}, {0, 4}, {1, 5}, {2, 6}, {3, 7}}};

void drawMeasurement(QPainter& painter, const Measurement& m, const render::Camera& camera, QSizeF size,
                     bool unfinished)
{
    const auto place = [&](const glm::dvec3& world) -> std::optional<QPointF> {
        const glm::dvec3 px = camera.project(world, {std::max(1.0, size.width()), std::max(1.0, size.height())});
        if (!(px.z >= camera.nearDepth())) return {};
        return QPointF(px.x, px.y);
    };
    const auto& points = m.points;
    const auto line = [&](const glm::dvec3& a, const glm::dvec3& b) {
        const auto from = place(a), to = place(b);
        if (from && to) painter.drawLine(*from, *to);
    };
    for (const bool shadow : {true, false}) {
        painter.setPen(
            shadow ? QPen(QColor(0, 0, 0, 150), 4.0)
                   : QPen(unfinished ? kUnfinishedLine : kLine, 1.8, unfinished ? Qt::DashLine : Qt::SolidLine));
        if (m.kind == MeasureKind::Box && points.size() == 2) {
            const auto corner = [&](int bits) {
                glm::dvec3 at = points[0].world;
                for (int axis = 0; axis < 3; ++axis)
                    if ((bits >> axis & 1) != 0) at[axis] = points[1].world[axis];
                return at;
            };
            for (const auto& [a, b] : kEdges) line(corner(a), corner(b));
        } else if (m.kind == MeasureKind::Height && points.size() == 2) {
            const glm::dvec3 knee(points[1].world.x, points[1].world.y, points[0].world.z);
            line(points[0].world, knee);
            line(knee, points[1].world);
        } else {
            for (std::size_t k = 1; k < points.size(); ++k) line(points[k - 1].world, points[k].world);
            if ((m.kind == MeasureKind::Area || m.kind == MeasureKind::Volume) && points.size() > 2)
                line(points.back().world, points.front().world);
        }
    }
    glm::dvec3 middle(0.0);
    for (const MeasuredPoint& p : points) {
        middle += p.world / double(points.size());
        const auto at = place(p.world);
        if (!at) continue;
        painter.setPen(QPen(QColor(0, 0, 0, 170), 1.5));
        painter.setBrush(unfinished ? kUnfinishedLine : kLine);
        painter.drawEllipse(*at, kDot, kDot);
    }
    if (m.quantities.empty()) return;
    if (m.kind == MeasureKind::Angle) middle = points[1].world;
    const auto at = place(middle);
    if (!at) return;
    const QString text = m.kind == MeasureKind::Point ? Measurements::tr("Point %1").arg(points.front().index)
                                                      : quantityText(m.quantities.front(), m.length);
    const QFontMetricsF metrics(painter.font());
    QRectF plate(0, 0, metrics.horizontalAdvance(text) + 14, metrics.height() + 6);
    plate.moveCenter(*at - QPointF(0, plate.height() / 2 + kDot + 6));
    painter.setPen(Qt::NoPen);
    painter.setBrush(kPlate);
    painter.drawRoundedRect(plate, 5, 5);
    painter.setPen(kPlateText);
    painter.drawText(plate, Qt::AlignCenter, text);
}

}  // namespace

void paintMeasurement(QPainter& painter, const Measurement& m, const render::Camera& camera, QSizeF size,
                      bool unfinished)
{
    painter.save();
    painter.setRenderHint(QPainter::Antialiasing);
    drawMeasurement(painter, m, camera, size, unfinished);
    painter.restore();
}

}  // namespace punctum::ui
