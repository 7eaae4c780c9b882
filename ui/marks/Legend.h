// SPDX-License-Identifier: MIT
#pragma once

#include "render/color/ColorMap.h"
#include "ui/marks/MarkStyle.h"

#include <QPointF>
#include <QSizeF>
#include <QString>
#include <QStringList>

#include <cstdint>
#include <vector>

namespace punctum::ui
{

/// What the colors of a picture mean: a bar of colors with its values, or a key of colors with their names, or one
/// line. Empty (without a title) where there is nothing to say.
struct Legend {
    QString title, unit;
    QString remark;  ///< a line instead of a bar, or below a key

    bool bar = false;
    render::ColorTable table{};  ///< of the bar, as it is drawn: with its steps
    /// Of the bar: values from its left to its right end, evenly spaced; of a stepped bar one for each edge of a
    /// step.
    QStringList values;

    struct Entry {
        QColor color;
        QString name;
        std::uint64_t points = 0;  ///< where not all fit, the most frequent are listed
        friend bool operator==(const Entry&, const Entry&) = default;
    };
    std::vector<Entry> entries;

    bool empty() const noexcept { return title.isEmpty(); }
    friend bool operator==(const Legend&, const Legend&) = default;
};

/// Width and height of a legend in px of the painter. `room`: what there is for it, in the same px; it becomes as
/// narrow as that, and a long key leaves entries out, but there is a least size below which nothing can be read.
QSizeF legendSize(const Legend& legend, const MarkStyle& style, QSizeF room);

/// Draws a legend of legendSize(legend, style, room) px with its top left corner at `corner`.
void paintLegend(QPainter& painter, QPointF corner, const Legend& legend, const MarkStyle& style, QSizeF room);

}  // namespace punctum::ui
