// SPDX-License-Identifier: MIT
#include "core/session/Session.h"

#include "core/Error.h"
#include "core/edit/CloudKey.h"
#include "core/edit/Command.h"
#include "core/edit/Extract.h"
#include "core/edit/Journal.h"
#include "core/las/SourceFile.h"
#include "core/session/KeptJournals.h"
#include "core/session/SurveyFiles.h"
#include "core/steps/MakeCommand.h"
#include "core/task/Progress.h"

#include <algorithm>
#include <shared_mutex>
#include <system_error>
#include <utility>

namespace punctum
{

namespace fs = std::filesystem;

namespace
{

std::vector<std::string> attributeNames(const PointCloud& cloud)
{
    const std::shared_lock lock(cloud.mutex());
    std::vector<std::string> names;
    for (const Attribute& attribute : cloud.attributes()) names.push_back(attribute.name);
    return names;
}

/// Whether the folder has a journal of a cloud with so many points: only then it is worth reading them all.
bool mayHaveJournal(const fs::path& folder, PointIndex points)
{
    const std::string beginning = std::to_string(points) + "-";
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error)) {
        const std::string name = entry.path().filename().string();
        if (name.starts_with(beginning) && name.ends_with(kJournalEnding)) return true;
    }
    return false;
}

bool sameFile(const fs::path& a, const fs::path& b)
{
    std::error_code ignored;
    return a == b || fs::equivalent(a, b, ignored);
}

/// For a look ahead: it shows an upgrade, whoever has to be asked for it.
las::WriteOptions lookAhead(const fs::path& target)
{
    las::WriteOptions options;
    options.upgrade = true;
    options.compressed = las::isCompressedName(target);
    return options;
}

}  // namespace

std::shared_ptr<Session> Session::open(const fs::path& file, HistoryRoom room)
{
    Progress progress;
    return open(std::vector{file}, std::move(room), progress);
}

std::shared_ptr<Session> Session::open(const std::vector<fs::path>& files, HistoryRoom room, Progress& progress)
{
    return std::shared_ptr<Session>(new Session(Survey::open(files, progress), std::move(room)));
}

Session::Session(std::unique_ptr<Survey> survey, HistoryRoom room)
    : m_survey(std::move(survey)),
      m_cloud(m_survey->cloud()),
      m_folder(room.folder),
      m_history(std::make_unique<History>(m_cloud, std::move(room)))
{
    std::vector<fs::path> files;
    for (const Survey::Part& part : m_survey->parts()) {
        files.push_back(part.path);
        m_damagedParts.push_back(part.source->recovered);
        if (part.source->recovered) m_damaged = true;
    }
    m_opened = many() ? commonFolder(files) : files.front();
    m_path = m_opened;
}

Session::~Session() = default;

las::ReadResult Session::read(Progress& progress, const las::Reader::BatchSink& sink,
                              const las::Reader::BatchSink& ahead)
{
    las::ReadResult result = m_survey->read(progress, sink, {.sink = ahead}, m_order.get());
    const std::lock_guard lock(m_mutex);  // who shows the files asks while they are read
    for (const PointRange& gone : result.missing)
        if (!gone.empty()) m_damagedParts[m_survey->partOf(gone.first)] = true;
    if (!result.missing.empty()) m_damaged = true;
    return result;
}

std::vector<SessionPart> Session::parts() const
{
    std::vector<SessionPart> parts;
    const std::lock_guard lock(m_mutex);
    for (const Survey::Part& part : m_survey->parts())
        parts.push_back({part.source->current->get().path, part.points, part.source, m_damagedParts[parts.size()]});
    return parts;
}

void Session::close() noexcept
{
    const std::lock_guard gate(m_gate);
    dropJournal();
}

fs::path Session::path() const
{
    const std::lock_guard lock(m_mutex);
    return m_path;
}

// -- editing

EditOutcome Session::edit(const Recipe& recipe, Progress& progress)
{
    return *doIt(makeCommand(recipe, *m_cloud, progress), std::nullopt, progress);
}

MadeEdit Session::make(const Recipe& recipe, Progress& progress) const
{
    MadeEdit made;
    made.edits = edits();
    made.command = makeCommand(recipe, *m_cloud, progress);
    return made;
}

std::optional<EditOutcome> Session::apply(MadeEdit made, Progress& progress)
{
    return doIt(std::move(made.command), made.edits, progress);
}

/// But for deleted ones.
PointIndex Session::shownPoints() const
{
    const auto deleted = deletedPoints(*m_cloud);
    return m_cloud->size() - (deleted ? deleted->count() : 0);
}

