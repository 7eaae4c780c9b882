// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/Diff.h"
#include "ui/Document.h"

#include <QString>

#include <cstdint>
#include <filesystem>
#include <optional>

namespace punctum::ui
{

/// The work of saving, for jobs: nothing here touches a widget or a Document. Throws Error and Cancelled.

/// What a save is going to change, and after how many edits that was true.
struct Forecast {
    las::SavePreview preview;
    std::uint64_t edits = 0;
};

/// Compares the cloud with the file `original` that holds what was opened or saved last, point by point.
Forecast foresee(OpenCloud& data, const std::filesystem::path& original, const std::filesystem::path& target,
                 Progress& progress);

/// In one line, what saving to `original` would change; quick, as the history says. Empty when nothing.
QString unsavedChanges(OpenCloud& data, const std::filesystem::path& original, Progress& progress);

/// What came of a save.
struct SaveOutcome {
    las::WriteReport report;
    las::SavePreview preview;  ///< A: the file before; B: the file now
    bool compared = false;     ///< there was a file to compare with, and no edit came in between
    bool disturbed = false;    ///< points were edited while the file was written: it lacks these edits
};

/// Foresees (unless `forecast` still holds), writes, verifies, and marks the history as saved. That there is
/// nothing to compare with does not keep it from saving. `options`: what the user said yes to; whether to compress
/// is decided here, by the name. Throws las::WriteQuestion where the user must say more.
SaveOutcome saveCloud(OpenCloud& data, const std::filesystem::path& original, const std::filesystem::path& target,
                      std::optional<Forecast> forecast, las::WriteOptions options, Progress& progress);

/// What the message and the properties say: "Saved a.laz: 1,204 points, 6 kB, read back and compared. ..."
QString savedText(const SaveOutcome& outcome, const std::filesystem::path& target);
/// The whole comparison, in lines; empty when there is none.
QString savedDetails(const SaveOutcome& outcome, const std::filesystem::path& original,
                     const std::filesystem::path& target);
/// Whether the file gets another point format or LAS version.
bool upgrades(const las::SavePreview& preview);
/// What would be left out or upgraded, in sentences for a question; empty when there is nothing to ask about.
QString savingQuestion(const las::SavePreview& preview);

}  // namespace punctum::ui
