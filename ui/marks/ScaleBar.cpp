// SPDX-License-Identifier: MIT
#include "ui/marks/ScaleBar.h"

#include "ui/basic/Text.h"
#include "ui/style/Theme.h"

#include <QFontMetricsF>
#include <QObject>
#include <QPainter>
#include <QPainterPath>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace punctum::ui
{

namespace
{

// All in px of the mark, before scaling.
constexpr double kHeight = 48;
constexpr double kArrowAt = 26;  // middle of the arrow, from the left
constexpr double kBarLeft = 54;
constexpr double kMostBar = 150;
constexpr double kLeastBarWidth = 96;

void paintArrow(QPainter& painter, double yaw, double height, const MarkStyle& style)
{
    painter.save();
    painter.translate(kArrowAt, height / 2);
    painter.rotate(yaw * 180.0 / std::numbers::pi);  // the view turns left: north turns right on the screen
    const QColor northColor(0xf0, 0x6a, 0x5d);
    QPainterPath north, south;
    north.addPolygon(QPolygonF{{QPointF(0, -11), QPointF(4.4, 3), QPointF(-4.4, 3)}});
    south.addPolygon(QPolygonF{{QPointF(0, 17), QPointF(4.4, 3), QPointF(-4.4, 3)}});
    painter.setPen(Qt::NoPen);
    painter.setBrush(northColor);
    painter.drawPath(north);
    painter.setBrush(QColor(210, 214, 219));
    painter.drawPath(south);
    // The letter goes round with the arrow and stays upright.
    painter.translate(0, -17);
    painter.rotate(-yaw * 180.0 / std::numbers::pi);
    painter.setFont(scaledFont(style.font, 0.78, true));
    painter.setPen(northColor);
    painter.drawText(QRectF(-8, -7, 16, 14), Qt::AlignCenter, QObject::tr("N", "north"));
    painter.restore();
}

void paintBar(QPainter& painter, const ScaleBar& bar, QSizeF size, const MarkStyle& style)
{
    const double left = bar.arrow ? kBarLeft : kMarkMargin;
    const double base = size.height() - 14;
    painter.setRenderHint(QPainter::Antialiasing, false);
    painter.setPen(QPen(kMarkText, 1));
    const double right = left + bar.length;
    painter.drawLine(QPointF(left, base), QPointF(right, base));
    painter.drawLine(QPointF(left, base - 4), QPointF(left, base));
    painter.drawLine(QPointF(right, base - 4), QPointF(right, base));
    painter.setFont(style.font);
    painter.drawText(QRectF(left, 6, size.width() - left, base - 10), Qt::AlignLeft | Qt::AlignVCenter, bar.text);
}

}  // namespace

double roundLengthUpTo(double limit)
{
    if (!(limit > 0.0) || !std::isfinite(limit)) return 0.0;
    const double power = std::pow(10.0, std::floor(std::log10(limit)));
    for (const double step : {5.0, 2.0, 1.0})
        if (step * power <= limit * (1.0 + 1e-12)) return step * power;
    return power;
}

QString roundLengthText(double length, const QString& unit)
{
    if (unit.isEmpty())
        return length == 1.0 ? QObject::tr("1 unit") : QObject::tr("%1 units").arg(numberText(length));
    if (unit == QLatin1String("m")) {
        if (length >= 1000.0) return numberText(length / 1000.0) + QStringLiteral(" km");
        if (length < 0.00995) return numberText(length * 1000.0) + QStringLiteral(" mm");
        if (length < 0.995) return numberText(length * 100.0) + QStringLiteral(" cm");
    }
    return numberText(length) + QLatin1Char(' ') + unit;
}

ScaleBar scaleBarOf(const render::Camera& camera, double pictureHeightPx, double scale, const QString& unit)
{
    const double perPixel = camera.unitsPerPixel(pictureHeightPx) * scale;
    const double length = roundLengthUpTo(perPixel * kMostBar);
    ScaleBar bar;
    bar.yaw = camera.yaw;
    bar.bar = camera.eye != camera.pivot;
    if (!bar.bar) return bar;
    bar.length = perPixel > 0.0 ? std::round(length / perPixel) : 0.0;
    bar.text = roundLengthText(length, unit);
    return bar;
}

QSizeF scaleBarSize(const ScaleBar& bar, const MarkStyle& style)
{
    if (!bar.bar) return QSizeF(bar.arrow ? 2 * kArrowAt : 0.0, kHeight) * style.scale;
    const double left = bar.arrow ? kBarLeft : kMarkMargin;
    const double text = QFontMetricsF(style.font).horizontalAdvance(bar.text);
    return QSizeF(std::max(kLeastBarWidth, left + std::max(bar.length, text) + 16), kHeight) * style.scale;
}

void paintScaleBar(QPainter& painter, QPointF corner, const ScaleBar& bar, const MarkStyle& style)
{
    painter.save();
    painter.translate(corner);
    painter.scale(style.scale, style.scale);
    painter.setRenderHint(QPainter::Antialiasing);
    const QSizeF size = scaleBarSize(bar, style) / style.scale;
    if (style.plate) paintPlate(painter, QRectF(QPointF(), size));

    if (bar.arrow) paintArrow(painter, bar.yaw, size.height(), style);
    if (bar.bar) paintBar(painter, bar, size, style);
    painter.restore();
}

}  // namespace punctum::ui
