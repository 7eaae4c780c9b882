// SPDX-License-Identifier: MIT
#include "ui/measure/MeasureTools.h"

#include "ui/document/Document.h"
#include "ui/document/Workspace.h"
#include "ui/measure/MeasurePainting.h"
#include "ui/measure/Measurements.h"
#include "ui/view/Navigation.h"
#include "ui/view/ViewRenderer.h"
#include "ui/view/Viewport.h"

#include <QKeyEvent>
#include <QMouseEvent>
#include <QPainter>

#include <algorithm>
#include <cmath>

namespace punctum::ui
{

namespace
{

constexpr double kOnCorner = 8.0;  ///< px from a corner that still mean it

}  // namespace

// -- overlay

MeasureOverlay::MeasureOverlay(Viewport& viewport, const Measurements& measurements)
    : QWidget(&viewport), m_viewport(viewport), m_measurements(measurements)
{
    setAttribute(Qt::WA_TransparentForMouseEvents);
    setAttribute(Qt::WA_NoSystemBackground);
    connect(&viewport, &Viewport::frameShown, this, qOverload<>(&QWidget::update));
    connect(&viewport, &Viewport::cameraChanged, this, qOverload<>(&QWidget::update));
    connect(&measurements, &Measurements::changed, this, qOverload<>(&QWidget::update));
}

void MeasureOverlay::setUnfinished(std::optional<Measurement> measurement)
{
    m_unfinished = std::move(measurement);
    update();
}

QString MeasureOverlay::unfinishedText() const
{
    if (!m_unfinished || m_unfinished->quantities.empty()) return {};
    return quantityText(m_unfinished->quantities.front(), m_unfinished->length);
}

void MeasureOverlay::paintEvent(QPaintEvent*)
{
    QPainter painter(this);
    for (const Measurements::Entry& entry : m_measurements.entries()) {
        const auto& points = entry.measurement.points;
        if (std::all_of(points.begin(), points.end(),
                        [&](const MeasuredPoint& p) { return m_viewport.keeps(p.world); }))
            paintMeasurement(painter, entry.measurement, m_viewport.camera(), size(), false);
    }
    if (m_unfinished) paintMeasurement(painter, *m_unfinished, m_viewport.camera(), size(), true);
}

// -- tools

MeasureTools::MeasureTools(Viewport& viewport, Workspace& workspace, Measurements& measurements, QObject* parent)
    : QObject(parent), m_workspace(workspace), m_measurements(measurements)
{
    addView(viewport);
    connect(&workspace, &Workspace::documentRemoved, this, [this](Document* document) {
        if (document == m_document) giveUp();
    });
}

void MeasureTools::addView(Viewport& viewport)
{
    auto* const overlay = new MeasureOverlay(viewport, m_measurements);
    overlay->setGeometry(viewport.rect());
    m_views.push_back({&viewport, overlay});
    viewport.installEventFilter(this);
    connect(&viewport, &Viewport::hovered, this, &MeasureTools::follow);
}

void MeasureTools::setTool(std::optional<MeasureKind> tool)
{
    if (tool == m_tool) return;
    m_tool = tool;
    giveUp();
    for (const View& view : m_views)
        if (tool)
            view.viewport->setCursor(Qt::CrossCursor);
        else
            view.viewport->unsetCursor();
    emit toolChanged();
}

void MeasureTools::setUnfinished(const std::optional<Measurement>& measurement)
{
    for (const View& view : m_views) view.overlay->setUnfinished(measurement);
}

void MeasureTools::giveUp()
{
    m_points.clear();
    m_document.clear();
    m_press.reset();
    m_closing = false;
    setUnfinished({});
}

bool MeasureTools::eventFilter(QObject* watched, QEvent* event)
{
    const View& view =
        *std::find_if(m_views.begin(), m_views.end(), [&](const View& each) { return each.viewport == watched; });
    if (event->type() == QEvent::Resize) {
        view.overlay->setGeometry(view.viewport->rect());
        return false;
    }
    if (!m_tool) return false;
    switch (event->type()) {
        case QEvent::MouseButtonPress:
            return pressed(*static_cast<QMouseEvent*>(event));
        case QEvent::MouseButtonRelease:
            return released(*view.viewport, *static_cast<QMouseEvent*>(event));
        case QEvent::MouseButtonDblClick:  // its first click took a point; the camera stays where it is
            closeArea();
            return true;
        case QEvent::ShortcutOverride:
            if (const int key = static_cast<QKeyEvent*>(event)->key();
                key == Qt::Key_Escape || key == Qt::Key_Backspace || key == Qt::Key_Return || key == Qt::Key_Enter)
                event->accept();
            return false;
        case QEvent::KeyPress:
            return keyPressed(*static_cast<QKeyEvent*>(event));
        default:
            return false;
    }
}

/// The viewport gets presses too: what becomes a drag moves the camera.
bool MeasureTools::pressed(const QMouseEvent& event)
{
    m_press.reset();
    if (event.button() == Qt::LeftButton || event.button() == Qt::RightButton) m_press = event.position();
    return false;
}

bool MeasureTools::released(Viewport& viewport, const QMouseEvent& event)
{
    const auto press = std::exchange(m_press, std::nullopt);
    const bool click = press && glm::distance(viewport.toPicture(*press), viewport.toPicture(event.position())) <
                                    Navigation::kTremble;
    if (click && event.button() == Qt::LeftButton) {
        if (isOnFirst(viewport, event.position()))
            closeArea();
        else
            pick(viewport, event.position());
    }
    if (click && event.button() == Qt::RightButton) closeArea();
    // after the viewport, which takes the cursor back
    QMetaObject::invokeMethod(
        this,
        [this, &viewport] {
            if (m_tool) viewport.setCursor(Qt::CrossCursor);
        },
        Qt::QueuedConnection);
    return false;
}

bool MeasureTools::keyPressed(const QKeyEvent& event)
{
    switch (event.key()) {
        case Qt::Key_Escape:
            if (m_points.empty())
                setTool({});
            else
                giveUp();
            return true;
        case Qt::Key_Backspace:
            if (!m_points.empty()) m_points.pop_back();
            setUnfinished({});
            return true;
        case Qt::Key_Return:
        case Qt::Key_Enter:
            closeArea();
            return true;
        default:
            return false;
    }
}

void MeasureTools::pick(Viewport& viewport, QPointF at)
{
    const glm::ivec2 px(viewport.toPicture(at));
    ++m_picks;
    viewport.renderer().pick(px.x, px.y, this, [this](const std::optional<PickedPoint>& point) {
        --m_picks;
        if (point && m_tool) take(*point);
        if (m_closing && m_picks == 0) closeArea();
    });
}

/// Of a measurement of any number of corners; the corner that was clicked last may still be looked for.
void MeasureTools::closeArea()
{
    if (!m_tool || pointsOf(*m_tool) != 0) return;
    m_closing = m_picks != 0;
    if (!m_closing) finish();
}

bool MeasureTools::isOnFirst(const Viewport& viewport, QPointF at) const
{
    if (!m_tool || pointsOf(*m_tool) != 0 || m_points.size() < 3) return false;
    const glm::dvec3 first =
        viewport.camera().project(m_points.front().world, {double(viewport.width()), double(viewport.height())});
    return std::hypot(first.x - at.x(), first.y - at.y()) < kOnCorner;
}

void MeasureTools::take(const PickedPoint& point)
{
    Document* const document = m_workspace.find(point.cloud.get());
    if (document == nullptr) return;
    if (m_points.empty()) m_document = document;
    m_points.push_back({point.index, point.world});
    if (m_points.size() == pointsOf(*m_tool))
        finish();
    else
        setUnfinished(Measurements::measure(*m_document, *m_tool, m_points));
    emit pointTaken();
}

void MeasureTools::follow(const std::optional<PickedPoint>& point)
{
    if (!m_tool || !m_document || m_points.empty()) return;
    std::vector<MeasuredPoint> points = m_points;
    if (point) points.push_back({point->index, point->world});
    setUnfinished(Measurements::measure(*m_document, *m_tool, std::move(points)));
}

void MeasureTools::finish()
{
    if (m_document && !m_points.empty()) m_measurements.add(*m_document, *m_tool, std::move(m_points));
    giveUp();
}

}  // namespace punctum::ui
