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

    enum class Outline {
        Closed,    ///< a line that comes back to its first place
        Unclosed,  ///< one that will: a thinner line goes back
        Above,     ///< what lies above the line is meant
        Below,
    };
    /// A line through these places (logical px).
    void setOutline(std::vector<QPointF> corners, Outline outline);
    /// A circle about the mouse; no radius: none.
    void setCircle(QPointF middle, double radius);
    void clear();

protected:
    void paintEvent(QPaintEvent* event) override;

private:
    std::vector<QPointF> m_corners;
    Outline m_outline = Outline::Closed;
    QPointF m_middle;
    double m_radius = 0.0;
};

/// Drawing on a view to select: takes the mouse from the viewport while a tool is chosen, and gives it back while
/// Space is held. Rectangle, lasso and brush are drags; the corners of a polygon, and of the line above or below
/// which points are meant, are clicked, Backspace takes one back, Enter, a double click or the right button ends
/// it. Escape gives up the shape, then the tool. Shift adds, Ctrl takes away, both together keep what lies in both;
/// otherwise the selection's mode holds.
///
/// The tool works in whichever of the views the mouse is over; a shape belongs to the one that it was begun in.
///
/// GUI thread only. Borrows viewports and selection, which must outlive it.
class SelectTools final : public QObject
{
    Q_OBJECT
public:
    enum class Tool { None, Rectangle, Polygon, Lasso, Brush, AboveLine, BelowLine };

    SelectTools(Viewport& viewport, Selection& selection, QObject* parent = nullptr);

    /// Another view to draw in.
    void addView(Viewport& viewport);

    Tool tool() const noexcept { return m_tool; }
    void setTool(Tool tool);
    /// Of the brush, in logical px.
    double brushRadius() const noexcept { return m_radius; }
    void setBrushRadius(double px);
    /// The shape that is being drawn, if there is one.
    void giveUp();
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
    void enter(Viewport& viewport);
    void setCursors(Qt::CursorShape shape);
    void setCircle(bool shown);
    bool clicked() const noexcept;
    void followCamera();
    void setSpace(bool held);
    bool enough() const;
    ScreenMask mask() const;

    struct View {
        Viewport* viewport;
        ShapeOverlay* overlay;
    };
    View& viewOf(const QObject* viewport);

    Selection& m_selection;
    std::vector<View> m_views;
    Viewport* m_viewport = nullptr;     ///< the one the mouse is over, or was last
    ShapeOverlay* m_overlay = nullptr;  ///< its
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
