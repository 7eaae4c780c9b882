// SPDX-License-Identifier: MIT
#pragma once

#include "ui/basic/Question.h"
#include "ui/document/Recovery.h"

class QWidget;

namespace punctum::ui
{

/// Shows lines of a report in a window of its own, which waits for nothing and can be copied from. GUI thread.
void showReport(QWidget* parent, const QString& title, const QString& text);

/// Asks; returns at once, and calls `then` with the answer. GUI thread.
void askQuestion(QWidget* parent, const Question& question, std::function<void(bool)> then);

/// Asks whether to recover; closing the box and Escape mean later. Returns at once. GUI thread.
void askRecovery(QWidget* parent, const Question& question, std::function<void(RecoveryAnswer)> then);

/// What to do with a file that has unsaved changes and is to be closed.
enum class UnsavedAnswer { Save, Discard, Cancel };
/// Waits for the answer. GUI thread.
/// `changes`: in one line, what they are; empty: not known.
UnsavedAnswer askAboutUnsaved(QWidget* parent, const QString& name, const QString& changes);

/// Asks whether to save `name` although something is left out or upgraded; returns at once, and calls `then` with
/// the answer. GUI thread.
void askBeforeSaving(QWidget* parent, const QString& name, const QString& what, std::function<void(bool)> then);

}  // namespace punctum::ui
