// SPDX-License-Identifier: MIT
#pragma once

#include "render/camera/Camera.h"

#include <QPointF>
#include <QWidget>

#include <array>
#include <optional>

namespace punctum::ui
{

class Viewport;

/// The axes in the corner of a view: X to the east, Y to the north, Z up. A click on an end looks from there (the
/// end of Z: from the top), one on the middle turns perspective on or off; beside these, the mouse is the view's.
/// A child of the view, as it lies on the picture dark in every appearance. GUI thread only.
class AxesMark final : public QWidget
{
    Q_OBJECT
public:
    /// What can be clicked: the ends, by the standard views that they lead to, and the middle.
    enum class Part { Right, Back, Top, Left, Front, Bottom, Middle };
    static constexpr int kParts = 7;

    explicit AxesMark(Viewport& view);

    /// Where a part is, in px of the widget; none where an axis points along the line of sight and the middle
    /// covers its ends.
    std::optional<QPointF> placeOf(Part part) const;
    std::optional<Part> hovered() const noexcept { return m_hovered; }

signals:
    /// As Camera::setView() names it.
    void viewWanted(const QString& name);
    void projectionWanted(bool orthographic);

protected:
    void paintEvent(QPaintEvent* event) override;
    void mousePressEvent(QMouseEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;
    void mouseReleaseEvent(QMouseEvent* event) override;
    void mouseDoubleClickEvent(QMouseEvent* event) override;
    void leaveEvent(QEvent* event) override;
    bool event(QEvent* event) override;

private:
    /// Of an end, from the middle, in px; z: away from the viewer.
    glm::dvec3 way(Part end) const;
    std::optional<Part> partAt(QPointF position) const;
    void setHovered(std::optional<Part> part);
    QString tipOf(Part part) const;

    Viewport& m_view;
    render::Camera m_camera;
    std::optional<Part> m_hovered, m_pressed;
};

}  // namespace punctum::ui
