// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

namespace punctum
{

class Progress;

/// Edits that were not saved, in a journal that waits for its file or was set aside.
struct KeptJournal {
    std::filesystem::path path;                ///< of the journal
    std::vector<std::filesystem::path> files;  ///< that the edits are of: one, or those of a survey
    std::vector<std::string> edits;            ///< names of those that are in force, oldest first
    std::chrono::system_clock::time_point changed;
    bool setAside = false;
};

inline constexpr const char* kJournalEnding = ".journal";
inline constexpr const char* kSetAsideEnding = ".declined";

/// All journals of a folder that can be followed and are not in use, newest first. Those that cannot be read are
/// left out. Any thread. Throws Cancelled.
std::vector<KeptJournal> keptJournals(const std::filesystem::path& folder, Progress& progress);

}  // namespace punctum
