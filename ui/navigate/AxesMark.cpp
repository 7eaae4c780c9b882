// SPDX-License-Identifier: MIT
#include "ui/navigate/AxesMark.h"

#include "ui/marks/MarkStyle.h"
#include "ui/style/Theme.h"
#include "ui/view/Viewport.h"

#include <QHelpEvent>
#include <QMouseEvent>
#include <QPainter>
#include <QToolTip>

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace punctum::ui
{

namespace
{

// px of the widget
constexpr int kSide = 96;
constexpr double kArm = 33.0;  // from the middle to an end
constexpr double kEnd = 9.5, kOtherEnd = 7.5, kCenter = 9.0;
constexpr double kSlack = 2.0;  // beside an end that still means it

using Part = AxesMark::Part;
constexpr std::array kEnds{Part::Right, Part::Back, Part::Top, Part::Left, Part::Front, Part::Bottom};
constexpr std::array<const char*, 6> kViewNames{"right", "back", "top", "left", "front", "bottom"};

bool isPositive(Part end)
{
    return int(end) < 3;
}

QColor colorOf(Part end)
{
    static const std::array<QColor, 3> kColors{QColor(0xf0, 0x7a, 0x6d), QColor(0x7d, 0xc8, 0x6c),
                                               QColor(0x6c, 0xa9, 0xff)};
    return kColors[std::size_t(int(end) % 3)];
}

/// A frame as parallel or as perspective shows it.
QPolygonF frameIcon(QPointF middle, bool orthographic)
{
    const double far = orthographic ? 4.0 : 2.2, near = orthographic ? 4.0 : 5.0;
    return {{middle + QPointF(-far, -3.6), middle + QPointF(far, -3.6), middle + QPointF(near, 3.6),
             middle + QPointF(-near, 3.6)}};
}

}  // namespace

AxesMark::AxesMark(Viewport& view) : QWidget(&view), m_view(view), m_camera(view.camera())
{
    setFixedSize(kSide, kSide);
    setMouseTracking(true);
    setFocusPolicy(Qt::NoFocus);  // the keys stay the view's
    setAccessibleName(tr("Axes of the view"));
    hide();
    connect(&view, &Viewport::cameraChanged, this, [this] {
        const render::Camera& now = m_view.camera();
        const bool same =
            now.yaw == m_camera.yaw && now.pitch == m_camera.pitch && now.orthographic == m_camera.orthographic;
        m_camera = now;
        if (!same) update();
    });
}

glm::dvec3 AxesMark::way(Part end) const
{
    glm::dvec3 axis(0.0);
    axis[int(end) % 3] = isPositive(end) ? kArm : -kArm;
    return {glm::dot(axis, m_camera.right()), -glm::dot(axis, m_camera.up()), glm::dot(axis, m_camera.forward())};
}

std::optional<QPointF> AxesMark::placeOf(Part part) const
{
    const QPointF middle(kSide / 2.0, kSide / 2.0);
    if (part == Part::Middle) return middle;
    const glm::dvec3 to = way(part);
    if (std::hypot(to.x, to.y) < kCenter + kOtherEnd) return std::nullopt;
    return middle + QPointF(to.x, to.y);
}

std::optional<Part> AxesMark::partAt(QPointF position) const
{
    const auto within = [&](QPointF place, double radius) {
        return std::hypot(position.x() - place.x(), position.y() - place.y()) <= radius;
    };
    if (within(*placeOf(Part::Middle), kCenter + kSlack)) return Part::Middle;
    std::optional<Part> nearest;
    for (const Part end : kEnds)
        if (const auto place = placeOf(end); place && within(*place, kEnd + kSlack))
            if (!nearest || way(end).z < way(*nearest).z) nearest = end;
    return nearest;
}

QString AxesMark::tipOf(Part part) const
{
    switch (part) {
        case Part::Right:
            return tr("X, east: look from the right");
        case Part::Back:
            return tr("Y, north: look from the back");
        case Part::Top:
            return tr("Z, up: look from the top");
        case Part::Left:
            return tr("West: look from the left");
        case Part::Front:
            return tr("South: look from the front");
        case Part::Bottom:
            return tr("Down: look from the bottom");
        case Part::Middle:
            break;
    }
    return m_camera.orthographic ? tr("Orthographic; click for perspective")
                                 : tr("Perspective; click for orthographic");
}

void AxesMark::setHovered(std::optional<Part> part)
{
    if (part == m_hovered) return;
    m_hovered = part;
    if (part)
        setCursor(Qt::PointingHandCursor);
    else
        unsetCursor();
    update();
}

bool AxesMark::event(QEvent* event)
{
    if (event->type() == QEvent::ToolTip) {
        const auto* const help = static_cast<QHelpEvent*>(event);
        const auto part = partAt(help->pos());
        if (part)
            QToolTip::showText(help->globalPos(), tipOf(*part), this);
        else
            QToolTip::hideText();
        return true;
    }
    return QWidget::event(event);
}

// What is not ours goes on to the view, as the event's place in it.

void AxesMark::mousePressEvent(QMouseEvent* event)
{
    m_pressed = event->button() == Qt::LeftButton ? partAt(event->position()) : std::nullopt;
    if (m_pressed)
        m_view.setFocus(Qt::MouseFocusReason);
    else
        event->ignore();
}

void AxesMark::mouseMoveEvent(QMouseEvent* event)
{
    // While a button is held that the view has, it is no matter what the mouse passes.
    const bool dragging = event->buttons() != Qt::NoButton && !m_pressed;
    setHovered(dragging ? std::nullopt : partAt(event->position()));
    if (!m_pressed && !m_hovered) event->ignore();
}

void AxesMark::mouseReleaseEvent(QMouseEvent* event)
{
    const auto pressed = std::exchange(m_pressed, std::nullopt);
    if (!pressed) {
        event->ignore();
        return;
    }
    if (partAt(event->position()) != pressed) return;
    if (*pressed == Part::Middle)
        emit projectionWanted(!m_camera.orthographic);
    else
        emit viewWanted(QLatin1String(kViewNames[std::size_t(*pressed)]));
}

void AxesMark::mouseDoubleClickEvent(QMouseEvent* event)
{
    mousePressEvent(event);  // the second of two quick clicks
}

void AxesMark::leaveEvent(QEvent* event)
{
    setHovered(std::nullopt);
    QWidget::leaveEvent(event);
}

void AxesMark::paintEvent(QPaintEvent*)
{
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    const QPointF middle = *placeOf(Part::Middle);
    painter.setPen(Qt::NoPen);
    painter.setBrush(kMarkPlate);
    painter.drawEllipse(middle, kSide / 2.0, kSide / 2.0);

    auto ends = kEnds;
    std::sort(ends.begin(), ends.end(), [this](Part a, Part b) { return way(a).z > way(b).z; });
    painter.setFont(scaledFont(font(), 0.82, true));
    for (const Part end : ends) {
        const auto place = placeOf(end);
        if (!place) continue;
        QColor color = colorOf(end);
        // What points away from the viewer is darker.
        color = color.darker(100 + int(std::clamp(way(end).z / kArm, 0.0, 1.0) * 60));
        const bool lit = m_hovered == end;
        if (isPositive(end)) {
            const QPointF out = (*place - middle) / std::hypot(place->x() - middle.x(), place->y() - middle.y());
            painter.setPen(QPen(color, 2.0));
            painter.drawLine(middle + out * (kCenter + 1), *place);
        }
        painter.setPen(QPen(lit ? QColor(255, 255, 255) : color, 1.6));
        painter.setBrush(lit ? QColor(255, 255, 255) : isPositive(end) ? color : QColor(12, 14, 16, 230));
        const double radius = isPositive(end) || lit ? kEnd - 0.8 : kOtherEnd - 0.8;
        painter.drawEllipse(*place, radius, radius);
        if (!isPositive(end) && !lit) continue;
        const QString axis = QString(QLatin1Char("XYZ"[int(end) % 3]));
        painter.setPen(QColor(12, 14, 16));
        painter.drawText(QRectF(place->x() - kSide / 2.0, place->y() - kEnd, kSide, 2 * kEnd), Qt::AlignCenter,
                         isPositive(end) ? axis : QStringLiteral("−") + axis);
    }

    const bool lit = m_hovered == Part::Middle;
    painter.setPen(Qt::NoPen);
    painter.setBrush(lit ? QColor(255, 255, 255) : QColor(12, 14, 16, 230));
    painter.drawEllipse(middle, kCenter, kCenter);
    painter.setPen(QPen(lit ? QColor(12, 14, 16) : kMarkText, 1.4));
    painter.setBrush(Qt::NoBrush);
    painter.drawPolygon(frameIcon(middle, m_camera.orthographic));
}

}  // namespace punctum::ui
