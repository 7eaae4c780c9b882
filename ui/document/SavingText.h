// SPDX-License-Identifier: MIT
#pragma once

#include "core/session/Session.h"

#include <QString>

#include <filesystem>
#include <vector>

namespace punctum::ui
{

/// The words about saving. Any thread.

/// What the message and the properties say: "Saved a.laz: 1,204 points, 6 kB, read back and compared. ..."
QString savedText(const SaveOutcome& outcome, const std::filesystem::path& target);
/// The same of a survey, whose files these are: "Saved 2 of 4 files (a.laz, b.laz): ...", in `target` unless each
/// stayed in its place.
QString savedPartsText(const SaveOutcome& outcome, const std::vector<SessionPart>& files, bool inPlace,
                       const std::filesystem::path& target);
/// The whole comparison, in lines; empty when there is none.
QString savedDetails(const SaveOutcome& outcome, const std::filesystem::path& original,
                     const std::filesystem::path& target);
/// Whether the file gets another point format or LAS version.
bool upgrades(const las::SavePreview& preview);
/// What would be left out or upgraded, in sentences for a question; empty when there is nothing to ask about.
QString savingQuestion(const las::SavePreview& preview);

}  // namespace punctum::ui
