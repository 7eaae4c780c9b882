// SPDX-License-Identifier: MIT
#pragma once

#include <QLabel>
#include <QScrollArea>

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

}  // namespace punctum::ui
