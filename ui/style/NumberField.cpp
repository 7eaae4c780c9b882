// SPDX-License-Identifier: MIT
#include "ui/style/NumberField.h"

#include "ui/style/Widgets.h"

#include <QSignalBlocker>

#include <algorithm>
#include <cmath>

namespace punctum::ui
{

NumberField::NumberField(QWidget* parent) : QLineEdit(parent)
{
    connect(this, &QLineEdit::textChanged, this, [this] {
        if (!problem().isEmpty()) check();  // a mark goes as soon as the reason for it does
    });
}

void NumberField::put(double value, const QString& plain)
{
    const QString shown = localNumber(plain);
    if (isModified() && window()->focusWidget() == this)
        return;  // somebody types, or has gone to look something up
    m_value = value;
    m_plain = plain;
    m_put = shown;
    refuse({});  // before the text changes: what was wrong with the old one is no matter
    if (text() != shown) setText(shown);
}

void NumberField::put(const QString& plain)
{
    m_value.reset();
    m_plain.clear();
    m_put = localNumber(plain);
    refuse({});
    setText(m_put);
}

std::optional<double> NumberField::number() const
{
    if (m_value && untouched()) return m_value;
    const NumberRead read = readNumber(text());
    return read ? std::optional(read.value) : std::nullopt;
}

QString NumberField::plain() const
{
    return m_value && untouched() ? m_plain : readNumber(text()).plain;
}

bool NumberField::check()
{
    const bool nothing = m_optional && text().trimmed().isEmpty();
    refuse(nothing || (m_value && untouched()) ? QString() : readNumber(text()).problem);
    return problem().isEmpty();
}

void NumberField::refuse(const QString& why)
{
    if (why == problem()) return;
    markWrong(*this, why);
    emit problemChanged(why);
}

QString NumberField::problem() const
{
    return wrongness(*this);
}

NumberSpin::NumberSpin(QWidget* parent) : QDoubleSpinBox(parent)
{
    // what is typed half is no number yet, and no value before the field is left; what is none then leaves all as
    // it was
    setKeyboardTracking(false);
    connect(this, &QDoubleSpinBox::textChanged, this, [this](const QString& text) {
        const NumberRead read = readNumber(bare(text));
        markWrong(*this, hasAcceptableInput() ? QString()
                         : !read              ? read.problem
                                 : tr("From %1 to %2.").arg(textFromValue(minimum()), textFromValue(maximum())));
    });
    connect(this, &QDoubleSpinBox::editingFinished, this, [this] { markWrong(*this, {}); });
}

QString NumberSpin::textFromValue(double value) const
{
    return localNumber(QString::number(value == 0.0 ? 0.0 : value, 'f', decimals()));
}

double NumberSpin::valueFromText(const QString& text) const
{
    const NumberRead read = readNumber(bare(text));
    if (!read) return value();
    const double power = std::pow(10.0, decimals());
    return std::round(read.value * power) / power;
}

QValidator::State NumberSpin::validate(QString& text, int&) const
{
    const QString typed = bare(text);
    if (!specialValueText().isEmpty() && text == specialValueText()) return QValidator::Acceptable;
    const NumberRead read = readNumber(typed);
    if (read && read.value >= minimum() && read.value <= maximum()) return QValidator::Acceptable;
    return QValidator::Intermediate;
}

QString NumberSpin::bare(const QString& text) const
{
    QString typed = text;
    if (!prefix().isEmpty() && typed.startsWith(prefix())) typed.remove(0, prefix().size());
    if (const QString unit = suffix().trimmed(); !unit.isEmpty() && typed.trimmed().endsWith(unit))
        typed = typed.trimmed().chopped(unit.size());
    return typed.trimmed();
}

void putLength(QDoubleSpinBox& field, double length, int decimals)
{
    constexpr int kMostDecimals = 9;
    const int wanted = length > 0.0 ? 1 - int(std::floor(std::log10(length))) : decimals;
    const QSignalBlocker quiet(&field);
    field.setDecimals(std::clamp(wanted, decimals, kMostDecimals));
    field.setMinimum(std::pow(10.0, -field.decimals()));
    field.setValue(length);
}

}  // namespace punctum::ui
