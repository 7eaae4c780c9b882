// SPDX-License-Identifier: MIT
#include "ui/window/PlainKeys.h"

#include <QDockWidget>
#include <QKeyEvent>
#include <QMainWindow>
#include <QToolBar>

namespace punctum::ui
{

namespace
{

bool isPlain(const QKeyEvent& key)
{
    if (key.modifiers() & (Qt::ControlModifier | Qt::AltModifier | Qt::MetaModifier)) return false;
    const bool printable = key.key() >= Qt::Key_Space && key.key() < Qt::Key_Escape;
    return printable || key.key() == Qt::Key_Delete || key.key() == Qt::Key_Backspace;
}

}  // namespace

PlainKeys::PlainKeys(QMainWindow& window) : QObject(&window)
{
    for (QWidget* panel : window.findChildren<QDockWidget*>()) panel->installEventFilter(this);
    for (QWidget* bar : window.findChildren<QToolBar*>()) bar->installEventFilter(this);
}

/// The question whether somebody inside wants the key before shortcuts do comes up to the panel when nobody said
/// so.
bool PlainKeys::eventFilter(QObject*, QEvent* event)
{
    if (event->type() != QEvent::ShortcutOverride || !isPlain(*static_cast<QKeyEvent*>(event))) return false;
    event->accept();
    return true;
}

}  // namespace punctum::ui
