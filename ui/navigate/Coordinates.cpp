// SPDX-License-Identifier: MIT
#include "ui/navigate/Coordinates.h"

#include <QRegularExpression>
#include <QStringList>

#include <algorithm>
#include <array>

namespace punctum::ui
{

std::vector<NumberRead> readCoordinates(const QString& text, const QLocale& locale)
{
    constexpr qsizetype kMostText = 200;  // characters; longer texts are something else
    if (text.size() > kMostText || readNumber(text, locale)) return {};
    static const QRegularExpression brackets(QStringLiteral("[()\\[\\]{}]"));
    const QString bare = QString(text).remove(brackets).trimmed();
    // What parts numbers for certain comes first: blanks and commas may also stand inside of one.
    static const std::array separators{
        QRegularExpression(QStringLiteral(";")), QRegularExpression(QStringLiteral("[\\t\\r\\n]+")),
        QRegularExpression(QStringLiteral(",\\s+")), QRegularExpression(QStringLiteral("\\s+")),
        QRegularExpression(QStringLiteral(","))};
    for (const QLocale& way : {locale, QLocale::c()})
        for (const QRegularExpression& separator : separators) {
            const QStringList parts = bare.split(separator, Qt::SkipEmptyParts);
            if (parts.size() < 2 || parts.size() > 3) continue;
            std::vector<NumberRead> numbers;
            for (const QString& part : parts) numbers.push_back(readNumber(part, way));
            if (std::all_of(numbers.begin(), numbers.end(), [](const NumberRead& n) { return bool(n); }))
                return numbers;
        }
    return {};
}

}  // namespace punctum::ui
