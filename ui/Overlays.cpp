// SPDX-License-Identifier: MIT
#include "ui/Overlays.h"

#include "ui/Text.h"
#include "ui/style/Icons.h"
#include "ui/style/Theme.h"

#include <QLabel>
#include <QPainter>
#include <QPushButton>
#include <QVBoxLayout>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace punctum::ui
{

namespace
{

// The plates lie on pictures, not on the window: dark in every appearance.
const QColor kPlate(12, 14, 16, 200);
const QColor kPlateText(236, 238, 241);
const QColor kPlateDim(165, 172, 180);
const QColor kPlateAccent(0x58, 0xa6, 0xff);

constexpr int kMargin = 12;
constexpr int kRadius = 8;
constexpr int kLegendWidth = 232;
constexpr int kMaxBar = 150;

}  // namespace

OverlayPanel::OverlayPanel(QWidget* parent) : QWidget(parent)
{
    setAttribute(Qt::WA_TransparentForMouseEvents);
    hide();
}

void OverlayPanel::paintPlate(QPainter& painter) const
{
    painter.setRenderHint(QPainter::Antialiasing);
    painter.setPen(Qt::NoPen);
    painter.setBrush(kPlate);
    painter.drawRoundedRect(QRectF(rect()), kRadius, kRadius);
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
    const int width = std::max(bold.horizontalAdvance(m_title), plain.horizontalAdvance(m_detail)) + 2 * kMargin;
    return {std::max(width, 170), bold.height() + plain.height() + 4 + 2 * 9};
}

void TitleOverlay::paintEvent(QPaintEvent*)
{
    QPainter painter(this);
    paintPlate(painter);
    const QFont bold = scaledFont(font(), 1.05, true);
    const int titleHeight = QFontMetrics(bold).height();
    painter.setFont(bold);
    painter.setPen(kPlateText);
    painter.drawText(QRect(kMargin, 9, width() - 2 * kMargin, titleHeight), Qt::AlignLeft | Qt::AlignVCenter,
                     m_title);
    painter.setFont(font());
    painter.setPen(kPlateDim);
    painter.drawText(QRect(kMargin, 9 + titleHeight + 4, width() - 2 * kMargin, QFontMetrics(font()).height()),
                     Qt::AlignLeft | Qt::AlignVCenter, m_detail);
    if (m_progress < 0.0) return;
    const QRectF line(kRadius, height() - 3.0, width() - 2.0 * kRadius, 2.0);
    painter.setPen(Qt::NoPen);
    painter.setBrush(QColor(255, 255, 255, 36));
    painter.drawRect(line);
    painter.setBrush(kPlateAccent);
    painter.drawRect(
        QRectF(line.topLeft(), QSizeF(line.width() * std::clamp(m_progress, 0.0, 1.0), line.height())));
}

// -- legend

void LegendOverlay::setContent(const Content& content)
{
    if (content == m_content && isVisible() != content.title.isEmpty()) return;
    m_content = content;
    setVisible(!content.title.isEmpty());
    resize(sizeHint());
    update();
}

QSize LegendOverlay::sizeHint() const
{
    const int line = QFontMetrics(font()).height();
    return {kLegendWidth, m_content.bar ? 10 + line + 7 + 10 + 5 + line + 9 : 10 + line + 3 + line + 10};
}

void LegendOverlay::paintEvent(QPaintEvent*)
{
    QPainter painter(this);
    paintPlate(painter);
    const int line = QFontMetrics(font()).height();
    const QRect title(kMargin, 10, width() - 2 * kMargin, line);
    painter.setFont(scaledFont(font(), 1.0, true));
    painter.setPen(kPlateText);
    painter.drawText(title, Qt::AlignLeft | Qt::AlignVCenter,
                     QFontMetrics(painter.font()).elidedText(m_content.title, Qt::ElideRight, title.width() - 30));
    painter.setFont(font());
    painter.setPen(kPlateDim);
    painter.drawText(title, Qt::AlignRight | Qt::AlignVCenter, m_content.unit);
    if (!m_content.bar) {
        painter.drawText(QRect(kMargin, 10 + line + 3, title.width(), line), Qt::AlignLeft | Qt::AlignVCenter,
                         m_content.remark);
        return;
    }
    const QRect bar(kMargin, 10 + line + 7, width() - 2 * kMargin, 10);
    QImage colors(256, 1, QImage::Format_RGB32);
    for (int i = 0; i < 256; ++i) {
        const render::Rgba8 c = m_content.table[std::size_t(i)];
        colors.setPixel(i, 0, qRgb(c.r, c.g, c.b));
    }
    QPainterPath round;
    round.addRoundedRect(QRectF(bar), 3, 3);
    painter.save();
    painter.setClipPath(round);
    painter.setRenderHint(QPainter::SmoothPixmapTransform);
    painter.drawImage(bar, colors);
    painter.restore();
    const QRect numbers(kMargin, bar.bottom() + 6, bar.width(), line);
    painter.setPen(kPlateText);
    painter.drawText(numbers, Qt::AlignLeft | Qt::AlignVCenter, m_content.low);
    painter.drawText(numbers, Qt::AlignRight | Qt::AlignVCenter, m_content.high);
}

// -- compass and scale bar

double roundLength(double limit)
{
    if (!(limit > 0.0) || !std::isfinite(limit)) return 0.0;
    const double power = std::pow(10.0, std::floor(std::log10(limit)));
    for (const double step : {5.0, 2.0, 1.0})
        if (step * power <= limit * (1.0 + 1e-12)) return step * power;
    return power;
}

void CompassOverlay::setCamera(const render::Camera& camera, double pictureHeightPx, double pixelRatio,
                               const QString& unit)
{
    const double perPixel = camera.unitsPerPixel(pictureHeightPx) * pixelRatio;
    const double length = roundLength(perPixel * kMaxBar);
    const int barLength = perPixel > 0.0 ? int(std::lround(length / perPixel)) : 0;
    QString text = numberText(length);
    if (unit == QLatin1String("m") && length >= 1000.0)
        text = numberText(length / 1000.0) + QStringLiteral(" km");
    else if (unit == QLatin1String("m") && length < 0.995)
        text = length < 0.00995 ? numberText(length * 1000.0) + QStringLiteral(" mm")
                                : numberText(length * 100.0) + QStringLiteral(" cm");
    else if (!unit.isEmpty())
        text += QLatin1Char(' ') + unit;
    if (camera.yaw == m_yaw && barLength == m_barLength && text == m_barText) return;
    m_yaw = camera.yaw;
    m_barLength = barLength;
    m_barText = text;
    resize(sizeHint());
    update();
}

void CompassOverlay::paintEvent(QPaintEvent*)
{
    QPainter painter(this);
    paintPlate(painter);
    painter.save();
    painter.translate(24, height() / 2.0);
    painter.rotate(m_yaw * 180.0 / std::numbers::pi);  // the view turns left: north turns right on the screen
    QPainterPath north, south;
    north.addPolygon(QPolygonF{{QPointF(0, -15), QPointF(4.6, 0), QPointF(-4.6, 0)}});
    south.addPolygon(QPolygonF{{QPointF(0, 15), QPointF(4.6, 0), QPointF(-4.6, 0)}});
    painter.setPen(Qt::NoPen);
    painter.setBrush(QColor(0xf0, 0x6a, 0x5d));
    painter.drawPath(north);
    painter.setBrush(QColor(210, 214, 219));
    painter.drawPath(south);
    painter.restore();

    const int left = 54;
    const int base = height() - 13;
    painter.setRenderHint(QPainter::Antialiasing, false);
    painter.setPen(QPen(kPlateText, 1));
    painter.drawLine(left, base, left + m_barLength, base);
    painter.drawLine(left, base - 4, left, base);
    painter.drawLine(left + m_barLength, base - 4, left + m_barLength, base);
    painter.setPen(kPlateText);
    painter.drawText(QRect(left, 5, width() - left, base - 8), Qt::AlignLeft | Qt::AlignVCenter, m_barText);
}

// -- nothing open

EmptyPage::EmptyPage(QWidget* parent) : QWidget(parent)
{
    auto* icon = new QLabel;
    icon->setPixmap(lineIcon(QStringLiteral("cloud"), QColor(120, 128, 138)).pixmap(72, 72));
    icon->setAlignment(Qt::AlignCenter);
    auto* title = new QLabel(tr("Drop LAS or LAZ files here"));
    title->setFont(scaledFont(title->font(), 1.7, true));
    title->setAlignment(Qt::AlignCenter);
    title->setStyleSheet(QStringLiteral("color: #e3e5e8;"));
    auto* detail = new QLabel(tr("or press Ctrl+O to choose them. They open as they are: nothing is converted."));
    detail->setAlignment(Qt::AlignCenter);
    detail->setStyleSheet(QStringLiteral("color: #98a0a8;"));
    auto* button = new QPushButton(tr("Open..."));
    button->setProperty("primary", true);
    button->setCursor(Qt::PointingHandCursor);
    connect(button, &QPushButton::clicked, this, &EmptyPage::openRequested);

    auto* column = new QVBoxLayout(this);
    column->setSpacing(10);
    column->addStretch(4);
    column->addWidget(icon);
    column->addSpacing(6);
    column->addWidget(title);
    column->addWidget(detail);
    column->addSpacing(14);
    column->addWidget(button, 0, Qt::AlignHCenter);
    column->addStretch(5);
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
    painter.setPen(QPen(kPlateAccent, 2));
    painter.setBrush(Qt::NoBrush);
    painter.drawRoundedRect(QRectF(rect()).adjusted(6, 6, -6, -6), 10, 10);

    const QFont bold = scaledFont(font(), 1.25, true);
    const QSize size = QFontMetrics(bold).size(Qt::TextSingleLine, m_text) + QSize(76, 30);
    const QRect plate(QPoint((width() - size.width()) / 2, (height() - size.height()) / 2), size);
    painter.setPen(Qt::NoPen);
    painter.setBrush(QColor(16, 18, 21, 230));
    painter.drawRoundedRect(QRectF(plate), kRadius, kRadius);
    lineIcon(QStringLiteral("drop"), kPlateAccent)
        .paint(&painter, QRect(plate.left() + 18, plate.center().y() - 11, 22, 22));
    painter.setFont(bold);
    painter.setPen(kPlateText);
    painter.drawText(plate.adjusted(52, 0, -18, 0), Qt::AlignLeft | Qt::AlignVCenter, m_text);
}

}  // namespace punctum::ui