/// `edits`: how many there may have been; nothing: any number.
std::optional<EditOutcome> Session::doIt(std::unique_ptr<Command> command, std::optional<std::uint64_t> edits,
                                         Progress& progress)
{
    EditOutcome outcome;
    if (!command) return outcome;
    const auto before = attributeNames(*m_cloud);
    progress.check();
    outcome.changed = command->changedPoints();
    if (!command->points()) outcome.changed = std::min(outcome.changed, shownPoints());  // all that there are
    outcome.finding = command->finding();
    progress.begin("Changing points", 1);
    {
        const std::lock_guard gate(m_gate);
        if (edits && *edits != m_edits) return std::nullopt;
        noteDown(progress);
        progress.check();
        ++m_edits;
        m_history->push(std::move(command));
    }
    for (std::string& name : attributeNames(*m_cloud))
        if (std::find(before.begin(), before.end(), name) == before.end())
            outcome.newAttributes.push_back(std::move(name));
    return outcome;
}

void Session::walk(std::size_t position, Progress& progress)
{
    progress.begin("Changing points", 1);
    const std::lock_guard gate(m_gate);
    while (m_history->position() != position) {
        progress.check();
        const bool forward = m_history->position() < position;
        if (forward ? !m_history->canRedo() : !m_history->canUndo()) break;  // others have been here meanwhile
        noteDown(progress);
        ++m_edits;
        forward ? m_history->redo() : m_history->undo();
    }
}

void Session::undo(Progress& progress)
{
    if (const std::size_t position = m_history->position(); position > 0) walk(position - 1, progress);
}

void Session::redo(Progress& progress)
{
    walk(m_history->position() + 1, progress);
}

std::uint64_t Session::edits() const
{
    const std::lock_guard gate(m_gate);
    return m_edits.load();
}

std::optional<std::uint64_t> Session::editsInFile() const
{
    const std::lock_guard gate(m_gate);
    return m_history->modified() ? std::nullopt : std::optional(m_edits.load());
}

void Session::warn(const std::string& sentence)
{
    const std::lock_guard lock(m_mutex);
    m_warnings.push_back(sentence);
}

std::vector<std::string> Session::takeWarnings()
{
    std::vector<std::string> warnings;
    {
        const std::lock_guard lock(m_mutex);
        warnings.swap(m_warnings);
    }
    if (std::string warning = m_history->takeWarning(); !warning.empty()) warnings.push_back(std::move(warning));
    return warnings;
}

// -- the journal (docs/dev/journal.md)

fs::path Session::journalPath(const CloudKey& key) const
{
    return m_folder / (key.text() + kJournalEnding);
}

/// The cloud is about to change, with the gate held: begins the journal where there is none. What keeps it from
/// that is told once, and never stops the edit.
void Session::noteDown(Progress& progress) noexcept
{
    if (m_folder.empty()) return;
    const auto tell = [&](const std::string& reason) {
        if (!std::exchange(m_unnotedTold, true)) warn("A crash would lose the edits from here on: " + reason);
    };
    try {
        if (const auto journal = m_history->journal()) {
            const std::string failure = journal->failure();
            if (failure.empty())
                m_unnotedTold = false;
            else
                tell(failure);
            return;
        }
        if (m_history->modified())
            return tell("edits came before, and a journal begins with what is in the file. Save once.");
        const CloudKey key = fileKey(progress);
        std::vector<fs::path> files;
        for (const SessionPart& part : parts()) files.push_back(part.path);  // as they were last saved
        std::shared_ptr<Journal> journal =
            Journal::create(journalPath(key), key, journalFiles(files), keptPoints());
        if (!journal->setAside().empty())
            warn("Unsaved edits of before a crash have not been recovered; File > Recover Edits has them.");
        m_history->setJournal(std::move(journal));
        m_unnotedTold = false;
    } catch (const std::exception& e) {  // cancelled as well: the edit will be, too
        if (!progress.cancelled()) tell(e.what());
    }
}

void Session::dropJournal() noexcept
{
    if (const auto journal = m_history->journal()) journal->remove();
    m_history->setJournal(nullptr);
}

std::optional<FoundJournal> Session::findJournal(Progress& progress) const
{
    if (m_folder.empty() || m_damaged || !mayHaveJournal(m_folder, m_cloud->size())) return {};
    const std::lock_guard gate(m_gate);
    if (m_history->position() != 0) return {};  // somebody was quicker
    const fs::path path = journalPath(keyOf(*m_cloud, progress));
    if (!fs::exists(path) || isJournalInUse(path) || !journalHasEdits(path)) return {};
    return FoundJournal{path, readJournal(path)};
}

Replayed Session::recover(const FoundJournal& journal, Progress& progress)
{
    const std::lock_guard gate(m_gate);
    if (m_history->position() != 0)
        throw Error(
            "The points were edited first, so that the edits of before the crash cannot be done again now. Undo "
            "what "
            "was edited; then File > Recover Edits does them.");
    ++m_edits;
    Replayed replayed = replay(journal.contents, *m_cloud, *m_history, progress);
    // what could not be followed stays in the file, for punctum replay
    if (replayed.stopped.empty() && !m_folder.empty()) goOn(journal.path, journal.contents.key);
    return replayed;
}

