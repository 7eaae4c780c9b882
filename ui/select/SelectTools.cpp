// SPDX-License-Identifier: MIT
#include "ui/select/SelectTools.h"

#include "ui/select/Selection.h"
#include "ui/view/Viewport.h"

#include <QMouseEvent>
#include <QPainter>
#include <QPainterPath>
#include <QWheelEvent>

#include <algorithm>
#include <cmath>

namespace punctum::ui
{

namespace
{

constexpr double kLeastRadius = 2.0, kMostRadius = 400.0;  // of the brush, logical px
constexpr double kRadiusStep = 1.15;                       // a notch of the wheel
constexpr double kLassoStep = 3.0;                         // logical px between two corners
constexpr double kClickSlack = 4.0;                        // a shape smaller than this is a click

using Outline = ShapeOverlay::Outline;

SelectMode modeOf(Qt::KeyboardModifiers modifiers, SelectMode otherwise)
{
    const bool add = modifiers.testFlag(Qt::ShiftModifier), take = modifiers.testFlag(Qt::ControlModifier);
    if (add && take) return SelectMode::Intersect;
    return add ? SelectMode::Add : take ? SelectMode::Subtract : otherwise;
}

}  // namespace

// -- what is drawn

ShapeOverlay::ShapeOverlay(QWidget* parent) : QWidget(parent)
{
    setAttribute(Qt::WA_TransparentForMouseEvents);
    setAttribute(Qt::WA_NoSystemBackground);
    hide();
}

void ShapeOverlay::setOutline(std::vector<QPointF> corners, Outline outline)
{
    m_corners = std::move(corners);
    m_outline = outline;
    show();
    QWidget::update();
}

void ShapeOverlay::setCircle(QPointF middle, double radius)
{
    m_middle = middle;
    m_radius = radius;
    setVisible(radius > 0.0 || !m_corners.empty());
    QWidget::update();
}

void ShapeOverlay::clear()
{
    m_corners.clear();
    setVisible(m_radius > 0.0);
    QWidget::update();
}

void ShapeOverlay::paintEvent(QPaintEvent*)
{
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    // dark under light: to be seen on any picture
    const auto stroke = [&](const QPainterPath& path, double width, Qt::PenStyle style) {
        painter.strokePath(path, QPen(QColor(0, 0, 0, 150), width + 2.0));
        painter.strokePath(path, QPen(QColor(255, 236, 140), width, style));
    };
    if (!m_corners.empty()) {
        QPainterPath path(m_corners.front());
        for (const QPointF& corner : m_corners) path.lineTo(corner);
        const bool above = m_outline == Outline::Above, below = m_outline == Outline::Below;
        if (above || below) {
            // each piece by itself, as a line may go back
            const double edge = above ? 0.0 : double(height());
            for (std::size_t k = 0; k + 1 < m_corners.size(); ++k) {
                const QPointF &a = m_corners[k], &b = m_corners[k + 1];
                QPainterPath side;
                side.addPolygon(QPolygonF{{a, b, QPointF(b.x(), edge), QPointF(a.x(), edge)}});
                painter.fillPath(side, QColor(255, 214, 64, 34));
            }
        } else if (m_corners.size() > 2) {
            painter.fillPath(path, QColor(255, 214, 64, 34));
        }
        if (m_outline == Outline::Closed) path.closeSubpath();
        stroke(path, 1.4, Qt::SolidLine);
        if (m_outline == Outline::Unclosed) {
            QPainterPath back(m_corners.back());
            back.lineTo(m_corners.front());
            stroke(back, 1.0, Qt::DashLine);
        }
        if (m_outline != Outline::Closed) {
            painter.setPen(QPen(QColor(0, 0, 0, 150), 1.0));
            painter.setBrush(QColor(255, 236, 140));
            for (std::size_t k = 0; k + 1 < m_corners.size(); ++k) painter.drawEllipse(m_corners[k], 3.0, 3.0);
        }
    }
    if (m_radius > 0.0) {
        QPainterPath circle;
        circle.addEllipse(m_middle, m_radius, m_radius);
        stroke(circle, 1.4, Qt::SolidLine);
    }
}

// -- the tools

SelectTools::SelectTools(Viewport& viewport, Selection& selection, QObject* parent)
    : QObject(parent), m_selection(selection)
{
    addView(viewport);
}

void SelectTools::addView(Viewport& viewport)
{
    auto* const overlay = new ShapeOverlay(&viewport);
    overlay->setGeometry(viewport.rect());
    m_views.push_back({&viewport, overlay});
    viewport.installEventFilter(this);
    connect(&viewport, &Viewport::cameraChanged, this, [this, &viewport] {
        if (&viewport == m_viewport) followCamera();
    });
    if (!m_viewport) enter(viewport);
}

SelectTools::View& SelectTools::viewOf(const QObject* viewport)
{
    return *std::find_if(m_views.begin(), m_views.end(),
                         [&](const View& view) { return view.viewport == viewport; });
}

void SelectTools::enter(Viewport& viewport)
{
    if (m_viewport == &viewport) return;
    if (m_overlay) m_overlay->setCircle(m_mouse, 0.0);
    m_viewport = &viewport;
    m_overlay = viewOf(&viewport).overlay;
}

/// Whether the tool's shape is made of clicks.
bool SelectTools::clicked() const noexcept
{
    return m_tool == Tool::Polygon || m_tool == Tool::AboveLine || m_tool == Tool::BelowLine;
}

void SelectTools::setCursors(Qt::CursorShape shape)
{
    for (const View& view : m_views) view.viewport->setCursor(shape);
}

void SelectTools::setCircle(bool shown)
{
    m_overlay->setCircle(m_mouse, shown && m_tool == Tool::Brush ? m_radius : 0.0);
}

void SelectTools::setTool(Tool tool)
{
    if (tool == m_tool) return;
    giveUp();
    m_tool = tool;
    setSpace(false);
    setCircle(true);
    if (tool == Tool::None)
        for (const View& view : m_views) view.viewport->unsetCursor();
    else
        setCursors(Qt::CrossCursor);
    emit toolChanged(tool);
}

void SelectTools::setBrushRadius(double px)
{
    m_radius = std::clamp(px, kLeastRadius, kMostRadius);
    if (m_tool == Tool::Brush) setCircle(true);
    emit brushRadiusChanged(m_radius);
}

ScreenMask SelectTools::mask() const
{
    if (m_tool == Tool::Brush) return m_stroke;
    const QSize size = m_viewport->pictureSize();
    ScreenMask mask(size.width(), size.height());
    if (m_corners.empty()) return mask;
    if (m_tool == Tool::Rectangle) {
        mask.addRectangle(m_viewport->toPicture(m_corners.front()), m_viewport->toPicture(m_mouse));
        return mask;
    }
    std::vector<glm::dvec2> corners;
    for (const QPointF& corner : m_corners) corners.push_back(m_viewport->toPicture(corner));
    if (m_shape && clicked()) corners.push_back(m_viewport->toPicture(m_mouse));
    if (m_tool == Tool::Polygon || m_tool == Tool::Lasso)
        mask.addPolygon(corners);
    else
        for (std::size_t k = 0; k + 1 < corners.size(); ++k)
            mask.addSideOf(corners[k], corners[k + 1], m_tool == Tool::AboveLine);
    return mask;
}

bool SelectTools::enough() const
{
    switch (m_tool) {
        case Tool::Rectangle:
            return !m_corners.empty() && std::abs(m_mouse.x() - m_corners.front().x()) >= kClickSlack &&
                   std::abs(m_mouse.y() - m_corners.front().y()) >= kClickSlack;
        case Tool::Polygon:
        case Tool::Lasso:
            return m_corners.size() >= 3;
        case Tool::AboveLine:
        case Tool::BelowLine:
            return m_corners.size() >= 2;
        case Tool::Brush:
            return true;
        case Tool::None:
            break;
    }
    return false;
}

void SelectTools::start(QPointF at, Qt::KeyboardModifiers modifiers)
{
    m_viewport->holdCamera();
    m_shape = true;
    m_corners = {at};
    m_selection.begin(modeOf(modifiers, m_selection.mode()), &m_viewport->renderer(), m_viewport->cuts());
    if (m_tool == Tool::Brush) {
        const QSize size = m_viewport->pictureSize();
        m_stroke = ScreenMask(size.width(), size.height());
        const double ratio = m_viewport->pixelRatio();
        m_stroke.addStroke(m_viewport->toPicture(at), m_viewport->toPicture(at), m_radius * ratio);
        m_selection.draw(m_stroke);
    }
}

void SelectTools::update(QPointF to)
{
    switch (m_tool) {
        case Tool::Rectangle: {
            const QPointF from = m_corners.front();
            m_overlay->setOutline({from, {to.x(), from.y()}, to, {from.x(), to.y()}}, Outline::Closed);
            break;
        }
        case Tool::Lasso:
            if (QLineF(m_corners.back(), to).length() >= kLassoStep) m_corners.push_back(to);
            m_overlay->setOutline(m_corners, Outline::Closed);
            break;
        case Tool::Polygon:
        case Tool::AboveLine:
        case Tool::BelowLine: {
            auto corners = m_corners;
            corners.push_back(to);
            m_overlay->setOutline(std::move(corners), m_tool == Tool::Polygon     ? Outline::Unclosed
                                                      : m_tool == Tool::AboveLine ? Outline::Above
                                                                                  : Outline::Below);
            break;
        }
        case Tool::Brush:
            m_stroke.addStroke(m_viewport->toPicture(m_corners.back()), m_viewport->toPicture(to),
                               m_radius * m_viewport->pixelRatio());
            m_corners.back() = to;
            break;
        case Tool::None:
            return;
    }
    // the place under the mouse is the next corner of those that are clicked
    const std::size_t soFar = m_corners.size() + 1;
    if (clicked() ? soFar >= (m_tool == Tool::Polygon ? 3u : 2u) : enough()) m_selection.draw(mask());
}

void SelectTools::close()
{
    if (!enough()) {
        // a click beside everything takes the selection away, as it does elsewhere
        const bool click = m_tool == Tool::Rectangle || m_tool == Tool::Lasso;
        giveUp();
        if (click && m_selection.mode() == SelectMode::Replace) m_selection.clear();
        return;
    }
    m_shape = false;
    m_selection.finish(mask());
    m_corners.clear();
    m_anchors.clear();
    m_overlay->clear();
}

void SelectTools::giveUp()
{
    if (!std::exchange(m_shape, false)) return;
    m_corners.clear();
    m_anchors.clear();
    m_selection.abandon();
    m_overlay->clear();
}

void SelectTools::followCamera()
{
    if (!m_shape) return;
    m_selection.viewMoved();
    if (!clicked() || m_anchors.size() != m_corners.size()) return;
    const QSize size = m_viewport->pictureSize();
    const double ratio = m_viewport->pixelRatio();
    for (std::size_t k = 0; k < m_corners.size(); ++k) {
        const glm::dvec3 px = m_viewport->camera().project(m_anchors[k], {size.width(), size.height()});
        m_corners[k] = {px.x / ratio, px.y / ratio};
    }
    update(m_mouse);
}

void SelectTools::setSpace(bool held)
{
    if (held == m_space) return;
    m_space = held;
    if (m_tool == Tool::None) return;
    setCursors(held ? Qt::OpenHandCursor : Qt::CrossCursor);
    setCircle(!held);
}

// -- events of the viewport; true: taken

bool SelectTools::eventFilter(QObject* watched, QEvent* event)
{
    View& view = viewOf(watched);
    if (event->type() == QEvent::Resize || event->type() == QEvent::Show) {
        view.overlay->setGeometry(view.viewport->rect());
        view.overlay->raise();
    }
    if (m_tool == Tool::None) return false;
    if (view.viewport != m_viewport) {
        const bool press = event->type() == QEvent::MouseButtonPress;
        const bool mouse = press || event->type() == QEvent::MouseMove || event->type() == QEvent::Wheel;
        if (mouse && m_shape && (m_space || !press)) return false;
        if (press) giveUp();  // drawn on elsewhere: this is another shape
        if (mouse) enter(*view.viewport);
    }
    switch (event->type()) {
        case QEvent::MouseButtonPress:
            return mousePressed(*static_cast<QMouseEvent*>(event));
        case QEvent::MouseMove:
            return mouseMoved(*static_cast<QMouseEvent*>(event));
        case QEvent::MouseButtonRelease:
            return mouseReleased(*static_cast<QMouseEvent*>(event));
        case QEvent::MouseButtonDblClick:
            return doubleClicked(*static_cast<QMouseEvent*>(event));
        case QEvent::Wheel:
            return wheelTurned(*static_cast<QWheelEvent*>(event));
        case QEvent::KeyPress:
            return keyPressed(*static_cast<QKeyEvent*>(event));
        case QEvent::KeyRelease: {
            const auto& key = *static_cast<QKeyEvent*>(event);
            if (key.key() != Qt::Key_Space || key.isAutoRepeat()) return false;
            setSpace(false);
            return true;
        }
        case QEvent::FocusOut:
            setSpace(false);
            return false;
        case QEvent::Leave:
            view.overlay->setCircle(m_mouse, 0.0);
            return false;
        default:
            return false;
    }
}

bool SelectTools::mousePressed(const QMouseEvent& event)
{
    if (m_space) return false;
    m_mouse = event.position();
    if (event.button() == Qt::RightButton && clicked() && m_shape) {
        m_takenPress = true;
        close();
        return true;
    }
    if (event.button() != Qt::LeftButton) return false;
    m_viewport->setFocus(Qt::MouseFocusReason);
    m_takenPress = true;
    if (clicked()) {
        if (!m_shape) {
            start(m_mouse, event.modifiers());
            m_anchors.clear();
        } else {
            m_corners.push_back(m_mouse);
        }
        const QSize size = m_viewport->pictureSize();
        m_anchors.push_back(
            m_viewport->camera().unproject(m_viewport->toPicture(m_mouse), {size.width(), size.height()}));
        update(m_mouse);
    } else {
        start(m_mouse, event.modifiers());
    }
    return true;
}

bool SelectTools::mouseMoved(const QMouseEvent& event)
{
    m_mouse = event.position();
    if (m_space) return false;
    if (m_tool == Tool::Brush) setCircle(true);
    if (m_shape) update(m_mouse);
    if (event.buttons() == Qt::NoButton || !m_takenPress) m_viewport->setCursor(Qt::CrossCursor);
    return m_takenPress;
}

bool SelectTools::mouseReleased(const QMouseEvent& event)
{
    if (!std::exchange(m_takenPress, false)) {
        m_viewport->setCursor(m_space ? Qt::OpenHandCursor : Qt::CrossCursor);
        return false;
    }
    m_mouse = event.position();
    if (m_shape && !clicked() && event.button() == Qt::LeftButton) {
        update(m_mouse);
        close();
    }
    return true;
}

bool SelectTools::doubleClicked(const QMouseEvent& event)
{
    if (m_space || event.button() != Qt::LeftButton) return false;
    m_takenPress = true;
    if (clicked() && m_shape)
        close();
    else
        return mousePressed(event);
    return true;
}

bool SelectTools::wheelTurned(const QWheelEvent& event)
{
    if (m_tool != Tool::Brush || m_space) return false;
    setBrushRadius(m_radius * std::pow(kRadiusStep, event.angleDelta().y() / 120.0));
    return true;
}

bool SelectTools::keyPressed(const QKeyEvent& event)
{
    switch (event.key()) {
        case Qt::Key_Space:
            if (!event.isAutoRepeat()) setSpace(true);
            return true;
        case Qt::Key_Escape:
            if (m_shape)
                giveUp();
            else
                setTool(Tool::None);
            return true;
        case Qt::Key_Backspace:
            if (!clicked() || !m_shape) return false;
            m_corners.pop_back();
            m_anchors.pop_back();
            if (m_corners.empty())
                giveUp();
            else
                update(m_mouse);
            return true;
        case Qt::Key_Return:
        case Qt::Key_Enter:
            if (!clicked() || !m_shape) return false;
            close();
            return true;
        default:
            return false;
    }
}

}  // namespace punctum::ui
