// SPDX-License-Identifier: MIT
#pragma once

#include <QString>

#include <functional>

class QWidget;

namespace punctum::ui
{

/// Shows lines of a report in a window of its own, which waits for nothing and can be copied from. GUI thread.
void showReport(QWidget* parent, const QString& title, const QString& text);

/// Asks a question with the reason for it, and a button `yes` beside Cancel; returns at once, and calls `then` with
/// the answer. GUI thread.
void askQuestion(QWidget* parent, const QString& question, const QString& reason, const QString& yes,
                 std::function<void(bool)> then);

/// Asks whether to save `name` although something is left out or upgraded; returns at once, and calls `then` with
/// the answer. GUI thread.
void askBeforeSaving(QWidget* parent, const QString& name, const QString& what, std::function<void(bool)> then);

}  // namespace punctum::ui
