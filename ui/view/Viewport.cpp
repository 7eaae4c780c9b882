// SPDX-License-Identifier: MIT
#include "ui/view/Viewport.h"

#include "ui/basic/Text.h"
#include "ui/document/Document.h"
#include "ui/marks/LegendOf.h"
#include "ui/view/ClipFrame.h"
#include "ui/view/MessageArea.h"
#include "ui/view/Overlays.h"
#include "ui/view/PivotMark.h"
#include "ui/view/StartPage.h"
#include "ui/view/ViewNavigator.h"
#include "ui/view/ViewSettings.h"
#include "ui/view/ViewSurface.h"

#include <QDragEnterEvent>
#include <QDropEvent>
#include <QKeyEvent>
#include <QMimeData>
#include <QMouseEvent>
#include <QVariantAnimation>
#include <QWheelEvent>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace punctum::ui
{

namespace
{

constexpr int kFlightTime = 240;  // ms
constexpr int kEdge = 12;         // px between overlays and the view's edge
constexpr int kMarkTime = 3000;   // ms that a place is marked to which somebody went
/// What a view must have for a panel in its corner: smaller ones are left to title, legend and scale bar. px
constexpr QSize kRoomForCorner(360, 300);

QString attributeOf(const QMimeData& data)
{
    return QString::fromUtf8(data.data(QLatin1String(kAttributeMimeType)));
}

}  // namespace

Viewport::Viewport(ViewRenderer& renderer, ViewSettings& settings, bool openGl, QWidget* parent)
    : QWidget(parent),
      m_renderer(renderer),
      m_settings(settings),
      m_surface(makeViewSurface(*this, openGl)),
      m_clipFrame(new ClipFrame(*this)),
      m_pivotMark(new PivotMark(this)),
      m_navigator(new ViewNavigator(*this, *m_pivotMark)),
      m_title(new TitleOverlay(this)),
      m_legend(new LegendOverlay(this)),
      m_compass(new CompassOverlay(this)),
      m_startPage(new StartPage(this)),
      m_dropHint(new DropHint(this)),
      m_messages(new MessageArea(this)),
      m_flight(new QVariantAnimation(this))
{
    setAcceptDrops(true);
    setMouseTracking(true);
    setFocusPolicy(Qt::StrongFocus);
    setMinimumSize(240, 180);
    setAccessibleName(tr("View of the point cloud"));

    m_flight->setStartValue(0.0);
    m_flight->setEndValue(1.0);
    m_flight->setDuration(kFlightTime);
    connect(m_flight, &QVariantAnimation::valueChanged, this, [this](const QVariant& t) {
        applyCamera(Navigation::between(m_flightStart, m_flightEnd, t.toDouble()));
    });
    connect(m_navigator, &ViewNavigator::cameraMoved, this, &Viewport::userCamera);
    connect(m_navigator, &ViewNavigator::flownTo, this, &Viewport::flyTo);
    connect(m_messages, &MessageArea::resized, this, &Viewport::placeOverlays);
    connect(m_clipFrame, &ClipFrame::boxDragged, this, [this](const WorldBounds& box) {
        Clip clip = m_settings.display().clip;
        clip.box = box;
        m_settings.setClip(clip);
    });
    connect(&m_renderer, &ViewRenderer::frameReady, this, &Viewport::takeFrame);
    connect(&m_settings, &ViewSettings::changed, this, &Viewport::sendDisplay);
    sendDisplay();
    applyCamera(m_camera);
}

Viewport::~Viewport() = default;

bool Viewport::usesOpenGl() const
{
    return m_surface->usesOpenGl();
}

QSize Viewport::pictureSize() const
{
    return {std::max(1, int(std::lround(width() * m_pixelRatio))),
            std::max(1, int(std::lround(height() * m_pixelRatio)))};
}

glm::dvec2 Viewport::toPicture(QPointF position) const
{
    return {position.x() * m_pixelRatio, position.y() * m_pixelRatio};
}

// -- camera

void Viewport::applyCamera(const render::Camera& camera)
{
    m_camera = camera;
    m_renderer.setCamera(camera);
    m_clipFrame->setCamera(camera);
    m_pivotMark->setCamera(camera, m_pixelRatio);
    m_compass->setCamera(camera, pictureSize().height(), m_pixelRatio, viewUnit());
    emit cameraChanged();
}

void Viewport::setCamera(const render::Camera& camera, bool animated)
{
    m_fitted = false;
    moveTo(camera, animated);
}

void Viewport::moveTo(const render::Camera& camera, bool animated)
{
    m_flight->stop();
    m_navigator->forgetTarget();
    if (!animated || !isVisible()) {
        applyCamera(camera);
        return;
    }
    m_flightStart = m_camera;
    m_flightEnd = camera;
    m_flight->start();
}

void Viewport::setSceneBounds(const WorldBounds& bounds, const glm::dvec3& stretch)
{
    m_bounds = bounds;
    m_stretch = stretch;
    m_navigator->setReach(ViewReach::of(bounds, stretch));
}

void Viewport::setFlat()
{
    m_flat = true;
    m_navigator->setFlat();
    setAccessibleName(tr("Section of the point cloud"));
    setDocument(m_document, m_documents);
}

void Viewport::setCuts(std::vector<ClipPlane> cuts)
{
    if (cuts == m_cuts) return;
    m_cuts = std::move(cuts);
    sendDisplay();
}

bool Viewport::keeps(const glm::dvec3& world) const noexcept
{
    return std::all_of(m_cuts.begin(), m_cuts.end(),
                       [&](const ClipPlane& cut) { return glm::dot(cut.normal, world) >= cut.distance; });
}

void Viewport::holdCamera()
{
    m_flight->stop();
}

void Viewport::userCamera(const render::Camera& camera)
{
    if (m_bounds.empty()) return;  // there is nothing to look at from elsewhere
    ++m_userMoves;
    m_fitted = false;
    m_flight->stop();
    applyCamera(camera);
}

void Viewport::fitTo(const WorldBounds& bounds, bool animated)
{
    if (bounds.empty()) return;
    m_fitBounds = bounds;
    const QSize size = pictureSize();
    render::Camera camera = m_camera;
    camera.stretch = m_stretch;
    camera.fit(bounds, {size.width(), size.height()});
    m_fitted = true;
    moveTo(camera, animated);
}

const render::Camera& Viewport::heading() const
{
    return m_flight->state() == QAbstractAnimation::Running ? m_flightEnd : m_camera;
}

void Viewport::flyTo(const render::Camera& camera)
{
    if (m_bounds.empty()) return;  // there is nothing to look at from elsewhere
    ++m_userMoves;
    setCamera(camera, true);
}

void Viewport::setOrthographic(bool on)
{
    render::Camera camera = heading();
    if (camera.orthographic == on) return;
    camera.orthographic = on;
    ++m_userMoves;
    setCamera(camera, m_flight->state() == QAbstractAnimation::Running);
}

void Viewport::goTo(const glm::dvec3& world)
{
    render::Camera camera = heading();
    const glm::dvec3 way = camera.forward() * camera.pivotDepth() / camera.stretch;
    camera.pivot = world;
    camera.eye = world - way;
    flyTo(camera);
    m_pivotMark->flash(kMarkTime);
}

bool Viewport::turnTo(render::Camera& camera, const QString& name)
{
    const std::string view = name.toStdString();
    if (!camera.setView(view)) return false;
    camera.orthographic = camera.orthographic || render::seenInParallel(view);
    return true;
}

void Viewport::lookFrom(const QString& name)
{
    render::Camera camera = heading();
    const double depth = camera.pivotDepth();
    if (!turnTo(camera, name)) return;
    camera.eye = camera.pivot - camera.forward() * depth / camera.stretch;
    flyTo(camera);
}

void Viewport::setStandardView(const QString& name)
{
    render::Camera camera = m_camera;
    if (!turnTo(camera, name)) return;
    const QSize size = pictureSize();
    if (m_fitBounds.empty()) m_fitBounds = m_bounds;
    camera.stretch = m_stretch;
    camera.fit(m_fitBounds, {size.width(), size.height()});
    ++m_userMoves;
    m_fitted = true;
    moveTo(camera, true);
}

// -- mouse and keys

void Viewport::mousePressEvent(QMouseEvent* event)
{
    setFocus(Qt::MouseFocusReason);
    m_mouse = event->position();
    m_navigator->press(*event);
    event->accept();
}

void Viewport::mouseMoveEvent(QMouseEvent* event)
{
    m_mouse = event->position();
    m_mouseInside = rect().contains(m_mouse.toPoint());
    m_navigator->move(m_mouse);
    if (m_navigator->dragging())
        setCursor(m_navigator->moved() ? Qt::ClosedHandCursor : Qt::ArrowCursor);
    else
        requestHover();
    event->accept();
}

void Viewport::mouseReleaseEvent(QMouseEvent* event)
{
    m_navigator->release(*event);
    unsetCursor();
    event->accept();
}

void Viewport::mouseDoubleClickEvent(QMouseEvent* event)
{
    if (event->button() == Qt::LeftButton) m_navigator->centerOn(event->position());
    event->accept();
}

void Viewport::wheelEvent(QWheelEvent* event)
{
    m_mouse = event->position();
    m_navigator->wheel(*event);
    event->accept();
}

void Viewport::keyPressEvent(QKeyEvent* event)
{
    if (!m_document || !m_navigator->key(*event)) QWidget::keyPressEvent(event);
}

void Viewport::leaveEvent(QEvent* event)
{
    m_mouseInside = false;
    emit hovered(std::nullopt);
    QWidget::leaveEvent(event);
}

void Viewport::requestHover()
{
    if (!m_document) return;
    if (m_hoverAsked) {
        m_hoverAgain = true;
        return;
    }
    m_hoverAsked = true;
    const glm::dvec2 px = toPicture(m_mouse);
    m_renderer.pick(int(px.x), int(px.y), this, [this](const std::optional<PickedPoint>& point) {
        m_hoverAsked = false;
        emit hovered(m_mouseInside ? point : std::nullopt);
        if (std::exchange(m_hoverAgain, false) && m_mouseInside) requestHover();
    });
}

// -- dropping

void Viewport::showDropHint(const QString& text)
{
    m_dropHint->setText(text);
    m_dropHint->show();
    m_dropHint->raise();
}

void Viewport::hideDropHint()
{
    m_dropHint->hide();
}

void Viewport::dragEnterEvent(QDragEnterEvent* event)
{
    const QMimeData& mime = *event->mimeData();
    if (!mime.hasFormat(QLatin1String(kAttributeMimeType))) return;
    showDropHint(tr("Color by %1").arg(attributeOf(mime)));
    event->acceptProposedAction();
}

void Viewport::dragLeaveEvent(QDragLeaveEvent* event)
{
    hideDropHint();
    event->accept();
}

void Viewport::dropEvent(QDropEvent* event)
{
    hideDropHint();
    const QMimeData& mime = *event->mimeData();
    if (!mime.hasFormat(QLatin1String(kAttributeMimeType))) return;
    emit attributeDropped(attributeOf(mime));
    event->acceptProposedAction();
}

// -- picture and overlays

bool Viewport::event(QEvent* event)
{
    // Another screen may have another ratio of px; the show event comes when the first one is known.
    if (event->type() == QEvent::ScreenChangeInternal || event->type() == QEvent::Show) sendSize();
    return QWidget::event(event);
}

void Viewport::resizeEvent(QResizeEvent* event)
{
    QWidget::resizeEvent(event);
    sendSize();
    placeOverlays();
}

void Viewport::sendSize()
{
    const double ratio = devicePixelRatioF();
    const bool ratioChanged = ratio != m_pixelRatio;
    m_pixelRatio = ratio;
    const QSize size = pictureSize();
    m_navigator->setSize({size.width(), size.height()});
    m_renderer.setSize(size.width(), size.height());
    if (ratioChanged) sendDisplay();
    if (m_fitted)
        fitTo(WorldBounds(m_fitBounds), false);
    else
        applyCamera(m_camera);
}

render::DisplaySettings Viewport::displayFor(double scale) const
{
    render::DisplaySettings display = m_settings.display();
    display.pointSize *= scale;  // chosen in logical px
    display.contours.width *= scale;
    display.cuts = m_cuts;
    if (m_flat) display.surface = render::SurfaceLook::None;  // a slab shows hardly anything of it
    return display;
}

void Viewport::sendDisplay()
{
    const render::DisplaySettings display = displayFor(m_pixelRatio);
    m_renderer.setDisplay(display);
    m_clipFrame->setBox(display.clip.box);
    updateLegend();
}

void Viewport::takeFrame()
{
    m_frame = m_renderer.frame();
    m_surface->showFrame(m_frame);
    updateLegend();
    emit frameShown();
}

void Viewport::setDocument(Document* document, int documents)
{
    if (m_document) m_document->disconnect(this);
    m_document = document;
    m_documents = documents;
    if (document) {
        connect(document, &Document::stateChanged, this, &Viewport::updateTitle);
        connect(document, &Document::attributesChanged, this, &Viewport::updateLegend);
        connect(document, &Document::figuresChanged, this, &Viewport::updateLegend);
        connect(document, &Document::classCountsChanged, this, &Viewport::updateLegend);
        connect(document, &Document::previewedClassesChanged, this, &Viewport::updateLegend);
    }
    m_startPage->setVisible(documents == 0 && !m_flat);
    m_compass->setVisible(documents > 0 && !m_flat);
    updateTitle();
    updateLegend();
    applyCamera(m_camera);
}

void Viewport::updateTitle()
{
    if (!m_document || m_flat) {
        m_title->setContent({}, {});
    } else {
        QString detail = pointsText(m_document->points());
        if (m_document->deletedPoints() != 0)
            detail = tr("%1, %2 deleted").arg(detail, countText(m_document->deletedPoints()));
        if (m_document->loading())
            detail =
                tr("%1 of %2")
                    .arg(countText(PointIndex(m_document->loadedShare() * double(m_document->points()))), detail);
        if (m_document->many() && m_document->named())
            detail += tr(" in %1 files").arg(countText(m_document->parts().size()));
        if (m_documents > 1) detail += tr("  ·  one of %1 open").arg(m_documents);
        if (m_document->recovered())
            detail += m_document->many() ? tr("  ·  some damaged") : tr("  ·  damaged file");
        m_title->setContent(m_document->name(), detail);
        m_title->setProgress(m_document->loading() ? m_document->loadedShare() : -1.0);
    }
    placeOverlays();
}

void Viewport::updateLegend()
{
    Legend legend;
    if (m_document && m_frame && !m_flat)
        legend = legendOf(*m_document, m_frame->attribute, m_frame->range, m_settings.display());
    const QSize before = m_legend->size();
    m_legend->setContent(legend);
    if (m_legend->size() != before) placeOverlays();
}

void Viewport::placeOverlays()
{
    m_surface->widget().setGeometry(rect());
    m_clipFrame->setGeometry(rect());
    m_startPage->setGeometry(rect());
    m_dropHint->setGeometry(rect());
    m_title->move(kEdge, kEdge);
    if (m_underTitle && !m_underTitle->isHidden())
        // A section has the heights at its left.
        m_underTitle->move(m_flat ? width() - m_underTitle->width() - kEdge : kEdge,
                           m_title->isHidden() ? kEdge : m_title->geometry().bottom() + kEdge / 2);
    m_compass->resize(m_compass->sizeHint());
    m_compass->move(kEdge, height() - m_compass->height() - kEdge);
    // Below the title, in what the view's width leaves.
    const int top = m_title->isVisible() ? m_title->geometry().bottom() + kEdge : kEdge;
    placeCorner();
    const bool corner = m_corner && !m_corner->isHidden();
    const int legendTop = corner ? std::max(top, m_corner->geometry().bottom() + kEdge) : top;
    m_legend->setRoom({width() - 2 * kEdge, height() - legendTop - 2 * kEdge - m_compass->height()});
    // Beside the compass where there is room, else above it.
    const int legendLeft = width() - m_legend->width() - kEdge;
    const int legendBottom = legendLeft > m_compass->geometry().right() ? height() : m_compass->y();
    m_legend->move(legendLeft, legendBottom - m_legend->height() - kEdge);
    placeMessages();
}

void Viewport::showCorner(bool shown)
{
    m_cornerShown = shown;
    placeOverlays();
}

void Viewport::placeCorner()
{
    if (!m_corner) return;
    const bool room = width() >= kRoomForCorner.width() && height() >= kRoomForCorner.height();
    m_corner->setVisible(m_cornerShown && m_documents > 0 && room);
    // Beside the title and what is under it where there is room, else below them.
    const int left = width() - m_corner->width() - kEdge;
    int top = kEdge;
    for (const QWidget* panel : {static_cast<const QWidget*>(m_title), static_cast<const QWidget*>(m_underTitle)})
        if (panel && !panel->isHidden() && panel->geometry().right() + kEdge > left)
            top = std::max(top, panel->geometry().bottom() + kEdge);
    m_corner->move(left, top);
}

void Viewport::placeMessages()
{
    // Between the title and the corner where there is room, else under them.
    const int free = width() - 2 * kEdge;
    int left = kEdge, right = width() - kEdge;
    int bottom = m_title->geometry().bottom();
    if (m_title->isVisible()) left = m_title->geometry().right() + kEdge;
    if (m_underTitle && !m_underTitle->isHidden()) {
        left = std::max(left, m_underTitle->geometry().right() + kEdge);
        bottom = m_underTitle->geometry().bottom();
    }
    if (m_corner && !m_corner->isHidden()) {
        right = m_corner->x() - kEdge;
        bottom = std::max(bottom, m_corner->geometry().bottom());
    }
    const int wanted = std::min(680, free);
    const bool beside = right - left >= std::min(440, free);
    const int fitting = beside ? std::min(wanted, right - left) : wanted;
    const int middle = (width() - fitting) / 2;
    const int x = beside ? std::clamp(middle, left, right - fitting) : std::max(middle, kEdge);
    m_messages->setGeometry(x, beside ? kEdge : bottom + kEdge, fitting, m_messages->heightForWidth(fitting));
    m_messages->raise();
}

QString Viewport::viewUnit() const
{
    return m_document ? m_document->lengthUnit() : QString();
}

}  // namespace punctum::ui
