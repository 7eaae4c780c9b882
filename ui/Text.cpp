// SPDX-License-Identifier: MIT
#include "ui/Text.h"

#include "render/color/ColorMap.h"
#include "ui/ViewRenderer.h"

#include <QFile>
#include <QLocale>

#include <algorithm>
#include <cmath>

namespace punctum::ui
{

namespace
{

/// One way of writing numbers everywhere, and the one that files and the command line use for the point.
const QLocale& locale()
{
    static const QLocale english(QLocale::English, QLocale::UnitedStates);
    return english;
}

QString withoutTrailingZeros(QString text)
{
    if (!text.contains(QLatin1Char('.')) || text.contains(QLatin1Char('e'))) return text;
    while (text.endsWith(QLatin1Char('0'))) text.chop(1);
    if (text.endsWith(QLatin1Char('.'))) text.chop(1);
    return text == QLatin1String("-0") ? QStringLiteral("0") : text;
}

}  // namespace

QString countText(std::uint64_t count)
{
    return locale().toString(qulonglong(count));
}

QString pointsText(std::uint64_t count)
{
    return count == 1 ? QStringLiteral("1 point") : countText(count) + QStringLiteral(" points");
}

QString numberText(double value)
{
    if (!std::isfinite(value)) return std::isnan(value) ? QStringLiteral("none") : QString::number(value);
    if (value == 0.0) return QStringLiteral("0");
    const double magnitude = std::log10(std::fabs(value));
    if (magnitude >= 15.0 || magnitude < -5.0) return QString::number(value, 'g', 6);
    const int decimals = std::clamp(6 - int(std::floor(magnitude)), 0, 9);
    return withoutTrailingZeros(locale().toString(value, 'f', decimals));
}

QString valueText(const Value& value)
{
    if (const auto* i = std::get_if<std::int64_t>(&value)) return locale().toString(qlonglong(*i));
    if (const auto* u = std::get_if<std::uint64_t>(&value)) return locale().toString(qulonglong(*u));
    return numberText(std::get<double>(value));
}

QString coordinateText(double value, double scale)
{
    const bool usable = std::isfinite(scale) && scale != 0.0;
    const int decimals = usable ? std::clamp(int(std::ceil(-std::log10(std::fabs(scale)) - 1e-9)), 0, 9) : 3;
    return locale().toString(value, 'f', decimals);
}

QString bytesText(std::uint64_t bytes)
{
    return locale().formattedDataSize(qint64(bytes), bytes < 1'000'000 ? 0 : 1, QLocale::DataSizeSIFormat);
}

QString toQString(const std::filesystem::path& path)
{
    return QFile::decodeName(QByteArray::fromStdString(path.string()));
}

std::filesystem::path toPath(const QString& path)
{
    return std::filesystem::path(QFile::encodeName(path).toStdString());
}

QString classText(unsigned code)
{
    const QString name = code < 256 ? toQString(render::asprsClasses()[code].name) : QString();
    return name.isEmpty() || name.startsWith(QLatin1String("Class ")) ? QStringLiteral("%1 User defined").arg(code)
                                                                      : QStringLiteral("%1 %2").arg(code).arg(name);
}

QString readOutText(const PickedPoint& point)
{
    const glm::dvec3 scale = point.cloud->coordinates().scale;
    QString text = QStringLiteral("x %1   y %2   z %3")
                       .arg(coordinateText(point.world.x, scale.x), coordinateText(point.world.y, scale.y),
                            coordinateText(point.world.z, scale.z));
    if (point.classCode) text += QStringLiteral("   ·   ") + classText(*point.classCode);
    static const QStringList told{QStringLiteral("X"), QStringLiteral("Y"), QStringLiteral("Z"),
                                  QStringLiteral("Classification")};
    if (!point.value.isEmpty() && !told.contains(point.attribute))
        text += QStringLiteral("   ·   %1 %2").arg(point.attribute, point.value);
    return text;
}

}  // namespace punctum::ui
