// SPDX-License-Identifier: MIT
#pragma once

#include "core/edit/CloudKey.h"
#include "core/edit/PackedSet.h"
#include "core/edit/Recipe.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace punctum
{

/// One thing that was done.
struct JournalEntry {
    enum class Kind {
        Do,    ///< the recipe was followed
        Undo,  ///< the last one that is in force was taken back
        Redo,  ///< the last one that was taken back was done again
    };
    Kind kind = Kind::Do;
    Recipe recipe;           ///< of a step, or a literal (Literal.h)
    std::string name;        ///< what the history calls it
    PointIndex changed = 0;  ///< points
    /// Of an entry that was read: the points of its recipe, which has none itself. They stay packed, since each set
    /// would take a bit a point, and the number of points is the file's word until the key has matched a cloud.
    std::optional<PackedSet> within;
};

/// A journal as it was found.
struct JournalContents {
    CloudKey key;
    std::string file;  ///< where the cloud came from: filesOfJournal()
    std::vector<JournalEntry> entries;
    std::string damage;  ///< a sentence when the journal could not be read to its end; else empty
    /// Names of the commands that are in force at the end, oldest first.
    std::vector<std::string> inForce() const;
};

/// The files of a journal as its one word for them has them, and back: paths with NUL between them, in the order of
/// the points.
std::string journalFiles(const std::vector<std::filesystem::path>& files);
std::vector<std::filesystem::path> filesOfJournal(const std::string& files);
/// For sentences: "a.laz" or "a.laz and 3 other files"; "a file" where it is not known.
std::string journalFileText(const std::string& files);

// -- the lines of a journal (docs/dev/journal.md), without the sum at their end (core/SummedText.h)

inline constexpr std::string_view kJournalFirstLine = "punctum-journal 1";
std::string journalCloudLine(const CloudKey& key, const std::string& file);
/// A Do that is to be noted: the points are those of its recipe, of the cloud that the key is of.
std::string journalLine(const JournalEntry& entry);

/// What of a journal's bytes is sound.
struct SoundJournal {
    JournalContents contents;
    std::uint32_t sum = 0;     ///< of the last sound line
    std::size_t bytes = 0;     ///< up to its end
    std::size_t position = 0;  ///< commands in force
    std::size_t undone = 0;    ///< commands that can be redone
};
/// Throws Error when not even the beginning is a journal's.
SoundJournal soundPart(const std::filesystem::path& path, const std::string& text);

}  // namespace punctum
