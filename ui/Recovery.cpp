// SPDX-License-Identifier: MIT
#include "ui/Recovery.h"

#include "core/Error.h"
#include "core/edit/History.h"
#include "core/process/Replay.h"
#include "core/task/Progress.h"
#include "ui/Document.h"
#include "ui/Text.h"
#include "ui/Workspace.h"

#include <algorithm>

namespace punctum::ui
{

namespace
{

constexpr const char* kEnding = ".journal";

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
            warn(tr("Unsaved edits of before a crash have not been recovered; punctum replay can do them again "
                    "from %1.")
                     .arg(toQString(journal->setAside())));
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
        true);
}

void Recovery::offer(Document& document, const std::filesystem::path& path,
                     std::shared_ptr<JournalContents> journal)
{
    const auto names = journal->inForce();
    if (!ask || (names.empty() && journal->damage.empty())) return;
    QString reason =
        names.size() == 1
            ? tr("The program ended before this edit of %1 was saved: %2.").arg(document.name(), listed(names))
            : tr("The program ended before %1 edits of %2 were saved: %3.")
                  .arg(countText(names.size()), document.name(), listed(names));
    if (!journal->damage.empty()) reason += QLatin1Char(' ') + toQString(journal->damage);
    reason += QLatin1Char(' ') + tr("Recover does it again, and can be undone. Set aside, the journal is kept for "
                                    "punctum replay, and you are not asked again.");
    ask({tr("Recover unsaved edits?"), reason, tr("&Recover"), tr("&Set Aside"), true},
        [this, target = QPointer<Document>(&document), path, journal](bool wanted) {
            if (!target) return;
            if (wanted) return recover(*target, path, journal);
            m_workspace.startJob(
                tr("Set the journal aside"),
                [data = target->data(), path](Progress&) {
                    const std::lock_guard gate(data->editGate);
                    // an edit that came first has set it aside already, and writes another one there
                    if (std::filesystem::exists(path) && !isJournalInUse(path)) setJournalAside(path);
                },
                {}, true);
        });
}

void Recovery::recover(Document& document, const std::filesystem::path& path,
                       const std::shared_ptr<const JournalContents>& journal)
{
    const auto replayed = std::make_shared<Replayed>();
    m_workspace.startJob(
        tr("Recover edits of %1").arg(document.name()),
        [data = document.data(), path, journal, replayed](Progress& progress) {
            const std::lock_guard gate(data->editGate);
            if (data->history->position() != 0)
                throw Error(
                    "The points were edited first, so that the edits of before the crash cannot be done again "
                    "here; their journal has been set aside for punctum replay.");
            ++data->edits;
            *replayed = replay(*journal, *data->cloud, *data->history, progress);
            // what could not be followed stays in the file, for punctum replay; a journal that an edit began
            // meanwhile, and that was undone, has noted all down
            if (replayed->stopped.empty() && !data->history->journal())
                data->history->setJournal(Journal::resume(path));
        },
        [this, journal, replayed, target = QPointer<Document>(&document)](const JobInfo& info) {
            if (info.state == JobState::Failed) m_workspace.say(MessageKind::Error, toQString(info.error));
            if (!target) return;
            m_workspace.edited(*target);
            if (info.state != JobState::Finished) return;
            if (!replayed->stopped.empty())
                m_workspace.say(MessageKind::Warning,
                                tr("Not all edits could be recovered: %1").arg(toQString(replayed->stopped)));
            else
                m_workspace.say(
                    MessageKind::Info,
                    tr("The unsaved edits of %1 are back: %2.").arg(target->name(), listed(journal->inForce())));
        });
}

}  // namespace punctum::ui
