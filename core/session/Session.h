// SPDX-License-Identifier: MIT
#pragma once

#include "core/edit/History.h"
#include "core/edit/HistoryRoom.h"
#include "core/edit/JournalText.h"
#include "core/edit/Recipe.h"
#include "core/las/Diff.h"
#include "core/las/Reader.h"
#include "core/steps/Replay.h"
#include "core/survey/ReadingOrder.h"
#include "core/survey/Survey.h"

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace punctum
{

/// What a save is going to change, and after how many edits that was true.
struct Forecast {
    las::SavePreview preview;
    std::uint64_t edits = 0;
    /// Of a survey, by its parts: how each would be written; null where it would not. The save goes by them.
    std::vector<std::shared_ptr<const las::WritePlan>> plans{};
};

/// How to save.
struct SaveRequest {
    /// LAS or LAZ by its ending. Of a survey: empty, for each file in its own place, or a folder, for all files
    /// under their names there.
    std::filesystem::path target{};
    las::WriteOptions options{};  ///< but for `compressed`, which the target's name decides
    bool compare = true;          ///< tell what changed in the file; reads it once more, where no forecast holds
    std::optional<Forecast> forecast{};
    /// Of a survey: these alone. Empty: those that changed; in a folder all of them.
    std::vector<std::size_t> parts{};
};

/// One of the files of a session, as it is now.
struct SessionPart {
    std::filesystem::path path;  ///< the file that holds it: the one that was opened, later the one it was saved to
    PointRange points;
    std::shared_ptr<const las::SourceFile> source;  ///< as it was opened
    bool damaged = false;                           ///< something of it could not be read: it may not be replaced
};

/// What came of a save.
struct SaveOutcome {
    las::WriteReport report;         ///< of a survey: of all files that were written
    std::vector<std::size_t> parts;  ///< that were written
    las::SavePreview preview;        ///< A: the file before; B: the file now
    bool compared = false;           ///< it was asked for, there was a file, and no edit came in between
    bool disturbed = false;          ///< points were edited while the file was written: it lacks these edits
    bool others = false;             ///< files that were not asked for have edits still, which no journal notes
};

/// What came of an edit.
struct EditOutcome {
    PointIndex changed = 0;                  ///< points whose values differ now, or that are deleted or back
    std::vector<std::string> newAttributes;  ///< names
    std::string finding;                     ///< Command::finding()
};

/// A command that was made and is not done yet, and after how many edits of the session.
struct MadeEdit {
    std::unique_ptr<Command> command;  ///< null: nothing would change
    std::uint64_t edits = 0;
};

/// A journal that is about the points of a session.
struct FoundJournal {
    std::filesystem::path path;
    JournalContents contents;
};

/// One cloud that is open: the file or files that hold it, its points, the history of its edits, and a journal of
/// those that are not saved. Whoever opens, edits, saves and recovers does so here, so that the order is the same
/// for all: an edit is in the journal before it is done, and a save that missed an edit does not call it saved.
///
/// Example (docs/dev/example/classify.cpp is a whole program):
///     const auto session = Session::open("a.laz");
///     session->read(progress);
///     session->edit({"set", {{"rule", "Classification = 7 if Z < 0"}}, nullptr}, progress);
///     session->save({"b.laz", {}}, progress);
///
/// Threads: any. What takes a Progress is long, and belongs in a job; edits and undo take turns, guarded inside,
/// and may come while a save goes on. All of it throws Error with one sentence, or Cancelled, with points and files
/// as they were. A listener of the cloud must call none of it that changes points.
class Session
{
public:
    /// Reads the header and what else is no point. `room`: what may be kept for undo; in its folder unsaved edits
    /// are noted down as well, in case of a crash. Without a folder there is no journal.
    static std::shared_ptr<Session> open(const std::filesystem::path& file, HistoryRoom room = {});
    /// The same of several files as one survey; of one file, as above.
    static std::shared_ptr<Session> open(const std::vector<std::filesystem::path>& files, HistoryRoom room,
                                         Progress& progress);
    /// What is unsaved stays in its journal, as after a crash; close() is the way to end in order.
    ~Session();
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    /// Reads all points, once, before anything of what follows. `sink` as in las::Reader::read(); `ahead`: told of
    /// those that come before all others, as in Survey::Ahead. What readingOrder() was told to look at comes first.
    las::ReadResult read(Progress& progress, const las::Reader::BatchSink& sink = {},
                         const las::Reader::BatchSink& ahead = {});
    /// By which whoever looks at the points says what to read first. Any thread.
    const std::shared_ptr<ReadingOrder>& readingOrder() const noexcept { return m_order; }
    /// There is nothing to recover any more: what is unsaved is given up.
    void close() noexcept;

    const std::shared_ptr<PointCloud>& cloud() const noexcept { return m_cloud; }
    const Survey& survey() const noexcept { return *m_survey; }
    /// Whether it is a survey of several files.
    bool many() const noexcept { return m_survey->many(); }
    /// The files, one at least, in the order of their points.
    std::vector<SessionPart> parts() const;
    /// The file; of a survey what one of all its points would be, which is nowhere.
    const std::shared_ptr<const las::SourceFile>& source() const noexcept { return m_survey->source(); }
    const History& history() const noexcept { return *m_history; }
    /// Of a survey the folder that holds all its files.
    const std::filesystem::path& openedPath() const noexcept { return m_opened; }
    /// Of the file that holds the cloud: the one that was opened, later the one that it was saved to. Of a survey
    /// the folder that holds all its files.
    std::filesystem::path path() const;
    /// Something of a file that was opened could not be read: it may not be replaced.
    bool damaged() const noexcept { return m_damaged; }

    // -- editing

    /// Makes the recipe's command and does it, as one step of the history.
    EditOutcome edit(const Recipe& recipe, Progress& progress);
    /// The recipe's command alone, which changes nothing: to be looked at (previewOf()), then given to apply().
    MadeEdit make(const Recipe& recipe, Progress& progress) const;
    /// Does it as edit() does. Nothing where points were edited since it was made: it is no longer true then.
    std::optional<EditOutcome> apply(MadeEdit made, Progress& progress);
    /// Undoes or redoes until so many of the history's commands are in force, or there are no more.
    void walk(std::size_t position, Progress& progress);
    void undo(Progress& progress);  ///< nothing when there is nothing to undo
    void redo(Progress& progress);
    /// Edits, undos and redos so far. Waits for one that goes on.
    std::uint64_t edits() const;
    /// edits(), while the points are those of the file at path(); else nothing.
    std::optional<std::uint64_t> editsInFile() const;
    /// Sentences for the user that came up meanwhile: that edits are not noted down, that undo takes memory. Each
    /// comes once.
    std::vector<std::string> takeWarnings();

    // -- saving

    /// Throws Error when saving there would lose something: the file is damaged, and its rest would be gone.
    void checkTarget(const std::filesystem::path& target) const;
    /// Of each file, whether the points differ from what it holds: as the history says, or where it cannot, by
    /// reading the file.
    PointIndex shownPoints() const;
    std::vector<bool> changedParts(Progress& progress) const;
    /// Compares the cloud with path(), as saving it to `target` would write it, point by point. Of a survey: the
    /// files that changed.
    Forecast foresee(const std::filesystem::path& target, Progress& progress) const;
    /// In one line, what saving to path() would change; quick, as the history says. Empty when nothing.
    std::string unsavedChanges(Progress& progress) const;
    /// Writes and verifies the file, whole or not at all, and marks the state as saved. Of a survey, all files or
    /// none, and nothing counts as saved where files that changed are left out. Throws las::WriteQuestion where the
    /// user must say more.
    SaveOutcome save(SaveRequest request, Progress& progress);
    /// Writes a survey into one file, which becomes none of its files; nothing counts as saved.
    las::WriteReport merge(const std::filesystem::path& target, las::WriteOptions options,
                           Progress& progress) const;
    /// Writes these points alone to another file than path(); nothing counts as saved. All points that are not
    /// among them would be lost otherwise.
    las::WriteReport extract(const PointSet& points, const std::filesystem::path& target, las::WriteOptions options,
                             Progress& progress) const;

    // -- recovering

    /// The journal of before a crash that is about these points. Nothing: there is none that can be followed, or
    /// points were edited already.
    std::optional<FoundJournal> findJournal(Progress& progress) const;
    /// Does again what a journal tells, and goes on with it, unless it could not be followed to its end. Throws
    /// Error when points were edited first.
    Replayed recover(const FoundJournal& journal, Progress& progress);
    /// It is not found again, and kept for whoever wants to follow it; nothing happens where an edit was quicker.
    void setAside(const std::filesystem::path& journal);

private:
    Session(std::unique_ptr<Survey> survey, HistoryRoom room);
    std::optional<EditOutcome> doIt(std::unique_ptr<Command> command, std::optional<std::uint64_t> edits,
                                    Progress& progress);
    std::vector<std::filesystem::path> targetsOf(const SaveRequest& request) const;
    SaveOutcome saveParts(SaveRequest request, Progress& progress);
    Forecast foreseeParts(std::span<const std::size_t> parts, std::span<const std::filesystem::path> targets,
                          Progress& progress) const;
    las::KnownPlan known(std::shared_ptr<const las::WritePlan> plan, std::uint64_t edits) const;
    las::KnownPlan keptPlan() const;
    void keepPlan(const las::SavePreview& preview, std::uint64_t edits) const;
    CloudKey fileKey(Progress& progress) const;
    std::shared_ptr<const KeptPoints> keptPoints() const;
    std::filesystem::path journalPath(const CloudKey& key) const;
    void noteDown(Progress& progress) noexcept;
    void dropJournal() noexcept;
    void goOn(const std::filesystem::path& journal, const CloudKey& key);
    void warn(const std::string& sentence);

    std::filesystem::path m_opened;
    std::unique_ptr<Survey> m_survey;
    std::shared_ptr<ReadingOrder> m_order = std::make_shared<ReadingOrder>();
    std::shared_ptr<PointCloud> m_cloud;
    std::filesystem::path m_folder;  ///< of journals; empty: none are kept
    std::unique_ptr<History> m_history;
    std::atomic<bool> m_damaged = false;
    std::vector<bool> m_damagedParts;  ///< complete once the points are read; guarded by m_mutex till then
    /// Held while the history moves, and while "saved" is noted down: a save never marks an edit that it missed.
    mutable std::mutex m_gate;
    std::atomic<std::uint64_t> m_edits = 0;  ///< counted with m_gate held, before anything changes
    bool m_unnotedTold = false;              ///< that edits are not noted down; guarded by m_gate
    mutable std::mutex m_mutex;              ///< guards m_damagedParts, and what follows
    std::filesystem::path m_path;            ///< path()
    /// How path() would be written, found out when it was last looked at, and after how many edits.
    mutable std::shared_ptr<const las::WritePlan> m_plan;
    mutable std::uint64_t m_planEdits = 0;
    std::vector<std::string> m_warnings;
};

}  // namespace punctum
