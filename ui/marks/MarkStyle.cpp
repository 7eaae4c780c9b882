// SPDX-License-Identifier: MIT
#include "ui/marks/MarkStyle.h"

#include <QPainter>

namespace punctum::ui
{

void paintPlate(QPainter& painter, const QRectF& place, double scale)
{
    painter.setRenderHint(QPainter::Antialiasing);
    painter.setPen(Qt::NoPen);
    painter.setBrush(kMarkPlate);
    painter.drawRoundedRect(place, kMarkRadius * scale, kMarkRadius * scale);
}

}  // namespace punctum::ui
