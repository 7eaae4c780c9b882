// SPDX-License-Identifier: MIT
#include "ui/ClipFrame.h"

#include "ui/style/Theme.h"

#include <QPainter>

namespace punctum::ui
{

ClipFrame::ClipFrame(QWidget* parent) : QWidget(parent)
{
    setAttribute(Qt::WA_TransparentForMouseEvents);
    hide();
}

void ClipFrame::setBox(const std::optional<WorldBounds>& box)
{
    m_box = box;
    setVisible(box.has_value());
    update();
}

void ClipFrame::setCamera(const render::Camera& camera)
{
    m_camera = camera;
    if (m_box) update();
}

void ClipFrame::paintEvent(QPaintEvent*)
{
    if (!m_box) return;
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    QColor color = themeColors().accent;
    color.setAlpha(170);
    painter.setPen(QPen(color, 1.2));
    const glm::dvec2 size(width(), height());
    const double near = m_camera.pivotDepth() * 1e-3;
    const auto corner = [&](int k) {
        return glm::dvec3(k & 1 ? m_box->max.x : m_box->min.x, k & 2 ? m_box->max.y : m_box->min.y,
                          k & 4 ? m_box->max.z : m_box->min.z);
    };
    for (int a = 0; a < 8; ++a)
        for (const int axis : {1, 2, 4}) {
            if ((a & axis) != 0) continue;
            glm::dvec3 from = corner(a), to = corner(a | axis);
            // What lies behind the eye is cut off where it passes it.
            double nearFrom = m_camera.project(from, size).z, nearTo = m_camera.project(to, size).z;
            if (!m_camera.orthographic) {
                if (nearFrom < near && nearTo < near) continue;
                const double share = (near - nearFrom) / (nearTo - nearFrom);
                if (nearFrom < near) from += (to - from) * share;
                if (nearTo < near) to = from + (to - from) * share;
            }
            const glm::dvec3 p = m_camera.project(from, size), q = m_camera.project(to, size);
            painter.drawLine(QPointF(p.x, p.y), QPointF(q.x, q.y));
        }
}

}  // namespace punctum::ui
