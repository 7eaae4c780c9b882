// SPDX-License-Identifier: MIT
#include "ui/view/ClipFrame.h"

#include "ui/style/Theme.h"
#include "ui/view/Viewport.h"

#include <QKeyEvent>
#include <QLineF>
#include <QMouseEvent>
#include <QPainter>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace punctum::ui
{

namespace
{

constexpr double kHandleRadius = 6.0;  ///< px, of a handle
constexpr double kReach = 10.0;        ///< px from its middle that still take hold of it
constexpr double kOutside = 20.0;      ///< px from a face to its handle, so that those of a flat box lie apart
/// Squared sine of the least angle between a face's axis and the line of sight: about 10 degrees.
constexpr double kLeastSine2 = 0.03;

glm::dvec3 middleOf(const WorldBounds& box)
{
    return box.min + (box.max - box.min) * 0.5;
}

/// The middle of a face, or of the box.
glm::dvec3 anchorOf(const WorldBounds& box, std::size_t handle)
{
    glm::dvec3 at = middleOf(box);
    if (handle == ClipFrame::kMiddle) return at;
    const int axis = int(handle / 2);
    at[axis] = handle % 2 == 0 ? box.min[axis] : box.max[axis];
    return at;
}

/// Bit k: the most side on axis k.
glm::dvec3 cornerOf(const WorldBounds& box, int bits)
{
    return {bits & 1 ? box.max.x : box.min.x, bits & 2 ? box.max.y : box.min.y, bits & 4 ? box.max.z : box.min.z};
}

}  // namespace

ClipFrame::ClipFrame(Viewport& viewport) : QWidget(&viewport), m_viewport(viewport)
{
    setAttribute(Qt::WA_TransparentForMouseEvents);
    hide();
    viewport.installEventFilter(this);
}

void ClipFrame::setBox(const std::optional<WorldBounds>& box)
{
    m_box = box;
    if (!box) end();
    setVisible(box.has_value());
    update();
}

void ClipFrame::setCamera(const render::Camera& camera)
{
    m_camera = camera;
    if (m_box) update();
}

void ClipFrame::showHandles(bool shown)
{
    m_handlesShown = shown;
    if (!shown) end();
    update();
}

std::optional<QPointF> ClipFrame::place(const glm::dvec3& world) const
{
    const glm::dvec3 px = m_camera.project(world, sizePx());
    if (px.z < m_camera.nearDepth()) return std::nullopt;
    return QPointF(px.x, px.y);
}

std::optional<double> ClipFrame::along(std::size_t handle, const WorldBounds& box, QPointF mouse) const
{
    // The point of the axis that is nearest to the line of sight through the mouse, in view units.
    const int axis = int(handle / 2);
    glm::dvec3 direction(0.0);
    direction[axis] = m_camera.stretch[axis];
    const glm::dvec3 seen = m_camera.unproject({mouse.x(), mouse.y()}, sizePx());
    const glm::dvec3 sight =
        m_camera.orthographic ? m_camera.forward() : glm::normalize((seen - m_camera.eye) * m_camera.stretch);
    const glm::dvec3 from = (anchorOf(box, handle) - seen) * m_camera.stretch;
    const double aa = glm::dot(direction, direction), as = glm::dot(direction, sight);
    const double sine2 = aa - as * as;
    if (!(sine2 > kLeastSine2 * aa)) return std::nullopt;
    return (as * glm::dot(sight, from) - glm::dot(direction, from)) / sine2;
}

std::optional<QPointF> ClipFrame::handle(std::size_t which) const
{
    if (!m_box || !m_handlesShown) return std::nullopt;
    const auto at = place(anchorOf(*m_box, which));
    if (!at || which == kMiddle) return at;
    if (!along(which, *m_box, *at)) return std::nullopt;
    // Outward on the screen, whatever the axis does far from here.
    glm::dvec3 axis(0.0);
    axis[int(which / 2)] = which % 2 == 0 ? -1.0 : 1.0;
    const glm::dvec3 seen = axis * m_camera.stretch;
    const glm::dvec3 eyeward = (anchorOf(*m_box, which) - m_camera.eye) * m_camera.stretch;
    const double depth =
        m_camera.orthographic ? 0.0 : glm::dot(seen, m_camera.forward()) / glm::dot(eyeward, m_camera.forward());
    const QPointF out(glm::dot(seen, m_camera.right()) - depth * glm::dot(eyeward, m_camera.right()),
                      -glm::dot(seen, m_camera.up()) + depth * glm::dot(eyeward, m_camera.up()));
    const double length = std::hypot(out.x(), out.y());
    return length > 0.0 ? *at + out * (kOutside / length) : *at;
}

std::optional<std::size_t> ClipFrame::handleAt(QPointF mouse) const
{
    std::optional<std::size_t> nearest;
    double least = kReach;
    for (std::size_t k = 0; k < kHandles; ++k)
        if (const auto at = handle(k); at && QLineF(*at, mouse).length() <= least) {
            least = QLineF(*at, mouse).length();
            nearest = k;
        }
    return nearest;
}

void ClipFrame::setHovered(std::optional<std::size_t> handle)
{
    if (handle == m_hovered) return;
    m_hovered = handle;
    if (handle && !m_cursor) {
        m_cursor = m_viewport.cursor();
        m_viewport.setCursor(Qt::PointingHandCursor);
    } else if (!handle && m_cursor) {
        m_viewport.setCursor(*std::exchange(m_cursor, std::nullopt));
    }
    update();
}

void ClipFrame::end()
{
    m_drag.reset();
    setHovered(std::nullopt);
}

void ClipFrame::drag(QPointF mouse)
{
    WorldBounds box = m_drag->start;
    if (m_drag->handle == kMiddle) {
        // In the plane of the picture at the middle's depth.
        const glm::dvec3 middle = middleOf(box);
        render::Camera there = m_camera;
        if (!there.orthographic) there.pivot = middle;
        const glm::dvec3 move = there.unproject({mouse.x(), mouse.y()}, sizePx()) -
                                there.unproject({m_drag->press.x(), m_drag->press.y()}, sizePx());
        box.min += move;
        box.max += move;
    } else {
        const auto now = along(m_drag->handle, m_drag->start, mouse);
        if (!now) return;
        const int axis = int(m_drag->handle / 2);
        const double by = *now - m_drag->along;
        if (m_drag->handle % 2 == 0)
            box.min[axis] = std::min(box.min[axis] + by, box.max[axis]);
        else
            box.max[axis] = std::max(box.max[axis] + by, box.min[axis]);
    }
    emit boxDragged(box);
}

bool ClipFrame::pressed(const QMouseEvent& event)
{
    if (m_drag) return true;  // another button
    const auto handle = handleAt(event.position());
    if (!handle || event.button() != Qt::LeftButton) return false;
    m_viewport.setFocus(Qt::MouseFocusReason);
    m_viewport.holdCamera();
    const auto start = *handle == kMiddle ? 0.0 : along(*handle, *m_box, event.position());
    if (!start) return false;
    m_drag = Drag{*handle, *m_box, event.position(), *start};
    setHovered(handle);
    return true;
}

bool ClipFrame::eventFilter(QObject*, QEvent* event)
{
    if (!m_box || !m_handlesShown) return false;
    switch (event->type()) {
        case QEvent::MouseButtonPress:
        case QEvent::MouseButtonDblClick:
            return pressed(*static_cast<QMouseEvent*>(event));
        case QEvent::MouseMove: {
            const auto& mouse = *static_cast<QMouseEvent*>(event);
            if (m_drag) {
                drag(mouse.position());
                return true;
            }
            if (mouse.buttons() == Qt::NoButton) setHovered(handleAt(mouse.position()));
            return false;
        }
        case QEvent::MouseButtonRelease: {
            const auto& mouse = *static_cast<QMouseEvent*>(event);
            if (!m_drag) return false;
            if (mouse.button() != Qt::LeftButton) return true;
            end();
            setHovered(handleAt(mouse.position()));
            return true;
        }
        case QEvent::Wheel:  // the line that is dragged along must stay
            return m_drag.has_value();
        case QEvent::Hide:  // the button's release will not come
            end();
            return false;
        case QEvent::Leave:
            if (!m_drag) setHovered(std::nullopt);
            return false;
        case QEvent::ShortcutOverride:
            if (m_drag && static_cast<QKeyEvent*>(event)->key() == Qt::Key_Escape) event->accept();
            return false;
        case QEvent::KeyPress:
            if (!m_drag || static_cast<QKeyEvent*>(event)->key() != Qt::Key_Escape) return false;
            emit boxDragged(WorldBounds(m_drag->start));
            end();
            return true;
        default:
            return false;
    }
}

void ClipFrame::paintEvent(QPaintEvent*)
{
    if (!m_box) return;
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    const QColor accent = themeColors().accent;
    QColor line = accent;
    line.setAlpha(170);
    const double near = m_camera.nearDepth();
    if (m_hovered && *m_hovered != kMiddle) {
        const int axis = 1 << (*m_hovered / 2), side = *m_hovered % 2 == 0 ? 0 : axis;
        const int u = axis == 1 ? 2 : 1, v = axis == 4 ? 2 : 4;
        QPolygonF face;
        for (const int bits : {0, u, u | v, v})
            if (const auto at = place(cornerOf(*m_box, side | bits))) face << *at;
        if (face.size() == 4) {
            QColor tint = accent;
            tint.setAlpha(40);
            painter.setPen(Qt::NoPen);
            painter.setBrush(tint);
            painter.drawPolygon(face);
        }
    }
    painter.setPen(QPen(line, 1.2));
    for (int a = 0; a < 8; ++a)
        for (const int axis : {1, 2, 4}) {
            if ((a & axis) != 0) continue;
            glm::dvec3 from = cornerOf(*m_box, a), to = cornerOf(*m_box, a | axis);
            // What lies behind the eye is cut off where it passes it.
            const double nearFrom = m_camera.project(from, sizePx()).z, nearTo = m_camera.project(to, sizePx()).z;
            if (nearFrom < near && nearTo < near) continue;
            const glm::dvec3 cut = from + (to - from) * ((near - nearFrom) / (nearTo - nearFrom));
            if (nearFrom < near) from = cut;
            if (nearTo < near) to = cut;
            const glm::dvec3 p = m_camera.project(from, sizePx()), q = m_camera.project(to, sizePx());
            painter.drawLine(QPointF(p.x, p.y), QPointF(q.x, q.y));
        }
    for (std::size_t k = 0; k < kHandles; ++k) {
        const auto at = handle(k);
        if (!at) continue;
        const bool held = m_hovered == k;
        if (const auto base = place(anchorOf(*m_box, k)); base && k != kMiddle) {
            painter.setPen(QPen(line, 1.2));
            painter.drawLine(*base, *at);
        }
        painter.setPen(QPen(QColor(255, 255, 255, held ? 255 : 200), 1.6));
        painter.setBrush(held ? QColor(255, 255, 255) : accent);
        const double radius = held ? kHandleRadius + 1.0 : kHandleRadius;
        if (k == kMiddle)
            painter.drawRect(QRectF(at->x() - radius, at->y() - radius, 2 * radius, 2 * radius));
        else
            painter.drawEllipse(*at, radius, radius);
    }
}

}  // namespace punctum::ui
