// SPDX-License-Identifier: MIT
#include "ui/surface/SurfaceLine.h"

#include <QPainter>

#include <algorithm>

namespace punctum::ui
{

void SurfaceLine::setPieces(std::vector<std::vector<glm::dvec3>> pieces)
{
    m_pieces = std::move(pieces);
    setVisible(!m_pieces.empty());
    update();
}

void SurfaceLine::paintEvent(QPaintEvent*)
{
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    const glm::dvec2 size(std::max(1, width()), std::max(1, height()));
    for (const bool shadow : {true, false}) {
        painter.setPen(shadow ? QPen(QColor(0, 0, 0, 150), 3.4) : QPen(QColor(255, 196, 92), 1.6));
        for (const std::vector<glm::dvec3>& piece : m_pieces) {
            QPolygonF line;
            for (const glm::dvec3& place : piece) {
                const glm::dvec3 p = camera().project(place, size);
                line << QPointF(p.x, p.y);
            }
            painter.drawPolyline(line);
        }
    }
}

}  // namespace punctum::ui
