// SPDX-License-Identifier: MIT
#pragma once

#include <QBoxLayout>
#include <QLabel>
#include <QScrollArea>

class QComboBox;

namespace punctum::ui
{

/// A label in the color of what matters less; the theme knows the property. The caller's layout owns it.
QLabel* dimLabel(const QString& text);
/// The bold title of a part of a panel.
QLabel* heading(const QString& text);
/// Marks a field that holds what cannot be used, and says why beside it and in its tool tip; empty: it is well
/// again.
void markWrong(QWidget& field, const QString& why);
/// Why it is marked; empty when it is not.
QString wrongness(const QWidget& field);
/// A panel's column that scrolls up and down where it does not fit, never sideways.
QScrollArea* scrollColumn(QWidget* content);

/// Lets it be as narrow as its panel must be, whatever long texts it has.
void mayBeNarrow(QComboBox& box);

/// Two groups of fields: side by side where there is room, else one below the other. So a row asks no more of a
/// panel than its wider half.
class FoldingRow final : public QWidget
{
public:
    /// The shares are of the width, while they stand side by side.
    explicit FoldingRow(int spacing, int firstShare = 1, int secondShare = 1);
    /// Layouts to put fields into.
    QHBoxLayout& first() noexcept { return *m_first; }
    QHBoxLayout& second() noexcept { return *m_second; }

    QSize minimumSizeHint() const override;

protected:
    void resizeEvent(QResizeEvent* event) override;

private:
    QBoxLayout* m_row;
    QHBoxLayout *m_first, *m_second;
};

}  // namespace punctum::ui
