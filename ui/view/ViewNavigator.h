// SPDX-License-Identifier: MIT
#pragma once

#include "ui/view/Navigation.h"
#include "ui/view/ViewRenderer.h"

#include <QObject>
#include <QPointF>

#include <functional>
#include <optional>
#include <vector>

class QKeyEvent;
class QMouseEvent;
class QWheelEvent;

namespace punctum::ui
{

class PivotMark;
class Viewport;

/// Mouse and keys that move a view's camera. Left drag turns, right and middle drag move sideways with what is
/// under the mouse, the wheel zooms to it, a double or middle click makes it the pivot; arrows turn, with Ctrl they
/// move sideways, Ctrl with + and -, and page up and down, zoom.
///
/// GUI thread only; a child of the view. What is under the mouse is asked of the renderer, so that movements may
/// begin a frame later.
class ViewNavigator final : public QObject
{
    Q_OBJECT
public:
    ViewNavigator(Viewport& view, PivotMark& mark);

    void setSize(glm::dvec2 sizePx) noexcept { m_navigation.setSize(sizePx); }
    /// Every drag moves the picture sideways, and no key turns it.
    void setFlat() noexcept { m_flat = true; }
    void setReach(const ViewReach& reach) noexcept { m_reach = reach; }

    bool dragging() const noexcept { return m_navigation.drag() != Navigation::Drag::None; }
    /// Whether the mouse has left the place where it was pressed.
    bool moved() const noexcept { return m_navigation.moved(); }

    // Positions: in the widget.
    void press(const QMouseEvent& event);
    void move(QPointF position);
    void release(const QMouseEvent& event);
    void wheel(const QWheelEvent& event);
    /// Whether it was a key of ours.
    bool key(const QKeyEvent& event);
    void centerOn(QPointF position);
    /// The camera has moved, or the mouse: what was under it is there no longer.
    void forgetTarget() noexcept { m_target.reset(); }

signals:
    void cameraMoved(const punctum::render::Camera& camera);
    void flownTo(const punctum::render::Camera& camera);

private:
    struct Target {
        glm::dvec3 place{0.0};  ///< world
        bool point = false;     ///< something is there
    };
    /// What is at a px, or near it, in its depth; else the place at the pivot's depth.
    void find(QPointF position, std::function<void(const Target&)> then);
    void zoom(QPointF position, double notches);
    void applyZoom();
    /// One step of the keys, in (1) or out (-1), to what is in the middle of the view.
    void stepZoom(int direction);
    void takeSteps();
    void drag();

    Viewport& m_view;
    PivotMark& m_mark;
    Navigation m_navigation;
    ViewReach m_reach;
    bool m_flat = false;
    QPointF m_mouse;
    bool m_depthAsked = false;  ///< of what a pan is to move
    int m_presses = 0;
    double m_notches = 0.0;  ///< turned and not yet applied: waits for what is under the cursor
    bool m_targetAsked = false;
    std::optional<Target> m_target;  ///< holds while the cursor rests

    /// Zooming by keys. A step the other way leads back to exactly the camera of before, whatever was seen on the
    /// way; so all of them are kept for as long as nothing else moves the camera.
    struct Steps {
        std::optional<Target> target;        ///< of all of them
        render::Camera last;                 ///< where they have led to
        std::vector<render::Camera> passed;  ///< before each step that can be taken back
        int direction = 0;                   ///< of those
    };
    Steps m_steps;
    std::vector<int> m_stepsAsked;  ///< wait for what is in the middle
};

}  // namespace punctum::ui
