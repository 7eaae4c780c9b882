// SPDX-License-Identifier: MIT
#include "ui/view/PickedPoint.h"

#include "ui/basic/Text.h"

#include <QStringList>

namespace punctum::ui
{

QString readOutText(const PickedPoint& point)
{
    const CoordinateScale& coordinates = point.cloud->coordinates();
    QString text =
        QStringLiteral("x %1   y %2   z %3")
            .arg(shownCoordinate(coordinates, 0, point.world.x), shownCoordinate(coordinates, 1, point.world.y),
                 shownCoordinate(coordinates, 2, point.world.z));
    if (point.classCode) text += QStringLiteral("   ·   ") + classText(*point.classCode);
    static const QStringList told{QStringLiteral("X"), QStringLiteral("Y"), QStringLiteral("Z"),
                                  QStringLiteral("Classification")};
    if (!point.value.isEmpty() && !told.contains(point.attribute))
        text += QStringLiteral("   ·   %1 %2").arg(point.attribute, point.value);
    return text;
}

}  // namespace punctum::ui
