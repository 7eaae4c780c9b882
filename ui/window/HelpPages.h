// SPDX-License-Identifier: MIT
#pragma once

#include "ui/menu/Menus.h"

#include <vector>

class QWidget;

namespace punctum::ui
{

/// Small windows of the help menu; they do not block the main window. GUI thread.

void showAboutPage(QWidget* parent, const QString& backend, bool openGlView);
void showShortcutsPage(QWidget* parent, const std::vector<Menus::Shortcut>& shortcuts);

}  // namespace punctum::ui
