// SPDX-License-Identifier: MIT
#pragma once

#include "render/camera/Camera.h"

#include <QPointF>
#include <QWidget>

#include <array>
#include <optional>

class QMouseEvent;

namespace punctum::ui
{

class Viewport;

/// The clip box over the picture: its edges, a handle outside each face that moves the face, and one in the middle
/// that moves the box. Handles are dragged with the left button; Escape takes back the drag. Handles whose axis
/// points at the viewer are not shown, as the mouse could not move them.
///
/// Belongs to a viewport, whose mouse events it sees first; as a widget it lets the mouse through. GUI thread only.
class ClipFrame final : public QWidget
{
    Q_OBJECT
public:
    /// Faces by axis: the least side at 2 * axis, the most at 2 * axis + 1; then the middle.
    static constexpr std::size_t kMiddle = 6, kHandles = 7;

    explicit ClipFrame(Viewport& viewport);

    void setBox(const std::optional<WorldBounds>& box);
    void setCamera(const render::Camera& camera);
    /// Not while a tool has the mouse; at first they are shown.
    void showHandles(bool shown);
    /// Where a handle is, in px of the widget; none when it is not shown.
    std::optional<QPointF> handle(std::size_t which) const;
    bool dragging() const noexcept { return m_drag.has_value(); }

    bool eventFilter(QObject* watched, QEvent* event) override;

signals:
    /// The user drags the box, or takes a drag back.
    void boxDragged(const punctum::WorldBounds& box);

protected:
    void paintEvent(QPaintEvent* event) override;

private:
    struct Drag {
        std::size_t handle;
        WorldBounds start;
        QPointF press;
        double along;  ///< of the press on the line that the face is moved along
    };
    glm::dvec2 sizePx() const { return {double(std::max(1, width())), double(std::max(1, height()))}; }
    std::optional<QPointF> place(const glm::dvec3& world) const;
    /// Where on a handle's axis, in world units from the box's start, the mouse is; none when it cannot be told.
    std::optional<double> along(std::size_t handle, const WorldBounds& box, QPointF mouse) const;
    std::optional<std::size_t> handleAt(QPointF mouse) const;
    void setHovered(std::optional<std::size_t> handle);
    bool pressed(const QMouseEvent& event);
    void drag(QPointF mouse);
    void end();

    Viewport& m_viewport;
    std::optional<WorldBounds> m_box;
    render::Camera m_camera;
    bool m_handlesShown = true;
    std::optional<std::size_t> m_hovered;
    std::optional<QCursor> m_cursor;  ///< of the viewport, beside the handles
    std::optional<Drag> m_drag;
};

}  // namespace punctum::ui
