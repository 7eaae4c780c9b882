// SPDX-License-Identifier: MIT
#include "ui/basic/Numbers.h"

#include <QCoreApplication>

#include <cmath>
#include <optional>

namespace punctum::ui
{

namespace
{

constexpr qsizetype kGroupDigits = 3;  // digits

bool isDigit(QChar c)
{
    return c >= QLatin1Char('0') && c <= QLatin1Char('9');
}

/// The parts of "-1234.5e-7", all but the whole digits possibly empty.
struct Parts {
    bool negative = false;
    QString whole, fraction;
    QString exponent;  ///< with its sign
};

/// Reads digits from `at` on, and moves it behind them.
QString digitsAt(const QString& text, qsizetype& at)
{
    const qsizetype from = at;
    while (at < text.size() && isDigit(text[at])) ++at;
    return text.mid(from, at - from);
}

/// "e-05" at `at`, to the end of the text: "-05". Empty: there is none. Nothing: something else is there.
std::optional<QString> exponentAt(const QString& text, qsizetype at)
{
    if (at == text.size()) return QString();
    if (text[at] != QLatin1Char('e') && text[at] != QLatin1Char('E')) return std::nullopt;
    QString sign;
    if (++at < text.size() && (text[at] == QLatin1Char('-') || text[at] == QLatin1Char('+'))) sign = text[at++];
    const QString digits = digitsAt(text, at);
    if (digits.isEmpty() || at != text.size()) return std::nullopt;
    return sign + digits;
}

/// Signs that part groups and look alike, or are typed one for another, become one.
QChar alike(QChar c)
{
    switch (c.unicode()) {
        case 0x00a0:  // no-break space
        case 0x2009:  // thin space
        case 0x202f:  // narrow no-break space
            return QLatin1Char(' ');
        case 0x2019:  // right single quotation mark
            return QLatin1Char('\'');
        case 0x2212:  // minus sign
            return QLatin1Char('-');
        default:
            return c;
    }
}

/// Digits of any script as those of ASCII, without marks of writing direction.
QString simplified(const QString& typed)
{
    QString text;
    for (const QChar c : typed.trimmed()) {
        if (c.unicode() == 0x200e || c.unicode() == 0x200f || c.unicode() == 0x061c) continue;
        const int digit = c.digitValue();
        text += digit >= 0 && c.isNumber() && c.category() == QChar::Number_DecimalDigit ? QChar(u'0' + digit)
                                                                                         : alike(c);
    }
    return text;
}

/// The locale's sign, as simplified() leaves it.
QChar signOf(const QString& sign, QChar otherwise)
{
    const QString text = simplified(QLatin1Char('x') + sign);
    return text.size() == 2 ? text[1] : text.isEmpty() || sign.isEmpty() ? otherwise : alike(sign[0]);
}

std::optional<Parts> partsOf(const QString& text, QChar decimal, const QString& separators)
{
    Parts parts;
    qsizetype at = 0;
    if (at < text.size() && (text[at] == QLatin1Char('-') || text[at] == QLatin1Char('+')))
        parts.negative = text[at++] == QLatin1Char('-');
    parts.whole = digitsAt(text, at);
    if (at < text.size() && separators.contains(text[at]) && text[at] != decimal) {
        const QChar separator = text[at];
        if (parts.whole.isEmpty() || parts.whole.size() > kGroupDigits) return std::nullopt;
        while (at < text.size() && text[at] == separator) {
            const QString group = digitsAt(text, ++at);
            if (group.size() != kGroupDigits) return std::nullopt;
            parts.whole += group;
        }
    }
    if (at < text.size() && text[at] == decimal) parts.fraction = digitsAt(text, ++at);
    if (parts.whole.isEmpty() && parts.fraction.isEmpty()) return std::nullopt;
    const auto exponent = exponentAt(text, at);
    if (!exponent) return std::nullopt;
    parts.exponent = *exponent;
    return parts;
}

}  // namespace

QLocale windowLocale()
{
    const QLocale locale;
    return locale.language() == QLocale::C ? QLocale(QLocale::English, QLocale::UnitedStates) : locale;
}

QString localNumber(const QString& plain, const QLocale& locale)
{
    const auto parts = partsOf(plain, QLatin1Char('.'), {});
    if (!parts || parts->whole.isEmpty() || plain.startsWith(QLatin1Char('+'))) return plain;
    const QString separator = locale.groupSeparator();
    QString text = parts->negative ? QStringLiteral("-") : QString();
    for (qsizetype k = 0; k < parts->whole.size(); ++k) {
        if (k != 0 && (parts->whole.size() - k) % kGroupDigits == 0) text += separator;
        text += parts->whole[k];
    }
    if (!parts->fraction.isEmpty()) text += locale.decimalPoint() + parts->fraction;
    if (!parts->exponent.isEmpty()) text += QLatin1Char('e') + parts->exponent;
    return text;
}

NumberRead readNumber(const QString& typed, const QLocale& locale)
{
    const auto tr = [](const char* text) { return QCoreApplication::translate("Numbers", text); };
    NumberRead read;
    const QString text = simplified(typed);
    if (text.isEmpty()) {
        read.problem = tr("A number is missing here.");
        return read;
    }
    const QChar decimal = signOf(locale.decimalPoint(), QLatin1Char('.'));
    const QString separators = QStringLiteral(" '") + signOf(locale.groupSeparator(), QLatin1Char(' '));
    const auto parts = partsOf(text, decimal, separators);
    if (!parts) {
        read.problem = tr("\"%1\" is no number here; numbers are written as in %2.")
                           .arg(typed.trimmed(), localNumber(QStringLiteral("1234.5"), locale));
        return read;
    }
    QString plain = parts->negative ? QStringLiteral("-") : QString();
    plain += parts->whole.isEmpty() ? QStringLiteral("0") : parts->whole;
    if (!parts->fraction.isEmpty()) plain += QLatin1Char('.') + parts->fraction;
    if (!parts->exponent.isEmpty()) plain += QLatin1Char('e') + parts->exponent;
    bool fine = false;
    read.value = plain.toDouble(&fine);
    if (!fine || !std::isfinite(read.value))
        read.problem = tr("%1 is beyond all numbers that can be used here.").arg(typed.trimmed());
    else
        read.plain = plain;
    return read;
}

}  // namespace punctum::ui
