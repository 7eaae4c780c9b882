// SPDX-License-Identifier: MIT
#pragma once

#include "ui/basic/Numbers.h"

#include <QDoubleSpinBox>
#include <QLineEdit>

#include <optional>

namespace punctum::ui
{

/// A field for a number as the user's locale writes it. What is none is refused where it stands: the field is
/// marked, and says why by problem() and its tool tip. A number that the program has put in is kept exactly for as
/// long as nobody types another one, however short its text is. GUI thread only.
class NumberField final : public QLineEdit
{
    Q_OBJECT
public:
    explicit NumberField(QWidget* parent = nullptr);

    /// Empty means that there is no number, which is as good as one.
    void setOptional(bool on) { m_optional = on; }
    /// The number, and the program's text that stands for it. Leaves a field alone in which somebody types.
    void put(double value, const QString& plain);
    /// The same for a number that is known as a text of the program; empty: none.
    void put(const QString& plain);
    /// What was put in is there still.
    bool untouched() const { return text() == m_put; }

    /// Nothing where there is none.
    std::optional<double> number() const;
    /// The program's text of it, digit by digit as it was typed; empty where there is none.
    QString plain() const;
    /// Whether it has a number, or may do without; marks it when not.
    bool check();
    /// Marks it for a reason of the caller's; empty: it is well.
    void refuse(const QString& why);
    /// Why it is marked; empty when it is not.
    QString problem() const;

signals:
    void problemChanged(const QString& problem);

private:
    bool m_optional = false;
    std::optional<double> m_value;  ///< that was put in
    QString m_plain, m_put;         ///< its text, and as the field shows it
};

/// A spin box that reads and writes as the fields do. GUI thread only.
class NumberSpin final : public QDoubleSpinBox
{
    Q_OBJECT
public:
    explicit NumberSpin(QWidget* parent = nullptr);

    QString textFromValue(double value) const override;
    double valueFromText(const QString& text) const override;
    QValidator::State validate(QString& text, int& at) const override;
    /// Nothing that is typed is made into a number that it is not.
    void fixup(QString&) const override {}

private:
    QString bare(const QString& text) const;
};

/// Puts a length into a spin box without a signal. Its decimals, at least so many, and its least value follow the
/// length, since some clouds are kilometers wide and others millimeters.
void putLength(QDoubleSpinBox& field, double length, int decimals);

}  // namespace punctum::ui
