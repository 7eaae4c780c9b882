// SPDX-License-Identifier: MIT
#pragma once

#include <QString>

#include <functional>

namespace punctum::ui
{

/// What the user is asked before something goes on.
struct Question {
    QString text;
    QString reason;             ///< in sentences
    QString yes;                ///< the button that goes on
    QString no = {};            ///< the button that does not, which Escape stands for; empty: Cancel
    bool yesByDefault = false;  ///< Return goes on: only where that loses nothing
};

/// Puts a question to the user, returns at once, and calls `answer` with whether to go on, any time later. Replaced
/// by tests.
using AskQuestion = std::function<void(const Question& question, std::function<void(bool)> answer)>;

}  // namespace punctum::ui
