// SPDX-License-Identifier: MIT
#pragma once

#include <QColor>
#include <QFont>
#include <QRectF>

class QPainter;

namespace punctum::ui
{

/// How legend, scale bar and north arrow are drawn on a picture: in the view, and in pictures that are saved. All
/// are values and functions that know no widget, so that both look the same. Any thread, as long as the painter is
/// not another thread's.
struct MarkStyle {
    QFont font;
    double scale = 1.0;  ///< px of the painter for each px that the lengths of marks are given in
    bool plate = true;   ///< on a dark plate; else the mark lies on the picture itself
};

// Marks lie on pictures, not on the window: light on dark in every appearance.
inline const QColor kMarkPlate(12, 14, 16, 200);
inline const QColor kMarkText(236, 238, 241);
inline const QColor kMarkDim(165, 172, 180);
inline const QColor kMarkAccent(0x58, 0xa6, 0xff);

inline constexpr int kMarkMargin = 12;  ///< between the edge of a plate and what is on it
inline constexpr int kMarkRadius = 8;   ///< of its corners

/// A rounded, translucent, dark plate, readable on any picture.
void paintPlate(QPainter& painter, const QRectF& place, double scale = 1.0);

}  // namespace punctum::ui
