// SPDX-License-Identifier: MIT
#include "ui/Recovery.h"

#include "core/Error.h"
#include "core/edit/History.h"
#include "core/process/Replay.h"
#include "core/task/Progress.h"
#include "ui/Document.h"
#include "ui/Text.h"
#include "ui/Workspace.h"

#include <QFileInfo>

#include <algorithm>

namespace punctum::ui
{

namespace
{

constexpr const char* kEnding = ".journal";
constexpr const char* kAsideEnding = ".declined";

/// Whether the folder has a journal of a cloud with so many points: only then it is worth reading them all.
bool mayHaveJournal(const std::filesystem::path& folder, PointIndex points)
{
    const std::string beginning = std::to_string(points) + "-";
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
        const std::string name = entry.path().filename().string();
        if (name.starts_with(beginning) && name.ends_with(kEnding)) return true;
    }
    return false;
}

/// "Set Classification = 2, Reclassify to 6 Building and 3 more".
QString listed(const std::vector<std::string>& names)
{
    constexpr std::size_t kMost = 4;
    QStringList parts;
    for (std::size_t k = 0; k < std::min(kMost, names.size()); ++k) parts << toQString(names[k]);
    const QString list = parts.join(QStringLiteral(", "));
    return names.size() > kMost ? Recovery::tr("%1 and %2 more").arg(list, countText(names.size() - kMost)) : list;
}

}  // namespace

Recovery::Recovery(Workspace& workspace, std::filesystem::path folder)
    : m_workspace(workspace), m_folder(std::move(folder))
{
    connect(&workspace, &Workspace::documentLoaded, this, [this](Document* document) {
        if (const auto wanted = m_wanted.extract(document->path())) recoverFrom(*document, wanted.mapped());
    });
    connect(&workspace, &Workspace::jobEnded, this, [this] {
        if (!m_workspace.opening()) m_wanted.clear();  // the file could not be opened, which was said
    });
}

std::filesystem::path Recovery::pathOf(const CloudKey& key) const
{
    return m_folder / (key.text() + kEnding);
}

void Recovery::warn(const QString& sentence)
{
    QMetaObject::invokeMethod(
        this, [this, sentence] { m_workspace.say(MessageKind::Warning, sentence); }, Qt::QueuedConnection);
}

void Recovery::noteDown(OpenCloud& data, Progress& progress) noexcept
{
    if (m_folder.empty()) return;
    const auto tell = [&](const std::string& reason) {
        if (std::exchange(data.journalTold, true)) return;
        warn(tr("A crash would lose the edits from here on: %1").arg(toQString(reason)));
    };
    try {
        if (const auto journal = data.history->journal()) {
            const std::string failure = journal->failure();
            if (failure.empty())
                data.journalTold = false;
            else
                tell(failure);
            return;
        }
        if (data.history->modified())
            return tell("edits came before, and a journal begins with what is in the file. Save once.");
        const CloudKey key = keyOfFile(*data.cloud, progress);
        std::shared_ptr<Journal> journal =
            Journal::create(pathOf(key), key, data.path.string(), data.source->current->get().kept);
        if (!journal->setAside().empty())
            warn(tr("Unsaved edits of before a crash have not been recovered; File > Recover Edits has them."));
        data.history->setJournal(std::move(journal));
        data.journalTold = false;
    } catch (const std::exception& e) {  // cancelled as well: the edit will be, too
        if (!progress.cancelled()) tell(e.what());
    }
}

void Recovery::dropJournal(OpenCloud& data) noexcept
{
    if (const auto journal = data.history->journal()) journal->remove();
    data.history->setJournal(nullptr);
}

void Recovery::look(Document& document)
{
    if (m_folder.empty() || document.recovered()) return;
    struct Found {
        std::filesystem::path path;
        std::shared_ptr<JournalContents> journal;
    };
    const auto found = std::make_shared<Found>();
    m_workspace.startJob(
        tr("Look for unsaved edits of %1").arg(document.name()),
        [this, data = document.data(), found](Progress& progress) {
            if (!mayHaveJournal(m_folder, data->cloud->size())) return;
            const std::lock_guard gate(data->editGate);
            if (data->history->position() != 0) return;  // somebody was quicker
            const auto path = pathOf(keyOf(*data->cloud, progress));
            if (!std::filesystem::exists(path) || isJournalInUse(path)) return;
            found->journal = std::make_shared<JournalContents>(readJournal(path));
            found->path = path;
        },
        [this, found, target = QPointer<Document>(&document)](const JobInfo& info) {
            if (info.state == JobState::Failed) m_workspace.say(MessageKind::Warning, toQString(info.error));
            if (target && found->journal) offer(*target, found->path, found->journal);
        },
        true, JobTurn::Idle);
}

