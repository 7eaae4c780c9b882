// SPDX-License-Identifier: MIT
#pragma once

#include <QColor>
#include <QString>

class QApplication;
class QFont;

namespace punctum::ui
{

/// The window's colors and spacing. GUI thread.

/// Height of line edits, combo boxes and spin boxes in logical px, so that rows line up.
inline constexpr int kFieldHeight = 30;
/// px that each column of panels can do with.
inline constexpr int kLeastPanelWidth = 222;

enum class Appearance { System, Dark, Light };

/// The colors that widgets of ours paint with, beyond the palette.
struct ThemeColors {
    bool dark = true;
    QColor window, base, raised, hover, border, text, dim, accent, accentSoft, warning, error, good;
};

/// Style, palette and style sheet for the whole program. System: as the desktop says, dark where it says nothing.
void applyTheme(QApplication& application, Appearance appearance);
/// The colors in force.
const ThemeColors& themeColors();

/// Name as kept in the settings, and back.
QString nameOf(Appearance appearance);
Appearance appearanceFromName(const QString& name);

/// `font`, `step` points smaller (negative) or larger, and bolder on request.
QFont scaledFont(QFont font, double factor, bool bold = false);

}  // namespace punctum::ui
