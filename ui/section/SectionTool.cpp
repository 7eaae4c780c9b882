// SPDX-License-Identifier: MIT
#include "ui/section/SectionTool.h"

#include "ui/section/SectionOverlays.h"
#include "ui/view/ViewRenderer.h"
#include "ui/view/Viewport.h"

#include <QKeyEvent>
#include <QMouseEvent>

#include <glm/geometric.hpp>

#include <cmath>

namespace punctum::ui
{

namespace
{

constexpr double kShortest = 8.0;     // px: less is a click
constexpr double kLeastSlope = 0.05;  // of a line of sight that meets a level plane where one would expect

}  // namespace

SectionTool::SectionTool(Viewport& viewport, SectionBand& band, QObject* parent)
    : QObject(parent), m_viewport(viewport), m_band(band)
{
    viewport.installEventFilter(this);
}

void SectionTool::setOn(bool on)
{
    if (on == m_on) return;
    giveUp();
    m_on = on;
    m_space = m_takenPress = false;
    emit toggled(on);  // other tools end, and take their cursor with them
    if (m_on)
        m_viewport.setCursor(Qt::CrossCursor);
    else
        m_viewport.unsetCursor();
}

bool SectionTool::eventFilter(QObject*, QEvent* event)
{
    if (!m_on) return false;
    switch (event->type()) {
        case QEvent::MouseButtonPress:
        case QEvent::MouseButtonDblClick:
            return mousePressed(*static_cast<QMouseEvent*>(event));
        case QEvent::MouseMove:
            m_mouse = static_cast<QMouseEvent*>(event)->position();
            updateDraft();
            return false;  // the viewport tells what is under the mouse
        case QEvent::MouseButtonRelease:
            return mouseReleased(*static_cast<QMouseEvent*>(event));
        case QEvent::KeyPress:
            return keyPressed(*static_cast<QKeyEvent*>(event));
        case QEvent::KeyRelease:
            if (static_cast<QKeyEvent*>(event)->key() != Qt::Key_Space) return false;
            if (!static_cast<QKeyEvent*>(event)->isAutoRepeat()) {
                m_space = false;
                m_viewport.setCursor(Qt::CrossCursor);
            }
            return true;
        default:
            return false;
    }
}

bool SectionTool::mousePressed(const QMouseEvent& event)
{
    if (m_space || event.button() != Qt::LeftButton) return false;
    m_viewport.setFocus(Qt::MouseFocusReason);
    m_viewport.holdCamera();
    m_takenPress = true;
    m_mouse = event.position();
    if (m_start) return true;
    m_start = m_mouse;
    find(m_mouse, [this](const glm::dvec3& place) {
        m_first = place;
        updateDraft();
    });
    return true;
}

bool SectionTool::mouseReleased(const QMouseEvent& event)
{
    if (!std::exchange(m_takenPress, false)) return false;
    m_mouse = event.position();
    if (m_start && farFromStart(m_mouse)) finish(m_mouse);
    return true;
}

bool SectionTool::keyPressed(const QKeyEvent& event)
{
    if (event.key() == Qt::Key_Space) {
        if (!event.isAutoRepeat()) m_space = true;
        m_viewport.setCursor(Qt::OpenHandCursor);
        return true;
    }
    if (event.key() == Qt::Key_Escape || (event.key() == Qt::Key_Backspace && m_start)) {
        if (m_start)
            giveUp();
        else
            setOn(false);
        return true;
    }
    return false;
}

bool SectionTool::farFromStart(QPointF at) const
{
    glm::dvec2 start = m_viewport.toPicture(*m_start);
    if (m_first) {  // the camera may have moved meanwhile
        const QSize size = m_viewport.pictureSize();
        start = m_viewport.camera().project(*m_first, {size.width(), size.height()});
    }
    return glm::distance(start, m_viewport.toPicture(at)) >= kShortest * m_viewport.pixelRatio();
}

void SectionTool::find(QPointF at, std::function<void(const glm::dvec3&)> reply)
{
    const glm::ivec2 px(m_viewport.toPicture(at));
    m_viewport.renderer().pick(
        px.x, px.y, this,
        [this, at, line = m_line, reply = std::move(reply)](const std::optional<PickedPoint>& point) {
            if (line != m_line) return;
            reply(point ? point->world : placeAt(at, m_first ? m_first->z : m_viewport.camera().pivot.z));
        });
}

glm::dvec3 SectionTool::placeAt(QPointF at, double height) const
{
    const render::Camera& camera = m_viewport.camera();
    const QSize size = m_viewport.pictureSize();
    const glm::dvec3 through = camera.unproject(m_viewport.toPicture(at), {size.width(), size.height()});
    const glm::dvec3 sight =
        camera.orthographic ? camera.forward() : glm::normalize((through - camera.eye) * camera.stretch);
    if (std::abs(sight.z) < kLeastSlope) return through;
    const double t = (height - through.z) * camera.stretch.z / sight.z;
    const bool behind = !camera.orthographic && t < -glm::length((through - camera.eye) * camera.stretch);
    return behind ? through : through + sight * t / camera.stretch;
}

void SectionTool::finish(QPointF at)
{
    find(at, [this](const glm::dvec3& place) {
        const auto first = m_first;
        setOn(false);
        if (first) emit drawn(*first, place);
    });
}

void SectionTool::giveUp()
{
    ++m_line;
    m_start.reset();
    m_first.reset();
    m_band.setDraft({});
}

void SectionTool::updateDraft()
{
    if (m_first) m_band.setDraft(std::pair(*m_first, placeAt(m_mouse, m_first->z)));
}

}  // namespace punctum::ui
