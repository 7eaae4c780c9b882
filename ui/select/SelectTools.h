// SPDX-License-Identifier: MIT
#pragma once

#include "core/select/ScreenMask.h"
#include "core/select/Selecting.h"
#include "render/camera/Camera.h"

#include <QObject>
#include <QPointF>
#include <QWidget>

#include <vector>

class QKeyEvent;
class QMouseEvent;
class QWheelEvent;

namespace punctum::ui
{

class Selection;
class Viewport;

/// The shape that is being drawn, over the view; lets the mouse through. GUI thread only.
class ShapeOverlay final : public QWidget
{
    Q_OBJECT
public:
    explicit ShapeOverlay(QWidget* parent);

    /// A line through these places (logical px), closed by a thinner one.
    void setOutline(std::vector<QPointF> corners, bool closed);
    /// A circle about the mouse; no radius: none.
    void setCircle(QPointF middle, double radius);
    void clear();

protected:
    void paintEvent(QPaintEvent* event) override;

private:
    std::vector<QPointF> m_corners;
    bool m_closed = false;
    QPointF m_middle;
    double m_radius = 0.0;
};

/// Drawing on the view to select: takes the mouse from the viewport while a tool is chosen, and gives it back while
/// Space is held. Rectangle, lasso and brush are drags; a polygon is clicked, Backspace takes a corner back, Enter,
/// a double click or the right button closes it. Escape gives up the shape, then the tool. Shift adds, Ctrl takes
/// away, both together keep what lies in both; otherwise the selection's mode holds.
///
/// GUI thread only. Borrows viewport and selection, which must outlive it.
class SelectTools final : public QObject
{
    Q_OBJECT
public:
    enum class Tool { None, Rectangle, Polygon, Lasso, Brush };

    SelectTools(Viewport& viewport, Selection& selection, QObject* parent = nullptr);

    Tool tool() const noexcept { return m_tool; }
    void setTool(Tool tool);
    /// Of the brush, in logical px.
    double brushRadius() const noexcept { return m_radius; }
    void setBrushRadius(double px);
    /// Corners of the shape so far.
    std::size_t corners() const noexcept { return m_corners.size(); }

    bool eventFilter(QObject* watched, QEvent* event) override;

signals:
    void toolChanged(punctum::ui::SelectTools::Tool tool);
    void brushRadiusChanged(double px);

private:
    bool mousePressed(const QMouseEvent& event);
    bool mouseMoved(const QMouseEvent& event);
    bool mouseReleased(const QMouseEvent& event);
    bool doubleClicked(const QMouseEvent& event);
    bool wheelTurned(const QWheelEvent& event);
    bool keyPressed(const QKeyEvent& event);
    void start(QPointF at, Qt::KeyboardModifiers modifiers);
    void update(QPointF to);
    void close();
    void giveUp();
    void place();
    void followCamera();
    void setSpace(bool held);
    bool enough() const;
    ScreenMask mask() const;

    Viewport& m_viewport;
    Selection& m_selection;
    ShapeOverlay* m_overlay;
    Tool m_tool = Tool::None;
    bool m_shape = false;  ///< one is being drawn
    std::vector<QPointF> m_corners;
    std::vector<glm::dvec3> m_anchors;  ///< the corners at the pivot's depth: they follow the camera
    QPointF m_mouse;
    double m_radius = 24.0;
    ScreenMask m_stroke;
    bool m_space = false;
    bool m_takenPress = false;  ///< the button that is down is ours
};

}  // namespace punctum::ui
