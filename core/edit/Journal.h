// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/KeptPoints.h"
#include "core/cloud/PointCloud.h"
#include "core/edit/Recipe.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace punctum
{

class Command;
class Progress;

/// What a journal is about: the points as they were when it was begun. Equal for equal files; headers and other
/// records do not count.
struct CloudKey {
    PointIndex points = 0;
    std::uint64_t digest = 0;  ///< of scale, offset, and each column's name, type and bytes

    std::string text() const;  ///< "20000000-0123456789abcdef"
    friend bool operator==(const CloudKey&, const CloudKey&) = default;
};

/// Reads all points once, in parallel: some GB a second. `kept` (null: all): those of a file that lacks others, the
/// key is that file's; a column is copied at a time then. Takes cloud.mutex() shared. Throws Cancelled, Error.
CloudKey keyOf(const PointCloud& cloud, Progress& progress, const KeptPoints* kept = nullptr);

/// One thing that was done.
struct JournalEntry {
    enum class Kind {
        Do,    ///< the recipe was followed
        Undo,  ///< the last one that is in force was taken back
        Redo,  ///< the last one that was taken back was done again
    };
    Kind kind = Kind::Do;
    Recipe recipe;
    std::string name;        ///< what the history calls it
    PointIndex changed = 0;  ///< points
};

/// A journal as it was found.
struct JournalContents {
    CloudKey key;
    std::string file;  ///< where the cloud came from
    std::vector<JournalEntry> entries;
    std::string damage;  ///< a sentence when the journal could not be read to its end; else empty
    /// Names of the commands that are in force at the end, oldest first.
    std::vector<std::string> inForce() const;
};

/// A file of lines to which each edit is added at once, and on the disk before the edit is done, so that a crash or
/// power cut loses nothing that was finished.
///
/// Lines end with a checksum that also covers the line before: what is damaged, missing or exchanged is found, and
/// everything before it can be used. Format: docs/dev/journal.md. Any thread; one at a time, guarded inside. Held
/// open with a lock, so that two programs never write one journal.
class Journal
{
public:
    /// Begins a new journal. `kept` (null: all): the points of the cloud that the file holds, whose places the
    /// journal tells. Throws Error when it cannot be written, or another program has it open.
    static std::unique_ptr<Journal> create(const std::filesystem::path& path, const CloudKey& key,
                                           const std::string& file,
                                           std::shared_ptr<const KeptPoints> kept = nullptr);
    /// Goes on with one whose contents have been replayed; what was damaged at its end is cut off.
    static std::unique_ptr<Journal> resume(const std::filesystem::path& path);
    ~Journal();
    Journal(const Journal&) = delete;
    Journal& operator=(const Journal&) = delete;

    const std::filesystem::path& path() const noexcept { return m_path; }

    /// None of them throws: an edit is not refused because it cannot be noted down. What failed is told by
    /// failure(), and nothing is added any more then, as a gap cannot be replayed.
    void done(const Command& command) noexcept;
    void undone() noexcept;
    void redone() noexcept;
    /// A sentence; empty while all is well.
    std::string failure() const;

    /// Closes and removes it: nothing is left to recover.
    void remove() noexcept;

private:
    Journal(std::filesystem::path path, int file) : m_path(std::move(path)), m_file(file) {}
    void add(const std::string& line);
    template <typename Work>
    void guarded(Work work) noexcept;

    std::filesystem::path m_path;
    mutable std::mutex m_mutex;
    int m_file = -1;
    std::uint32_t m_sum = 0;        ///< of the line before
    std::ptrdiff_t m_position = 0;  ///< commands in force that the journal knows
    std::string m_failure;
    std::shared_ptr<const KeptPoints> m_kept;  ///< null: all
};

/// Throws Error when there is no journal, or not even its beginning can be read.
JournalContents readJournal(const std::filesystem::path& path);
/// Whether a program that runs has it open.
bool isJournalInUse(const std::filesystem::path& path);

}  // namespace punctum