void Recovery::offer(Document& document, const std::filesystem::path& path,
                     const std::shared_ptr<JournalContents>& journal)
{
    const auto names = journal->inForce();
    if (!ask || (names.empty() && journal->damage.empty())) return;
    QString reason =
        names.size() == 1
            ? tr("The program ended before this edit of %1 was saved: %2.").arg(document.name(), listed(names))
            : tr("The program ended before %1 edits of %2 were saved: %3.")
                  .arg(countText(names.size()), document.name(), listed(names));
    if (!journal->damage.empty()) reason += QLatin1Char(' ') + toQString(journal->damage);
    reason +=
        QLatin1Char(' ') +
        tr("Recover does it again, and can be undone. Later asks you when the file is opened next. Set aside, you "
           "are not asked again, and File > Recover Edits has them.");
    ask({tr("Recover unsaved edits?"), reason, tr("&Recover"), tr("&Later"), true},
        [this, target = QPointer<Document>(&document), path, journal](RecoveryAnswer answer) {
            if (!target || answer == RecoveryAnswer::Later) return;
            if (answer == RecoveryAnswer::Recover) return recover(*target, path, journal);
            m_workspace.startJob(
                tr("Set the journal aside"),
                [data = target->data(), path](Progress&) {
                    const std::lock_guard gate(data->editGate);
                    // an edit that came first has set it aside already, and writes another one there
                    if (std::filesystem::exists(path) && !isJournalInUse(path)) setJournalAside(path);
                },
                [this](const JobInfo& info) {
                    if (info.state == JobState::Failed) m_workspace.say(MessageKind::Error, toQString(info.error));
                },
                true);
        });
}

void Recovery::recover(Document& document, const std::filesystem::path& path,
                       const std::shared_ptr<const JournalContents>& journal)
{
    const auto replayed = std::make_shared<Replayed>();
    m_workspace.startJob(
        tr("Recover edits of %1").arg(document.name()),
        [this, data = document.data(), path, journal, replayed](Progress& progress) {
            const std::lock_guard gate(data->editGate);
            if (data->history->position() != 0)
                throw Error(
                    "The points were edited first, so that the edits of before the crash cannot be done again now. "
                    "Undo what was edited; then File > Recover Edits does them.");
            ++data->edits;
            *replayed = replay(*journal, *data->cloud, *data->history, progress);
            // what could not be followed stays in the file, for punctum replay; a journal that an edit began
            // meanwhile, and that was undone, has noted all down
            if (replayed->stopped.empty()) goOn(*data, path, journal->key);
        },
        [this, journal, replayed, target = QPointer<Document>(&document)](const JobInfo& info) {
            if (info.state == JobState::Failed) m_workspace.say(MessageKind::Error, toQString(info.error));
            if (!target) return;
            m_workspace.edited(*target);
            if (info.state != JobState::Finished) return;
            if (!replayed->stopped.empty())
                m_workspace.say(MessageKind::Warning,
                                tr("Not all edits could be recovered: %1").arg(toQString(replayed->stopped)), {},
                                target);
            else
                m_workspace.say(
                    MessageKind::Info,
                    tr("The unsaved edits of %1 are back: %2.").arg(target->name(), listed(journal->inForce())), {},
                    target);
        });
}

void Recovery::goOn(OpenCloud& data, const std::filesystem::path& path, const CloudKey& key) const
{
    if (data.history->journal()) {  // has noted all down
        std::filesystem::remove(path);
        return;
    }
    const std::filesystem::path place = pathOf(key);
    if (path != place) {
        if (std::filesystem::exists(place)) setJournalAside(place);
        std::filesystem::rename(path, place);
    }
    data.history->setJournal(Journal::resume(place));
}

// -- those that can be had back

void Recovery::listKept(std::function<void(std::vector<KeptJournal>)> found)
{
    const auto list = std::make_shared<std::vector<KeptJournal>>();
    m_workspace.startJob(
        tr("Look for unsaved edits"),
        [folder = m_folder, list](Progress& progress) {
            std::error_code error;
            for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
                progress.check();
                const std::string name = entry.path().filename().string();
                const bool aside = name.ends_with(kAsideEnding);
                if ((!aside && !name.ends_with(kEnding)) || isJournalInUse(entry.path())) continue;
                try {
                    const JournalContents journal = readJournal(entry.path());
                    const auto names = journal.inForce();
                    if (names.empty()) continue;
                    list->push_back({entry.path(), toQString(std::filesystem::path(journal.file)), listed(names),
                                     QFileInfo(toQString(entry.path())).lastModified(), aside});
                } catch (const Error&) {
                    continue;  // no journal, or not even its beginning can be read
                }
            }
            std::sort(list->begin(), list->end(),
                      [](const KeptJournal& a, const KeptJournal& b) { return a.changed > b.changed; });
        },
        [list, found = std::move(found)](const JobInfo&) { found(std::move(*list)); }, true);
}

void Recovery::recoverKept(const KeptJournal& kept)
{
    for (Document* document : m_workspace.documents())
        if (document->path() == kept.file && !document->loading()) {
            m_workspace.setActive(document);
            return recoverFrom(*document, kept.path);
        }
    m_wanted[kept.file] = kept.path;
    m_workspace.open(kept.file);
}

void Recovery::recoverFrom(Document& document, const std::filesystem::path& path)
{
    const auto journal = std::make_shared<JournalContents>();
    m_workspace.startJob(
        tr("Read the journal"), [path, journal](Progress&) { *journal = readJournal(path); },
        [this, journal, path, target = QPointer<Document>(&document)](const JobInfo& info) {
            if (info.state == JobState::Failed) m_workspace.say(MessageKind::Error, toQString(info.error));
            if (info.state == JobState::Finished && target) recover(*target, path, journal);
        },
        true);
}

void Recovery::removeKept(const std::filesystem::path& path, std::function<void()> done)
{
    m_workspace.startJob(
        tr("Delete unsaved edits"), [path](Progress&) { std::filesystem::remove(path); },
        [this, done = std::move(done)](const JobInfo& info) {
            if (info.state == JobState::Failed) m_workspace.say(MessageKind::Error, toQString(info.error));
            done();
        },
        true);
}

}  // namespace punctum::ui
