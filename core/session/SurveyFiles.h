// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/AttributeChange.h"
#include "core/las/Diff.h"
#include "core/session/Session.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace punctum
{

/// The folder that holds all of the files, in itself or in folders inside; "." where there is none that is named.
std::filesystem::path commonFolder(const std::vector<std::filesystem::path>& files);

/// Indices of those that are true.
std::vector<std::size_t> changedNumbers(const std::vector<bool>& parts);

/// Adds what differs in one file of several to what differs in all of them.
void addDifference(const las::Difference& part, las::Difference& all);

/// In one line, what is not saved of a survey: "Classification of 1,204 points, in 2 of 4 files". Empty when
/// nothing.
std::string unsavedInSurvey(const std::optional<std::vector<AttributeChange>>& changes,
                            const std::vector<bool>& changedParts);

/// Says what one file of points of several cannot say of all of them.
void addOneFileNotes(const std::vector<SessionPart>& files, std::vector<std::string>& notes);

}  // namespace punctum
