// SPDX-License-Identifier: MIT
#include "ui/style/Theme.h"

#include "ui/style/Style.h"

#include <QApplication>
#include <QFont>
#include <QPalette>
#include <QStyle>
#include <QStyleHints>

#include <algorithm>
#include <utility>

namespace punctum::ui
{

namespace
{

ThemeColors darkColors()
{
    return {true,
            QColor(0x1f, 0x21, 0x24),
            QColor(0x18, 0x1a, 0x1c),
            QColor(0x2a, 0x2d, 0x31),
            QColor(0x32, 0x36, 0x3b),
            QColor(0x35, 0x39, 0x3e),
            QColor(0xe3, 0xe5, 0xe8),
            QColor(0x98, 0x9f, 0xa7),
            QColor(0x58, 0xa6, 0xff),
            QColor(0x25, 0x3c, 0x58),
            QColor(0xe3, 0xb3, 0x41),
            QColor(0xf4, 0x70, 0x67),
            QColor(0x57, 0xc2, 0x7a)};
}

ThemeColors lightColors()
{
    return {false,
            QColor(0xf3, 0xf4, 0xf6),
            QColor(0xff, 0xff, 0xff),
            QColor(0xff, 0xff, 0xff),
            QColor(0xe7, 0xea, 0xee),
            QColor(0xd3, 0xd7, 0xdd),
            QColor(0x1d, 0x21, 0x27),
            QColor(0x62, 0x6a, 0x74),
            QColor(0x1f, 0x6f, 0xe0),
            QColor(0xd9, 0xe8, 0xfc),
            QColor(0x9a, 0x67, 0x00),
            QColor(0xc9, 0x2a, 0x2a),
            QColor(0x1a, 0x7f, 0x4b)};
}

QPalette paletteOf(const ThemeColors& c)
{
    QPalette p;
    p.setColor(QPalette::Window, c.window);
    p.setColor(QPalette::WindowText, c.text);
    p.setColor(QPalette::Base, c.base);
    p.setColor(QPalette::AlternateBase, c.window);
    p.setColor(QPalette::Text, c.text);
    p.setColor(QPalette::PlaceholderText, c.dim);
    p.setColor(QPalette::Button, c.raised);
    p.setColor(QPalette::ButtonText, c.text);
    p.setColor(QPalette::BrightText, c.error);
    p.setColor(QPalette::ToolTipBase, c.raised);
    p.setColor(QPalette::ToolTipText, c.text);
    p.setColor(QPalette::Highlight, c.accent);
    p.setColor(QPalette::HighlightedText, c.dark ? QColor(0x0c, 0x12, 0x1a) : QColor(Qt::white));
    p.setColor(QPalette::Link, c.accent);
    p.setColor(QPalette::LinkVisited, c.accent);
    p.setColor(QPalette::Light, c.hover);
    p.setColor(QPalette::Midlight, c.raised);
    p.setColor(QPalette::Mid, c.border);
    p.setColor(QPalette::Dark, c.dark ? c.base : c.border);
    p.setColor(QPalette::Shadow, QColor(0, 0, 0));
    const QColor off = c.dark ? QColor(0x6a, 0x70, 0x77) : QColor(0xa0, 0xa6, 0xae);
    for (const auto role : {QPalette::WindowText, QPalette::Text, QPalette::ButtonText, QPalette::HighlightedText})
        p.setColor(QPalette::Disabled, role, off);
    p.setColor(QPalette::Disabled, QPalette::Highlight, c.border);
    return p;
}

/// What Fusion and the palette leave to be wished for: quiet docks, even spacing, rounded fields.
QString sheetOf(const ThemeColors& c)
{
    QString sheet = QStringLiteral(R"(
QMainWindow, QDialog { background: @window; }
QMainWindow::separator { background: @window; width: 5px; height: 5px; }
QMainWindow::separator:hover { background: @accentSoft; }

QMenuBar { background: @window; padding: 2px 6px; border-bottom: 1px solid @border; }
QMenuBar::item { padding: 5px 10px; border-radius: 5px; background: transparent; }
QMenuBar::item:selected { background: @hover; }
QMenu { background: @raised; border: 1px solid @border; padding: 5px; }
QMenu::item { padding: 6px 28px 6px 26px; border-radius: 5px; }
QMenu::item:selected { background: @accentSoft; color: @text; }
QMenu::item:disabled { color: @dim; background: transparent; }
QMenu::separator { height: 1px; background: @border; margin: 5px 8px; }
QMenu::icon { padding-left: 7px; }
QMenu::indicator { width: 14px; height: 14px; padding-left: 7px; }

QToolBar { background: @window; border: none; border-bottom: 1px solid @border; spacing: 2px; padding: 4px 8px; }
QToolBar::separator { background: @border; width: 1px; margin: 5px 7px; }
QToolButton { border: none; border-radius: 6px; padding: 5px; }
QToolButton:hover { background: @hover; }
QToolButton:pressed, QToolButton:checked { background: @accentSoft; }
QToolButton:focus { border: 1px solid @accent; padding: 4px; }

QStatusBar { background: @window; border-top: 1px solid @border; }
QStatusBar::item { border: none; }
QStatusBar QLabel { color: @dim; padding: 3px 10px; }

QDockWidget > QWidget { background: @window; }
QTabBar { qproperty-drawBase: 0; background: transparent; }
QTabBar::tab { padding: 7px 6px; color: @dim; background: transparent; border: none; border-bottom: 2px solid transparent; }
QTabBar::tab:selected { color: @text; border-bottom: 2px solid @accent; }
QTabBar::tab:hover:!selected { color: @text; }

QListView, QTreeView, QTableView, QTextBrowser { background: @base; border: 1px solid @border; border-radius: 7px; outline: none; }
QListView:focus, QTreeView:focus, QTableView:focus, QTextBrowser:focus, QPlainTextEdit:focus { border-color: @accent; }
QComboBox QAbstractItemView { padding: 4px; border-radius: 0; }
QTableView::item { border: none; padding: 0 6px; }
QTreeView::item { border: none; padding: 2px 6px; }
QTableView::item:selected, QTreeView::item:selected { background: @accentSoft; color: @text; }
QHeaderView { background: transparent; }
QHeaderView::section { background: transparent; color: @dim; border: none; padding: 4px 6px; }

QPushButton { background: @raised; border: 1px solid @border; border-radius: 6px; padding: 6px 14px; }
QPushButton:hover { background: @hover; }
QPushButton:pressed { background: @accentSoft; }
QPushButton:focus { border-color: @accent; }
QPushButton:disabled { color: @dim; }
QPushButton[primary="true"] { background: @accent; border-color: @accent; color: @onAccent; font-weight: 600; }
QPushButton[primary="true"]:hover { background: @accentHover; }
QPushButton[primary="true"]:focus { border-color: @text; }
QPushButton[primary="true"]:disabled { background: @raised; border-color: @border; color: @dim; }
QPushButton[flat="true"] { background: transparent; border: none; padding: 4px 8px; color: @accent; }
QPushButton[flat="true"]:hover { background: @hover; }
QPushButton[flat="true"]:focus { border: 1px solid @accent; padding: 3px 7px; }
QTabBar::tab:focus { color: @accent; }
QPushButton:checked { background: @accentSoft; border-color: @accent; }
QPushButton:checked:disabled { background: @raised; border-color: @border; }

QLineEdit { min-height: 18px; background: @base; border: 1px solid @border; border-radius: 6px; padding: 5px 7px; selection-background-color: @accent; }
QLineEdit:focus { border-color: @accent; }
QLineEdit:disabled { color: @dim; }
QLineEdit[wrong="true"] { border-color: @error; }
QPlainTextEdit#rule { background: @base; border: 1px solid @border; border-radius: 6px; padding: 2px 3px; selection-background-color: @accent; }
QPlainTextEdit#rule:focus { border-color: @accent; }
QPlainTextEdit#rule[wrong="true"] { border-color: @error; }

QMessageBox QLabel#qt_msgbox_label { font-weight: 600; }
QMessageBox QLabel#qt_msgbox_informativelabel { min-width: 380px; }

QProgressBar { background: @hover; border: none; border-radius: 2px; max-height: 4px; min-height: 4px; }
QProgressBar::chunk { background: @accent; border-radius: 2px; }

QScrollBar:vertical { background: transparent; width: 10px; margin: 0; }
QScrollBar:horizontal { background: transparent; height: 10px; margin: 0; }
QScrollBar::handle { background: @border; border-radius: 3px; margin: 2px; min-height: 28px; min-width: 28px; }
QScrollBar::handle:hover { background: @dim; }
QScrollBar::add-line, QScrollBar::sub-line, QScrollBar::add-page, QScrollBar::sub-page { background: none; border: none; width: 0; height: 0; }

QToolTip { background: @raised; color: @text; border: 1px solid @border; padding: 5px 7px; }
QLabel[dim="true"] { color: @dim; }
QLabel[dockTitle="true"] { color: @text; font-weight: 600; padding: 9px 11px 3px 11px; }
)");
    const std::pair<const char*, QColor> tokens[] = {
        {"@accentSoft", c.accentSoft},
        {"@accentHover", c.accent.lighter(c.dark ? 112 : 118)},
        {"@accent", c.accent},
        {"@onAccent", c.dark ? QColor(0x0c, 0x12, 0x1a) : QColor(Qt::white)},
        {"@window", c.window},
        {"@base", c.base},
        {"@raised", c.raised},
        {"@hover", c.hover},
        {"@border", c.border},
        {"@text", c.text},
        {"@dim", c.dim},
        {"@error", c.error},
    };
    for (const auto& [token, color] : tokens) sheet.replace(QLatin1String(token), color.name());
    return sheet;
}

bool systemIsDark([[maybe_unused]] const QApplication& application)
{
#if QT_VERSION >= QT_VERSION_CHECK(6, 5, 0)
    return QApplication::styleHints()->colorScheme() != Qt::ColorScheme::Light;
#else
    return true;  // Qt 6.4 cannot tell
#endif
}

}  // namespace

const ThemeColors& themeColors()
{
    static const ThemeColors dark = darkColors();
    static const ThemeColors light = lightColors();
    return QApplication::palette().color(QPalette::Window).lightness() < 128 ? dark : light;
}

void applyTheme(QApplication& application, Appearance appearance)
{
    const bool dark =
        appearance == Appearance::Dark || (appearance == Appearance::System && systemIsDark(application));
    const ThemeColors colors = dark ? darkColors() : lightColors();
    if (!qobject_cast<Style*>(QApplication::style())) QApplication::setStyle(new Style);
    QApplication::setPalette(paletteOf(colors));
    application.setStyleSheet(sheetOf(colors));
}

QString nameOf(Appearance appearance)
{
    switch (appearance) {
        case Appearance::Dark:
            return QStringLiteral("dark");
        case Appearance::Light:
            return QStringLiteral("light");
        case Appearance::System:
            break;
    }
    return QStringLiteral("system");
}

Appearance appearanceFromName(const QString& name)
{
    for (const Appearance appearance : {Appearance::Dark, Appearance::Light})
        if (name == nameOf(appearance)) return appearance;
    return Appearance::System;
}

QFont scaledFont(QFont font, double factor, bool bold)
{
    if (font.pointSizeF() > 0)
        font.setPointSizeF(font.pointSizeF() * factor);
    else
        font.setPixelSize(std::max(1, int(font.pixelSize() * factor)));
    if (bold) font.setWeight(QFont::DemiBold);
    return font;
}

}  // namespace punctum::ui
