// SPDX-License-Identifier: MIT
#pragma once

#include <QLocale>
#include <QString>

namespace punctum::ui
{

/// The one way in which the window reads and writes numbers: by the user's locale, so that what it shows can be
/// typed again, and nothing that is typed is taken for another number. Rules and conditions are a language of their
/// own and keep the point. Any thread.

/// The user's; English of the United States where the system names none.
QLocale windowLocale();

/// The program's text of a number ("-1234.5", "1e-05", digits of any length) as the user writes it, with digits in
/// groups of three: "-1.234,5". Any other text comes back as it is.
QString localNumber(const QString& plain, const QLocale& locale = windowLocale());

/// What was typed, understood or not.
struct NumberRead {
    QString plain;     ///< the number as the program writes it, digit by digit; empty: it is none
    double value = 0;  ///< of it
    QString problem;   ///< a sentence when it is none
    explicit operator bool() const noexcept { return problem.isEmpty(); }
};
/// Takes digits with or without separators, which must part groups of three; the locale's decimal sign; an
/// exponent. Blanks and apostrophes part groups in every locale, since they mean nothing else.
NumberRead readNumber(const QString& typed, const QLocale& locale = windowLocale());

}  // namespace punctum::ui