/// A journal that has been followed becomes the one that is kept on.
void Session::goOn(const fs::path& journal, const CloudKey& key)
{
    if (m_history->journal()) {  // an edit began one meanwhile, and was undone: it has noted all down
        fs::remove(journal);
        return;
    }
    const fs::path place = journalPath(key);
    if (journal != place) {
        if (fs::exists(place)) setJournalAside(place);
        fs::rename(journal, place);
    }
    m_history->setJournal(Journal::resume(place));
}

void Session::setAside(const fs::path& journal)
{
    const std::lock_guard gate(m_gate);
    // an edit that came first has set it aside already, and writes another one there
    if (fs::exists(journal) && !isJournalInUse(journal)) setJournalAside(journal);
}

// -- saving

void Session::checkTarget(const fs::path& target) const
{
    if (!m_damaged) return;
    for (std::size_t k = 0; k < m_damagedParts.size(); ++k) {
        const fs::path& opened = m_survey->parts()[k].path;
        if (m_damagedParts[k] && sameFile(target, opened))
            throw Error(opened,
                        "Some of this file could not be read; write under another name, so that the original is "
                        "kept.");
    }
}

Forecast Session::foresee(const fs::path& target, Progress& progress) const
{
    if (many()) {
        const SaveRequest request{.target = target};
        const std::vector<fs::path> targets = targetsOf(request);
        return foreseeParts(changedNumbers(changedParts(progress)), targets, progress);
    }
    Forecast forecast;
    forecast.edits = edits();
    forecast.preview = las::previewSave(*m_cloud, path(), target, lookAhead(target), progress, nullptr, keptPlan());
    keepPlan(forecast.preview, forecast.edits);
    return forecast;
}

/// A plan of when there had been so many edits holds as long as there are no more: each is counted before it
/// changes anything.
las::KnownPlan Session::known(std::shared_ptr<const las::WritePlan> plan, std::uint64_t edits) const
{
    return {std::move(plan), [this, edits] { return m_edits == edits; }};
}

las::KnownPlan Session::keptPlan() const
{
    const std::lock_guard lock(m_mutex);
    return known(m_plan, m_planEdits);
}

void Session::keepPlan(const las::SavePreview& preview, std::uint64_t edits) const
{
    const std::lock_guard lock(m_mutex);
    m_plan = preview.plan;
    m_planEdits = edits;
}

std::string Session::unsavedChanges(Progress& progress) const
{
    const std::uint64_t now = edits();
    const auto changes = m_history->changes(progress);
    if (many()) return unsavedInSurvey(changes, changedParts(progress));
    const fs::path original = path();
    const las::SavePreview preview = las::previewSave(*m_cloud, original, original, lookAhead(original), progress,
                                                      changes ? &*changes : nullptr, keptPlan());
    keepPlan(preview, now);
    return las::summary(preview.difference);
}

SaveOutcome Session::save(SaveRequest request, Progress& progress)
{
    if (many()) return saveParts(std::move(request), progress);
    checkTarget(request.target);
    const std::uint64_t before = edits();
    std::optional<Forecast> forecast = std::move(request.forecast);
    if (request.compare && (!forecast || forecast->edits != before)) {
        try {
            forecast = foresee(request.target, progress);
        } catch (const Error&) {
            forecast.reset();  // what cannot be written either is told by write()
        }
    }
    SaveOutcome outcome;
    request.options.compressed = las::isCompressedName(request.target);
    outcome.report = las::write(*m_cloud, request.target, request.options, progress,
                                forecast ? known(forecast->preview.plan, forecast->edits) : keptPlan());
    const std::lock_guard gate(m_gate);
    outcome.disturbed = m_edits != before;
    if (outcome.disturbed)
        m_history->forgetSaved();
    else
        m_history->markSaved();
    dropJournal();
    m_unnotedTold = outcome.disturbed;  // whoever saves tells it
    outcome.compared = request.compare && !outcome.disturbed && forecast && forecast->edits == before;
    if (outcome.compared) outcome.preview = std::move(forecast->preview);
    const std::lock_guard lock(m_mutex);
    m_path = request.target;
    m_plan.reset();
    return outcome;
}

las::WriteReport Session::extract(const PointSet& points, const fs::path& target, las::WriteOptions options,
                                  Progress& progress) const
{
    for (const SessionPart& part : parts())
        if (sameFile(target, part.path) || (!many() && sameFile(target, m_opened)))
            throw Error(
                target,
                "this is a file that is open; points that are left out would be lost. Choose another name.");
    options.compressed = las::isCompressedName(target);
    options.copyChunks = false;
    las::WriteReport report = las::write(*extracted(*m_cloud, points, progress), target, options, progress);
    if (many()) addOneFileNotes(parts(), report.notes);
    return report;
}

}  // namespace punctum
