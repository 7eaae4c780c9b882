// SPDX-License-Identifier: MIT
#include "ui/marks/Legend.h"

#include "ui/style/Theme.h"

#include <QFontMetricsF>
#include <QImage>
#include <QObject>
#include <QPainter>
#include <QPainterPath>

#include <algorithm>

namespace punctum::ui
{

namespace
{

// All in px of the mark, before scaling.
constexpr double kWidth = 232, kLeastWidth = 120;
constexpr double kEdge = 10;   // above the title and below the last line
constexpr double kBarGap = 7;  // between title and bar
constexpr double kBarHeight = 10;
constexpr double kValueGap = 5;  // between bar and values
constexpr double kBetweenValues = 10;
constexpr double kSwatch = 12;    // a color of the key
constexpr double kSwatchGap = 9;  // between a color and its name
constexpr double kRowGap = 4;     // between lines of the key
constexpr std::size_t kMostRows = 32;

/// How a legend is laid out in the room there is.
struct Layout {
    double width = 0, height = 0, line = 0;
    std::vector<std::size_t> shown;  ///< entries, in their order
    std::size_t left = 0;            ///< entries that have no line
    bool remark = false;
    bool stacked = false;  ///< the bar's last value stands below its first: beside it there is no room
};

Layout layoutOf(const Legend& legend, const MarkStyle& style, QSizeF room)
{
    const QFontMetricsF metrics(style.font);
    const QFontMetricsF bold(scaledFont(style.font, 1.0, true));
    Layout layout;
    layout.line = metrics.height();
    const double most = std::max(kLeastWidth, std::min(kWidth, room.width() / style.scale));
    layout.width = most;
    layout.height = kEdge + layout.line;
    if (legend.bar) {
        const double widest = std::max(most, room.width() / style.scale);
        const double values = legend.values.size() < 2 ? 0.0
                                                       : metrics.horizontalAdvance(legend.values.front()) +
                                                             metrics.horizontalAdvance(legend.values.back()) +
                                                             kBetweenValues + 2 * kMarkMargin;
        layout.width = std::clamp(values, most, widest);
        layout.stacked = values > layout.width;
        layout.height += kBarGap + kBarHeight + kValueGap + (layout.stacked ? 2 : 1) * layout.line + kEdge - 1;
        return layout;
    }
    layout.remark = !legend.remark.isEmpty();
    if (legend.entries.empty()) {
        layout.height += (layout.remark ? 3 + layout.line : 0) + kEdge;
        return layout;
    }
    const double row = std::max(layout.line, kSwatch) + kRowGap;
    const double free = room.height() / style.scale - layout.height - kEdge - kRowGap - (layout.remark ? row : 0);
    const auto rows = std::min(kMostRows, std::size_t(std::max(2.0, free / row)));
    const std::size_t all = legend.entries.size();
    layout.shown.resize(all);
    for (std::size_t k = 0; k < all; ++k) layout.shown[k] = k;
    if (all > rows) {
        const auto last =
            layout.shown.begin() + std::ptrdiff_t(rows - 1);  // the last row says how many are missing
        std::stable_sort(layout.shown.begin(), layout.shown.end(), [&](std::size_t a, std::size_t b) {
            return legend.entries[a].points > legend.entries[b].points;
        });
        layout.shown.erase(last, layout.shown.end());
        std::sort(layout.shown.begin(), layout.shown.end());
        layout.left = all - layout.shown.size();
    }
    // A key is as wide as its names.
    double widest = bold.horizontalAdvance(legend.title) +
                    (legend.unit.isEmpty() ? 0 : 16 + metrics.horizontalAdvance(legend.unit));
    for (const std::size_t k : layout.shown)
        widest = std::max(widest, kSwatch + kSwatchGap + metrics.horizontalAdvance(legend.entries[k].name));
    if (layout.remark) widest = std::max(widest, metrics.horizontalAdvance(legend.remark));
    layout.width = std::clamp(widest + 2 * kMarkMargin, kLeastWidth, most);
    const std::size_t lines = layout.shown.size() + (layout.left > 0 ? 1 : 0) + (layout.remark ? 1 : 0);
    layout.height += kRowGap + double(lines) * row + kEdge - kRowGap / 2;
    return layout;
}

void paintBar(QPainter& painter, const QRectF& bar, const render::ColorTable& table)
{
    QImage colors(int(table.size()), 1, QImage::Format_RGB32);
    for (int i = 0; i < colors.width(); ++i) {
        const render::Rgba8 c = table[std::size_t(i)];
        colors.setPixel(i, 0, qRgb(c.r, c.g, c.b));
    }
    QPainterPath round;
    round.addRoundedRect(bar, 3, 3);
    painter.save();
    painter.setClipPath(round);
    // Steps stay sharp.
    painter.setRenderHint(QPainter::SmoothPixmapTransform, false);
    painter.drawImage(bar, colors);
    painter.restore();
}

/// Writes as many of the values as there is room for: all, or each second, third, ..., always with both ends where
/// their number allows it.
void paintValues(QPainter& painter, const QRectF& line, const QStringList& values)
{
    const int count = int(values.size());
    if (count < 2) return;
    const QFontMetricsF metrics(painter.font());
    double widest = 0;
    for (const QString& value : values) widest = std::max(widest, metrics.horizontalAdvance(value));
    int stride = count - 1;
    for (int wish = 1; wish < count - 1; ++wish)
        if ((count - 1) % wish == 0 && line.width() * wish / (count - 1) >= widest + kBetweenValues) {
            stride = wish;
            break;
        }
    for (int k = 0; k < count; k += stride) {
        const double at = line.left() + line.width() * k / (count - 1);
        const double width = metrics.horizontalAdvance(values[k]) + 1;
        const double left = std::clamp(at - width / 2, line.left(), line.right() - width);
        painter.drawText(QRectF(left, line.top(), width, line.height()), Qt::AlignLeft | Qt::AlignVCenter,
                         values[k]);
    }
}

}  // namespace

QSizeF legendSize(const Legend& legend, const MarkStyle& style, QSizeF room)
{
    const Layout layout = layoutOf(legend, style, room);
    return QSizeF(layout.width, layout.height) * style.scale;
}

void paintLegend(QPainter& painter, QPointF corner, const Legend& legend, const MarkStyle& style, QSizeF room)
{
    if (legend.empty()) return;
    const Layout layout = layoutOf(legend, style, room);
    painter.save();
    painter.translate(corner);
    painter.scale(style.scale, style.scale);
    painter.setRenderHint(QPainter::Antialiasing);
    if (style.plate) paintPlate(painter, QRectF(0, 0, layout.width, layout.height));

    const QFontMetricsF metrics(style.font);
    const double inner = layout.width - 2 * kMarkMargin;
    const QRectF title(kMarkMargin, kEdge, inner, layout.line);
    const double unit = legend.unit.isEmpty() ? 0 : metrics.horizontalAdvance(legend.unit) + 12;
    const QFont bold = scaledFont(style.font, 1.0, true);
    painter.setFont(bold);
    painter.setPen(kMarkText);
    painter.drawText(title, Qt::AlignLeft | Qt::AlignVCenter,
                     QFontMetricsF(bold).elidedText(legend.title, Qt::ElideRight, inner - unit));
    painter.setFont(style.font);
    painter.setPen(kMarkDim);
    painter.drawText(title, Qt::AlignRight | Qt::AlignVCenter, legend.unit);

    const auto text = [&](double left, double top, double height, const QString& words) {
        painter.drawText(QRectF(left, top, kMarkMargin + inner - left, height), Qt::AlignLeft | Qt::AlignVCenter,
                         metrics.elidedText(words, Qt::ElideRight, kMarkMargin + inner - left));
    };
    if (legend.bar) {
        const QRectF bar(kMarkMargin, title.bottom() + kBarGap, inner, kBarHeight);
        paintBar(painter, bar, legend.table);
        painter.setPen(kMarkText);
        const QRectF line(kMarkMargin, bar.bottom() + kValueGap, inner, layout.line);
        if (layout.stacked) {
            text(kMarkMargin, line.top(), layout.line, legend.values.front());
            painter.drawText(line.translated(0, layout.line), Qt::AlignRight | Qt::AlignVCenter,
                             metrics.elidedText(legend.values.back(), Qt::ElideRight, inner));
        } else {
            paintValues(painter, line, legend.values);
        }
    } else if (legend.entries.empty()) {
        text(kMarkMargin, title.bottom() + 3, layout.line, legend.remark);
    } else {
        const double height = std::max(layout.line, kSwatch);
        double top = title.bottom() + kRowGap + kRowGap / 2;
        for (const std::size_t k : layout.shown) {
            painter.setPen(Qt::NoPen);
            painter.setBrush(legend.entries[k].color);
            painter.drawRoundedRect(QRectF(kMarkMargin, top + (height - kSwatch) / 2, kSwatch, kSwatch), 3, 3);
            painter.setPen(kMarkText);
            text(kMarkMargin + kSwatch + kSwatchGap, top, height, legend.entries[k].name);
            top += height + kRowGap;
        }
        painter.setPen(kMarkDim);
        if (layout.left > 0) {
            text(kMarkMargin, top, height, QObject::tr("and %1 more").arg(layout.left));
            top += height + kRowGap;
        }
        if (layout.remark) text(kMarkMargin, top, height, legend.remark);
    }
    painter.restore();
}

}  // namespace punctum::ui
