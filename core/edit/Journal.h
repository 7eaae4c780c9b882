// SPDX-License-Identifier: MIT
#pragma once

#include "core/Identity.h"
#include "core/cloud/KeptPoints.h"
#include "core/edit/JournalText.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace punctum
{

class Command;

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
    /// journal tells. One that has edits already, which nobody has recovered, is set aside. Throws Error when it
    /// cannot be written, or another program has it open.
    static std::unique_ptr<Journal> create(const std::filesystem::path& path, const CloudKey& key,
                                           const std::string& file,
                                           std::shared_ptr<const KeptPoints> kept = nullptr);
    /// Goes on with one whose contents have been replayed; what was damaged at its end is cut off.
    static std::unique_ptr<Journal> resume(const std::filesystem::path& path);
    ~Journal();
    Journal(const Journal&) = delete;
    Journal& operator=(const Journal&) = delete;

    const std::filesystem::path& path() const noexcept { return m_path; }
    /// Where create() has put one that stood in its place; empty: there was none.
    const std::filesystem::path& setAside() const noexcept { return m_setAside; }
    /// Of one that was resumed: the commands (Command::identity()) that its entries became are the last `position`
    /// of the history's first `done`, and those that follow.
    void recognize(const std::vector<Identity>& history, std::size_t done) noexcept;

    /// Neither throws: an edit is not refused because it cannot be noted down. What failed is told by failure().
    /// After a line that could not be written nothing is added any more, as a gap cannot be replayed; what cannot
    /// be told leaves a gap for as long as it is in force. A new command is about to be done.
    void done(const Command& command) noexcept;
    /// One of before is about to be done again, or undone; it is ready for that.
    void moved(const Command& command, const PointCloud& cloud, bool forward) noexcept;
    /// A sentence; empty while all is well.
    std::string failure() const;

    /// Closes and removes it: nothing is left to recover.
    void remove() noexcept;

private:
    /// A command that was done or undone since the journal began.
    struct Move {
        std::optional<Identity> command;  ///< nothing: an entry that was read, until it is recognized
        bool forward = true;
        bool noted = true;  ///< has a line
    };

    Journal(std::filesystem::path path, int file) : m_path(std::move(path)), m_file(file) {}
    void add(const std::string& line);
    JournalEntry entryOf(const Command& command, Recipe recipe) const;
    template <typename MakeEntry>
    void push(const Identity& command, bool forward, MakeEntry makeEntry);
    template <typename Work>
    void guarded(Work work) noexcept;

    std::filesystem::path m_path, m_setAside;
    mutable std::mutex m_mutex;
    int m_file = -1;
    std::uint32_t m_sum = 0;                   ///< of the line before
    std::vector<Move> m_moves;                 ///< what a reader's history will have
    std::size_t m_position = 0;                ///< how many of them are in force
    std::string m_failure;                     ///< for good
    std::string m_gap;                         ///< why moves in force have no line; empty: all have
    std::shared_ptr<const KeptPoints> m_kept;  ///< null: all
};

/// Throws Error when there is no journal, or not even its beginning can be read.
JournalContents readJournal(const std::filesystem::path& path);
/// Gives a journal another name, under which it is not offered any more, but kept for whoever wants to follow it.
/// Returns that name. Throws Error.
std::filesystem::path setJournalAside(const std::filesystem::path& path);
/// Whether there is a journal with more than the two lines that it begins with: one that was only being begun when
/// its program was killed has nothing to recover, and its beginning may be cut off. Throws Error when it cannot be
/// read.
bool journalHasEdits(const std::filesystem::path& path);

/// Whether a program that runs has it open.
bool isJournalInUse(const std::filesystem::path& path);

}  // namespace punctum
