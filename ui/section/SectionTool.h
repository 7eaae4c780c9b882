// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec3.hpp>

#include <QObject>
#include <QPointF>

#include <functional>
#include <optional>

class QKeyEvent;
class QMouseEvent;

namespace punctum::ui
{

class SectionBand;
class Viewport;

/// Drawing the line of a section on a view: two clicks, or a drag from one end to the other. An end is the point
/// under the mouse; beside all points it is the place at the height of the first end. Space held moves the camera,
/// Escape gives up the line, then the tool, which ends by itself when the line is drawn.
///
/// GUI thread only. Borrows viewport and band, which must outlive it.
class SectionTool final : public QObject
{
    Q_OBJECT
public:
    SectionTool(Viewport& viewport, SectionBand& band, QObject* parent = nullptr);

    bool on() const noexcept { return m_on; }
    void setOn(bool on);

    bool eventFilter(QObject* watched, QEvent* event) override;

signals:
    void toggled(bool on);
    /// The ends of a line that is long enough to be seen, `world`.
    void drawn(const glm::dvec3& from, const glm::dvec3& to);

private:
    bool mousePressed(const QMouseEvent& event);
    bool mouseReleased(const QMouseEvent& event);
    bool keyPressed(const QKeyEvent& event);
    /// `reply` gets the place under the mouse, a little later.
    void find(QPointF at, std::function<void(const glm::dvec3&)> reply);
    glm::dvec3 placeAt(QPointF at, double height) const;
    bool farFromStart(QPointF at) const;
    void finish(QPointF at);
    void giveUp();
    void updateDraft();

    Viewport& m_viewport;
    SectionBand& m_band;
    bool m_on = false;
    bool m_space = false;
    bool m_takenPress = false;          ///< the button that is down is ours
    std::optional<QPointF> m_start;     ///< where the line was begun, on the widget
    std::optional<glm::dvec3> m_first;  ///< its end there
    QPointF m_mouse;
    unsigned m_line = 0;  ///< answers for lines that were given up are dropped
};

}  // namespace punctum::ui
