// SPDX-License-Identifier: MIT
#include "ui/basic/Text.h"

#include "core/cloud/ClassNames.h"
#include "core/cloud/ValueText.h"
#include "ui/basic/Numbers.h"

#include <QLocale>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace punctum::ui
{

namespace
{

/// Added to a byte that is no part of a character.
constexpr ushort kByte = 0xdc00;

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
    return localNumber(QString::number(count));
}

QString pointsText(std::uint64_t count)
{
    return count == 1 ? QStringLiteral("1 point") : countText(count) + QStringLiteral(" points");
}

QString plainNumber(double value, double width)
{
    if (!std::isfinite(value)) return std::isnan(value) ? QStringLiteral("none") : QString::number(value);
    if (value == 0.0) return QStringLiteral("0");
    constexpr int kMostDecimals = 12, kMostDigits = 15;
    const int whole = int(std::floor(std::log10(std::fabs(value))));  // digits before the point, less one
    const int apart = width > 0.0 ? 3 - int(std::floor(std::log10(width))) : 0;
    if (whole >= kMostDigits || (whole < -5 && apart < 6)) return QString::number(value, 'g', 6);
    const int decimals = std::clamp(std::max(std::min(6 - whole, 9), apart), 0,
                                    std::clamp(kMostDigits - 1 - whole, 0, kMostDecimals));
    return withoutTrailingZeros(QString::number(value, 'f', decimals));
}

QString numberText(double value, double width)
{
    return localNumber(plainNumber(value, width));
}

QString shownValue(const Attribute& attribute, const Value& value)
{
    return localNumber(toQString(punctum::valueText(attribute, value)));
}

QString shownValueOf(const Attribute& attribute, PointIndex point, std::uint32_t component)
{
    if (attribute.lacks(point, component)) return QStringLiteral("none");
    return shownValue(attribute, attribute.value(point, component));
}

QString valueText(const Value& value)
{
    return localNumber(toQString(toText(value)));
}

QString plainCoordinate(const CoordinateScale& coordinates, int axis, double value)
{
    const int decimals = decimalsOf(coordinates, axis);
    return toQString(decimals < 0 ? shortestText(value) : decimalText(value, decimals));
}

QString shownCoordinate(const CoordinateScale& coordinates, int axis, double value)
{
    return localNumber(plainCoordinate(coordinates, axis, value));
}

QString bytesText(std::uint64_t bytes)
{
    return windowLocale().formattedDataSize(qint64(bytes), bytes < 1'000'000 ? 0 : 1, QLocale::DataSizeSIFormat);
}

QString pathsText(const QString& paths)
{
    const QString first = paths.section(QLatin1Char('\n'), 0, 0).section(QLatin1Char('/'), -1);
    const auto more = paths.count(QLatin1Char('\n'));
    return more == 0 ? first : QStringLiteral("%1 and %2 more").arg(first, countText(std::uint64_t(more)));
}

QString folderOf(const QString& paths)
{
    return paths.section(QLatin1Char('\n'), 0, 0).section(QLatin1Char('/'), 0, -2);
}

QString menuText(QString name)
{
    return name.replace(QLatin1Char('&'), QStringLiteral("&&"));
}

QString titleText(QString name)
{
    return name.replace(QStringLiteral("[*]"), QStringLiteral("[*][*]"));
}

QString toQString(const std::filesystem::path& path)
{
    const QByteArray bytes = QByteArray::fromStdString(path.string());
    const auto whole = [](const QByteArray& part) {
        QString text = QString::fromUtf8(part);
        return text.toUtf8() == part ? text : QString();
    };
    if (QString text = whole(bytes); !text.isEmpty()) return text;
    QString text;
    for (qsizetype at = 0; at < bytes.size();) {
        constexpr qsizetype kLongest = 4;  // bytes of a character
        QString character;
        qsizetype length = 0;
        while (character.isEmpty() && length < std::min(kLongest, bytes.size() - at))
            character = whole(bytes.mid(at, ++length));
        if (character.isEmpty()) {
            character = QChar(ushort(kByte + uchar(bytes[at])));
            length = 1;
        }
        text += character;
        at += length;
    }
    return text;
}

std::filesystem::path toPath(const QString& path)
{
    QByteArray bytes;
    qsizetype from = 0;
    for (qsizetype at = 0; at <= path.size(); ++at) {
        const bool byte = at < path.size() && path[at].unicode() >= kByte + 0x80 &&
                          path[at].unicode() <= kByte + 0xff && (at == 0 || !path[at - 1].isHighSurrogate());
        if (at < path.size() && !byte) continue;
        bytes += QStringView(path).mid(from, at - from).toUtf8();
        if (byte) bytes += char(path[at].unicode() - kByte);
        from = at + 1;
    }
    return {bytes.toStdString()};
}

std::filesystem::path findPath(const QString& path)
{
    std::filesystem::path asked = toPath(path);
    std::error_code error;
    if (!path.contains(QChar::ReplacementCharacter) || std::filesystem::exists(asked, error)) return asked;
    const qsizetype slash = path.lastIndexOf(QLatin1Char('/'));
    if (slash < 0) return asked;
    const QString name = path.mid(slash + 1);
    std::vector<std::filesystem::path> alike;
    for (const auto& entry : std::filesystem::directory_iterator(
             slash == 0 ? std::filesystem::path("/") : findPath(path.left(slash)), error))
        if (QString::fromStdString(entry.path().filename().string()) == name) alike.push_back(entry.path());
    return alike.size() == 1 ? alike.front() : asked;
}

QString classText(unsigned code)
{
    constexpr unsigned kFirstOwn = 64;  // LAS 1.4 R15, table 17
    const std::string_view name = classNameOf(code);
    if (!name.empty()) return QStringLiteral("%1 %2").arg(code).arg(toQString(std::string(name)));
    return (code < kFirstOwn ? QStringLiteral("%1 Reserved") : QStringLiteral("%1 User defined")).arg(code);
}

}  // namespace punctum::ui
