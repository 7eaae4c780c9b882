// SPDX-License-Identifier: MIT
#include "ui/section/SectionOverlays.h"

#include "ui/basic/Numbers.h"
#include "ui/view/Overlays.h"
#include "ui/view/Viewport.h"

#include <QEvent>
#include <QPainter>

#include <algorithm>
#include <cmath>

namespace punctum::ui
{

namespace
{

constexpr double kArrow = 9.0;                            // px
constexpr double kRing = 7.0;                             // px
constexpr double kHeightGap = 44.0, kDistanceGap = 90.0;  // px between two lines, at least
constexpr double kMostGridLines = 500;                    // where a camera is absurdly far away
const QColor kShadow(0, 0, 0, 150);
const QColor kBand(92, 200, 255);
const QColor kBandFill(92, 200, 255, 46);
const QColor kGridColor(255, 255, 255, 30);
const QColor kText(228, 232, 236);
const QColor kAxisPlate(12, 14, 16, 190);

/// The shortest round length that is not below `least`: neighbors among them differ by 2.5 times at most.
double stepFrom(double least)
{
    return roundLengthUpTo(least * 2.5);
}

QString numberOf(double value, double step, const QString& unit)
{
    const int decimals = std::clamp(int(std::ceil(-std::log10(step) - 1e-9)), 0, 9);
    const QString number = localNumber(QString::number(std::abs(value) < step / 2 ? 0.0 : value, 'f', decimals));
    return unit.isEmpty() ? number : number + QLatin1Char(' ') + unit;
}

}  // namespace

ViewLayer::ViewLayer(Viewport& viewport) : QWidget(&viewport), m_viewport(viewport)
{
    setAttribute(Qt::WA_TransparentForMouseEvents);
    setAttribute(Qt::WA_NoSystemBackground);
    setGeometry(viewport.rect());
    viewport.installEventFilter(this);
    connect(&viewport, &Viewport::cameraChanged, this, qOverload<>(&QWidget::update));
    hide();
}

bool ViewLayer::eventFilter(QObject*, QEvent* event)
{
    if (event->type() == QEvent::Resize) setGeometry(m_viewport.rect());
    return false;
}

const render::Camera& ViewLayer::camera() const
{
    return m_viewport.camera();
}

QPolygonF ViewLayer::projected(const std::vector<glm::dvec3>& corners) const
{
    const render::Camera& eye = camera();
    const glm::dvec2 size(std::max(1, width()), std::max(1, height()));
    const double near = eye.nearDepth();
    QPolygonF polygon;
    for (std::size_t k = 0; k < corners.size(); ++k) {
        const glm::dvec3 a = corners[k], b = corners[(k + 1) % corners.size()];
        const glm::dvec3 p = eye.project(a, size);
        const double next = eye.project(b, size).z;
        if (p.z >= near) polygon << QPointF(p.x, p.y);
        if ((p.z >= near) == (next >= near)) continue;
        const glm::dvec3 edge = eye.project(a + (b - a) * ((near - p.z) / (next - p.z)), size);
        polygon << QPointF(edge.x, edge.y);
    }
    return polygon;
}

// -- where it lies

void SectionBand::setSection(const std::optional<Section>& section, double fromHeight, double toHeight)
{
    m_section = section;
    m_fromHeight = fromHeight;
    m_toHeight = toHeight;
    setVisible(m_section || m_draft);
    update();
}

void SectionBand::setDraft(const std::optional<std::pair<glm::dvec3, glm::dvec3>>& line)
{
    m_draft = line;
    setVisible(m_section || m_draft);
    update();
}

void SectionBand::paintEvent(QPaintEvent*)
{
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    const auto line = [&](const glm::dvec3& a, const glm::dvec3& b, Qt::PenStyle style) {
        const QPolygonF ends = projected({a, b});
        if (ends.size() < 2) return;
        painter.setPen(QPen(kShadow, 4.0));
        painter.drawLine(ends[0], ends[1]);
        painter.setPen(QPen(kBand, 1.8, style));
        painter.drawLine(ends[0], ends[1]);
    };
    if (m_draft) {
        line(m_draft->first, m_draft->second, Qt::DashLine);
        return;
    }
    if (!m_section) return;
    const auto corners = m_section->corners();
    painter.setPen(QPen(kBand, 1.0));
    painter.setBrush(kBandFill);
    painter.drawPolygon(projected({{corners[0], m_fromHeight},
                                   {corners[1], m_toHeight},
                                   {corners[2], m_toHeight},
                                   {corners[3], m_fromHeight}}));
    const glm::dvec3 from(m_section->from, m_fromHeight), to(m_section->to, m_toHeight);
    line(from, to, Qt::SolidLine);
    // the arrow stands on the far edge
    const double px = camera().unitsPerPixel(std::max(1, height()));
    const glm::dvec3 unit = 1.0 / m_section->stretch;
    const glm::dvec3 along = glm::dvec3(m_section->along(), 0.0) * unit * (kArrow * px),
                     ahead = glm::dvec3(m_section->ahead(), 0.0) * unit;
    const glm::dvec3 foot = (from + to) * 0.5 + ahead * (m_section->width / 2);
    painter.setPen(QPen(kShadow, 1.0));
    painter.setBrush(kBand);
    painter.drawPolygon(projected({foot - along, foot + along, foot + ahead * (1.6 * kArrow * px)}));
    for (const glm::dvec3& end : {from, to})
        for (const QPointF& place : projected({end})) painter.drawEllipse(place, 3.5, 3.5);
}

// -- heights and distances

void SectionRuler::setSection(const std::optional<Section>& section, const QString& unit, const QString& heightUnit)
{
    m_marks.reset();
    if (section) m_marks = {*section, unit, heightUnit};
    setVisible(section.has_value());
    update();
}

void SectionRuler::paintEvent(QPaintEvent*)
{
    if (!m_marks) return;
    QPainter painter(this);
    paintRuler(painter, *m_marks, camera(), size());
}

void paintRuler(QPainter& painter, const RulerMarks& marks, const render::Camera& eye, QSizeF size)
{
    const int width = int(size.width()), height = int(size.height());
    const double unit = eye.unitsPerPixel(std::max(1, height));
    const glm::dvec2 middle = marks.section.placeOf(eye.eye);
    painter.save();
    const QFontMetrics metrics(painter.font());
    const auto label = [&](const QString& text, QPoint center, bool left) {
        QRect plate(0, 0, metrics.horizontalAdvance(text) + 10, metrics.height() + 2);
        plate.moveCenter(center);
        plate.moveLeft(left ? center.x() : std::clamp(plate.left(), 2, std::max(2, width - plate.width() - 2)));
        painter.setPen(Qt::NoPen);
        painter.setBrush(kAxisPlate);
        painter.drawRoundedRect(plate, 4, 4);
        painter.setPen(kText);
        painter.drawText(plate, Qt::AlignCenter, text);
    };
    // Z of a row, and distance of a column
    const double heightOfPx = unit / eye.stretch.z;
    const double top = eye.eye.z + height / 2.0 * heightOfPx, left = middle.x - width / 2.0 * unit;
    const double bottom = top - height * heightOfPx, right = left + width * unit;
    const double up = stepFrom(kHeightGap * heightOfPx), across = stepFrom(kDistanceGap * unit);
    if (!(up > 0.0) || !(across > 0.0) || (top - bottom) / up > kMostGridLines ||
        (right - left) / across > kMostGridLines)
        return painter.restore();
    const double firstHeight = std::ceil(bottom / up) * up, firstPlace = std::ceil(left / across) * across;
    painter.setPen(kGridColor);
    for (double z = firstHeight; z <= top; z += up)
        painter.drawLine(QPointF(0, (top - z) / heightOfPx), QPointF(width, (top - z) / heightOfPx));
    for (double s = firstPlace; s <= right; s += across)
        painter.drawLine(QPointF((s - left) / unit, 0), QPointF((s - left) / unit, height));
    painter.setRenderHint(QPainter::Antialiasing);
    const int below = metrics.height() + 6;
    for (double z = firstHeight; z <= top; z += up) {
        const int y = int((top - z) / heightOfPx);
        if (y > below / 2 && y < height - 2 * below) label(numberOf(z, up, marks.heightUnit), {4, y}, true);
    }
    for (double s = firstPlace; s <= right; s += across)
        label(numberOf(s, across, marks.unit), {int((s - left) / unit), height - below / 2 - 2}, false);
    painter.restore();
}

// -- the point in the other view

void PointMark::setPlace(const std::optional<glm::dvec3>& world)
{
    if (world == m_place) return;
    m_place = world;
    setVisible(world.has_value());
    update();
}

void PointMark::paintEvent(QPaintEvent*)
{
    if (!m_place) return;
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    painter.setBrush(Qt::NoBrush);
    for (const QPointF& at : projected({*m_place}))
        for (const QPen& pen : {QPen(kShadow, 4.0), QPen(Qt::white, 1.6)}) {
            painter.setPen(pen);
            painter.drawEllipse(at, kRing, kRing);
            for (const QPointF& way : {QPointF(1, 0), QPointF(0, 1), QPointF(-1, 0), QPointF(0, -1)})
                painter.drawLine(at + way * kRing, at + way * (kRing + 5));
        }
}

}  // namespace punctum::ui
