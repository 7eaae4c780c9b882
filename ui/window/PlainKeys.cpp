// SPDX-License-Identifier: MIT
#include "ui/window/PlainKeys.h"

#include "ui/view/Viewport.h"

#include <QAbstractButton>
#include <QAbstractItemView>
#include <QApplication>
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

/// Whether it has the keys because somebody clicked on it, and nobody types into it.
bool clicked(const QWidget* widget)
{
    return qobject_cast<const QAbstractItemView*>(widget) != nullptr ||
           qobject_cast<const QAbstractButton*>(widget) != nullptr;
}

}  // namespace

PlainKeys::PlainKeys(QMainWindow& window) : QObject(&window)
{
    for (QWidget* panel : window.findChildren<QDockWidget*>()) panel->installEventFilter(this);
    for (QWidget* bar : window.findChildren<QToolBar*>()) bar->installEventFilter(this);
    for (QWidget* view : window.findChildren<Viewport*>()) view->installEventFilter(this);
}

/// The question whether somebody inside wants the key before shortcuts do comes up to the panel when nobody said
/// so.
bool PlainKeys::eventFilter(QObject* watched, QEvent* event)
{
    if (auto* const view = qobject_cast<Viewport*>(watched)) {
        if (event->type() == QEvent::Enter && clicked(QApplication::focusWidget())) view->setFocus();
        return false;
    }
    if (event->type() != QEvent::ShortcutOverride || !isPlain(*static_cast<QKeyEvent*>(event))) return false;
    event->accept();
    return true;
}

}  // namespace punctum::ui
