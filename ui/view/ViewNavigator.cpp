// SPDX-License-Identifier: MIT
#include "ui/view/ViewNavigator.h"

#include "ui/view/PivotMark.h"
#include "ui/view/Viewport.h"

#include <QKeyEvent>
#include <QMouseEvent>
#include <QWheelEvent>

#include <glm/geometric.hpp>

#include <numbers>
#include <utility>

namespace punctum::ui
{

namespace
{

/// px around the cursor in which a point tells how far away is what the hand means.
constexpr int kReachOfHand = 40;
constexpr double kKeyTurn = 5.0 * std::numbers::pi / 180.0;
constexpr double kKeyShift = 0.1;  // of the picture's height

}  // namespace

ViewNavigator::ViewNavigator(Viewport& view, PivotMark& mark) : QObject(&view), m_view(view), m_mark(mark) {}

void ViewNavigator::find(QPointF position, std::function<void(const Target&)> then)
{
    const glm::dvec2 px = m_view.toPicture(position);
    const int radius = int(kReachOfHand * m_view.pixelRatio());
    m_view.renderer().pick(
        int(px.x), int(px.y), this,
        [this, px, then = std::move(then)](const std::optional<PickedPoint>& point) {
            const render::Camera& camera = m_view.camera();
            const QSize size = m_view.pictureSize();
            Target target{camera.unproject(px, {size.width(), size.height()}), false};
            if (point) {
                // The place under the cursor in the depth of the point, which may be beside it.
                const double depth = glm::dot((point->world - camera.eye) * camera.stretch, camera.forward());
                if (camera.orthographic)
                    target = {target.place + camera.forward() * (depth - camera.pivotDepth()) / camera.stretch,
                              true};
                else if (depth > 0.0)
                    target = {camera.eye + (target.place - camera.eye) * (depth / camera.pivotDepth()), true};
            }
            then(target);
        },
        radius);
}

void ViewNavigator::press(const QMouseEvent& event)
{
    m_mouse = event.position();
    m_target.reset();
    const bool left = event.button() == Qt::LeftButton;
    if (!left && event.button() != Qt::RightButton && event.button() != Qt::MiddleButton) return;
    ++m_presses;
    m_depthAsked = false;
    const glm::dvec2 px = m_view.toPicture(m_mouse);
    const bool turns = left && !m_flat;
    m_navigation.begin(turns ? Navigation::Drag::Orbit : Navigation::Drag::Pan, px);
    if (turns || m_flat) return;
    m_depthAsked = true;
    find(m_mouse, [this, px, press = m_presses](const Target& target) {
        if (!m_depthAsked || press != m_presses) return;
        m_depthAsked = false;
        const render::Camera& camera = m_view.camera();
        m_navigation.begin(Navigation::Drag::Pan, px,
                           glm::dot((target.place - camera.eye) * camera.stretch, camera.forward()));
        drag();
    });
}

void ViewNavigator::move(QPointF position)
{
    m_mouse = position;
    m_target.reset();
    if (dragging() && !m_depthAsked) drag();
}

void ViewNavigator::drag()
{
    render::Camera camera = m_view.camera();
    if (!m_navigation.move(m_view.toPicture(m_mouse), camera)) return;
    if (m_navigation.drag() == Navigation::Drag::Orbit) m_mark.hold(true);
    emit cameraMoved(camera);
}

void ViewNavigator::release(const QMouseEvent& event)
{
    m_mouse = event.position();
    // A drag that ends before the answer comes goes by the pivot.
    if (std::exchange(m_depthAsked, false)) drag();
    const bool click = !m_navigation.moved();
    m_navigation.end();
    m_mark.hold(false);
    if (click && event.button() == Qt::MiddleButton) centerOn(m_mouse);
}

void ViewNavigator::wheel(const QWheelEvent& event)
{
    m_mouse = event.position();
    zoom(m_mouse, event.angleDelta().y() / 120.0);
}

void ViewNavigator::zoom(QPointF position, double notches)
{
    if (notches == 0.0) return;
    m_notches += notches;
    if (m_target) return applyZoom();
    if (std::exchange(m_targetAsked, true)) return;
    find(position, [this](const Target& target) {
        m_targetAsked = false;
        m_target = target;
        applyZoom();
    });
}

void ViewNavigator::applyZoom()
{
    render::Camera camera = m_view.camera();
    const double notches = std::exchange(m_notches, 0.0);
    // What the camera has gone through is behind it.
    if (!Navigation::zoom(notches, m_target->place, camera, m_reach, m_target->point)) m_target.reset();
    emit cameraMoved(camera);
}

void ViewNavigator::stepZoom(int direction)
{
    m_stepsAsked.push_back(direction);
    if (m_stepsAsked.size() == 1) takeSteps();
}

void ViewNavigator::takeSteps()
{
    render::Camera camera = m_view.camera();
    if (!(m_steps.last == camera)) m_steps = {};
    while (!m_stepsAsked.empty()) {
        const int direction = m_stepsAsked.front();
        if (m_steps.direction == -direction && !m_steps.passed.empty()) {
            camera = m_steps.passed.back();
            m_steps.passed.pop_back();
        } else if (m_steps.target) {
            const render::Camera before = camera;
            // What the camera has gone through is behind it: the next step goes to what is in the middle then.
            if (!Navigation::zoom(direction, m_steps.target->place, camera, m_reach, m_steps.target->point))
                m_steps.target.reset();
            m_steps.direction = direction;
            if (!(camera == before)) m_steps.passed.push_back(before);
        } else {
            break;
        }
        m_stepsAsked.erase(m_stepsAsked.begin());
    }
    m_steps.last = camera;
    m_target.reset();  // of the wheel
    if (!(camera == m_view.camera())) emit cameraMoved(camera);
    if (m_stepsAsked.empty()) return;
    find(m_view.rect().center(), [this](const Target& target) {
        if (!(m_steps.last == m_view.camera())) m_steps = {};
        m_steps.last = m_view.camera();
        m_steps.target = target;
        takeSteps();
    });
}

bool ViewNavigator::key(const QKeyEvent& event)
{
    const auto modifiers = event.modifiers() & ~Qt::KeypadModifier;
    const bool plain = modifiers == Qt::NoModifier;
    const bool control = modifiers == Qt::ControlModifier || modifiers == (Qt::ControlModifier | Qt::ShiftModifier);
    glm::dvec2 way(0.0);
    switch (event.key()) {
        case Qt::Key_Left:
            way = {-1, 0};
            break;
        case Qt::Key_Right:
            way = {1, 0};
            break;
        case Qt::Key_Up:
            way = {0, -1};
            break;
        case Qt::Key_Down:
            way = {0, 1};
            break;
        case Qt::Key_PageUp:
        case Qt::Key_PageDown:
            if (!plain) return false;
            stepZoom(event.key() == Qt::Key_PageUp ? 1 : -1);
            return true;
        case Qt::Key_Plus:
        case Qt::Key_Equal:
        case Qt::Key_Minus:
            if (!control) return false;
            stepZoom(event.key() == Qt::Key_Minus ? -1 : 1);
            return true;
        default:
            return false;
    }
    if (modifiers == Qt::ControlModifier) {
        // Over there: the picture moves the other way.
        emit cameraMoved(Navigation::shifted(m_view.camera(), way * kKeyShift));
        return true;
    }
    if (!plain || m_flat) return false;
    render::Camera camera = m_view.camera();
    // As if the eye went that way round the pivot.
    camera.orbit(way.x * kKeyTurn, way.y * kKeyTurn);
    m_mark.flash();
    emit cameraMoved(camera);
    return true;
}

void ViewNavigator::centerOn(QPointF position)
{
    const glm::dvec2 px = m_view.toPicture(position);
    m_view.renderer().pick(int(px.x), int(px.y), this, [this](const std::optional<PickedPoint>& point) {
        if (!point) return;
        emit flownTo(Navigation::centered(m_view.camera(), point->world));
        m_mark.flash();
    });
}

}  // namespace punctum::ui
