// SPDX-License-Identifier: MIT
#include "ui/style/Swatch.h"

#include <QPainter>
#include <QPixmap>

namespace punctum::ui
{

QIcon swatchIcon(render::Rgba8 color)
{
    QPixmap pixmap(14, 14);
    pixmap.fill(Qt::transparent);
    QPainter painter(&pixmap);
    painter.setRenderHint(QPainter::Antialiasing);
    painter.setPen(Qt::NoPen);
    painter.setBrush(QColor(color.r, color.g, color.b));
    painter.drawRoundedRect(QRectF(1, 1, 12, 12), 3, 3);
    return QIcon(pixmap);
}

}  // namespace punctum::ui
