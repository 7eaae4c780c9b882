// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/AttributeChange.h"
#include "core/edit/Command.h"
#include "core/edit/CommandPreview.h"
#include "core/edit/HistoryRoom.h"

#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace punctum
{

class Journal;
class Progress;
class SpillFile;

/// The commands done to one cloud, in order, and how many of them are in force.
///
/// push(), undo() and redo() change points, so they run in a job; one at a time, guarded inside. The questions may
/// be asked from any thread; until one of the three returns they are answered as before it. A listener of the
/// cloud must not call the three.
class History
{
public:
    explicit History(std::shared_ptr<PointCloud> cloud, HistoryRoom room = {})
        : m_cloud(std::move(cloud)), m_room(std::move(room))
    {
    }

    /// Applies the command and puts it on top; commands that were undone are gone. Null: nothing happens. As the
    /// two below, throws Error with all as it was when what the command needs cannot be read back.
    void push(std::unique_ptr<Command> command);
    void undo();  ///< nothing when there is nothing to undo
    void redo();

    /// From now on each change is noted there before it is done; null: nowhere. A new one begins with the present
    /// state; one that is gone on with has led to it, and its commands are those of this history.
    void setJournal(std::shared_ptr<Journal> journal);
    std::shared_ptr<Journal> journal() const;

    bool canUndo() const;
    bool canRedo() const;
    std::string undoName() const;  ///< name of the command that undo() would take back; empty when none
    std::string redoName() const;
    /// Whether the cloud differs from what was last saved (or loaded).
    bool modified() const;
    void markSaved();
    /// What is saved is none of the states that can be reached: the cloud differs from it from now on.
    void forgetSaved();
    /// What differs from what was last saved (or loaded), but for points deleted since: values that really are
    /// other ones, not those that were changed and changed back. Attributes that were not there then are left out;
    /// of those that were replaced by others of the same name, all points count. Nothing when that state can no
    /// longer be reached. Waits for a change that goes on; memory: a column at a time. Throws Cancelled, Error.
    std::optional<std::vector<AttributeChange>> changes(Progress& progress) const;
    /// Of each range of points, whether something there differs from what was last saved (or loaded): a value, a
    /// point that was deleted or restored, an attribute that came, went or got another name (then everywhere).
    /// Nothing when that state can no longer be reached. Waits and throws as changes().
    std::optional<std::vector<bool>> changedIn(std::span<const PointRange> ranges, Progress& progress) const;
    /// How the cloud looked before the command that undo() would take back; nothing where there is none. Waits for
    /// a change that goes on, and keeps others waiting. Memory and errors as previewOf().
    CommandPreview beforeLast(Progress& progress) const;
    std::vector<std::string> names() const;         ///< oldest first
    std::vector<PointIndex> changedPoints() const;  ///< by each of them
    std::size_t position() const;                   ///< how many of names() are in force

    /// Bytes that the commands keep, about.
    struct Kept {
        std::size_t memory = 0;
        std::size_t file = 0;
    };
    Kept kept() const;
    /// A sentence when the file took no more, so that memory is used on; given once, else empty.
    std::string takeWarning();

private:
    void move(bool forward);
    std::optional<std::vector<const Command*>> wayToSaved() const;
    void stowDistant() noexcept;
    bool spill(Command& command) noexcept;

    std::shared_ptr<PointCloud> m_cloud;
    HistoryRoom m_room;
    std::shared_ptr<SpillFile> m_file;  ///< null until it is needed; used by changes alone
    mutable std::mutex m_changing;      ///< one change at a time
    mutable std::mutex m_mutex;         ///< guards what follows
    std::vector<std::unique_ptr<Command>> m_commands;
    std::size_t m_done = 0;
    Kept m_kept;
    std::string m_warning;
    bool m_warned = false;
    std::shared_ptr<Journal> m_journal;
    std::ptrdiff_t m_saved = 0;  ///< -1: the saved state can no longer be reached
};

}  // namespace punctum
