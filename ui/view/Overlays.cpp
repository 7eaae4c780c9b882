// SPDX-License-Identifier: MIT
#include "ui/view/Overlays.h"

#include "ui/style/Icons.h"
#include "ui/style/Theme.h"

#include <QPainter>

#include <algorithm>
#include <cmath>

namespace punctum::ui
{

OverlayPanel::OverlayPanel(QWidget* parent) : QWidget(parent)
{
    setAttribute(Qt::WA_TransparentForMouseEvents);
    hide();
}

// -- title

void TitleOverlay::setContent(const QString& title, const QString& detail)
{
    if (title == m_title && detail == m_detail) return;
    m_title = title;
    m_detail = detail;
    setVisible(!title.isEmpty());
    resize(sizeHint());
    update();
}

void TitleOverlay::setProgress(double share)
{
    if (share == m_progress) return;
    m_progress = share;
    update();
}

QSize TitleOverlay::sizeHint() const
{
    const QFontMetrics bold(scaledFont(font(), 1.05, true));
    const QFontMetrics plain(font());
    const int width =
        std::max(bold.horizontalAdvance(m_title), plain.horizontalAdvance(m_detail)) + 2 * kMarkMargin;
    return {std::max(width, 170), bold.height() + plain.height() + 4 + 2 * 9};
}

void TitleOverlay::paintEvent(QPaintEvent*)
{
    QPainter painter(this);
    paintPlate(painter, rect());
    const QFont bold = scaledFont(font(), 1.05, true);
    const int titleHeight = QFontMetrics(bold).height();
    painter.setFont(bold);
    painter.setPen(kMarkText);
    painter.drawText(QRect(kMarkMargin, 9, width() - 2 * kMarkMargin, titleHeight),
                     Qt::AlignLeft | Qt::AlignVCenter, m_title);
    painter.setFont(font());
    painter.setPen(kMarkDim);
    painter.drawText(
        QRect(kMarkMargin, 9 + titleHeight + 4, width() - 2 * kMarkMargin, QFontMetrics(font()).height()),
        Qt::AlignLeft | Qt::AlignVCenter, m_detail);
    if (m_progress < 0.0) return;
    const QRectF line(kMarkRadius, height() - 3.0, width() - 2.0 * kMarkRadius, 2.0);
    painter.setPen(Qt::NoPen);
    painter.setBrush(QColor(255, 255, 255, 36));
    painter.drawRect(line);
    painter.setBrush(kMarkAccent);
    painter.drawRect(
        QRectF(line.topLeft(), QSizeF(line.width() * std::clamp(m_progress, 0.0, 1.0), line.height())));
}

// -- legend

void LegendOverlay::setContent(const Legend& content)
{
    if (content == m_content && isVisible() != content.empty()) return;
    m_content = content;
    setVisible(!content.empty());
    resize(sizeHint());
    update();
}

void LegendOverlay::setRoom(QSize room)
{
    m_room = room;
    resize(sizeHint());
}

QSize LegendOverlay::sizeHint() const
{
    const QSizeF size = legendSize(m_content, markStyle(), m_room);
    return {int(std::ceil(size.width())), int(std::ceil(size.height()))};
}

void LegendOverlay::paintEvent(QPaintEvent*)
{
    QPainter painter(this);
    paintLegend(painter, {}, m_content, markStyle(), m_room);
}

// -- compass and scale bar

void CompassOverlay::setCamera(const render::Camera& camera, double pictureHeightPx, double pixelRatio,
                               const QString& unit)
{
    const ScaleBar bar = scaleBarOf(camera, pictureHeightPx, pixelRatio, unit);
    if (bar == m_bar) return;
    m_bar = bar;
    resize(sizeHint());
    update();
}

QSize CompassOverlay::sizeHint() const
{
    const QSizeF size = scaleBarSize(m_bar, markStyle());
    return {int(std::ceil(size.width())), int(std::ceil(size.height()))};
}

void CompassOverlay::paintEvent(QPaintEvent*)
{
    QPainter painter(this);
    paintScaleBar(painter, {}, m_bar, markStyle());
}

// -- dropping

DropHint::DropHint(QWidget* parent) : QWidget(parent)
{
    setAttribute(Qt::WA_TransparentForMouseEvents);
    hide();
}

void DropHint::setText(const QString& text)
{
    m_text = text;
    update();
}

void DropHint::paintEvent(QPaintEvent*)
{
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    painter.fillRect(rect(), QColor(20, 60, 110, 70));
    painter.setPen(QPen(kMarkAccent, 2));
    painter.setBrush(Qt::NoBrush);
    painter.drawRoundedRect(QRectF(rect()).adjusted(6, 6, -6, -6), 10, 10);

    const QFont bold = scaledFont(font(), 1.25, true);
    const QSize size = QFontMetrics(bold).size(Qt::TextSingleLine, m_text) + QSize(76, 30);
    const QRect plate(QPoint((width() - size.width()) / 2, (height() - size.height()) / 2), size);
    painter.setPen(Qt::NoPen);
    painter.setBrush(QColor(16, 18, 21, 230));
    painter.drawRoundedRect(QRectF(plate), kMarkRadius, kMarkRadius);
    lineIcon(QStringLiteral("drop"), kMarkAccent)
        .paint(&painter, QRect(plate.left() + 18, plate.center().y() - 11, 22, 22));
    painter.setFont(bold);
    painter.setPen(kMarkText);
    painter.drawText(plate.adjusted(52, 0, -18, 0), Qt::AlignLeft | Qt::AlignVCenter, m_text);
}

}  // namespace punctum::ui
