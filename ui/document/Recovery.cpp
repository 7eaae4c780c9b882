// SPDX-License-Identifier: MIT
#include "ui/document/Recovery.h"

#include "core/edit/Journal.h"
#include "core/session/Session.h"
#include "ui/basic/Text.h"
#include "ui/document/Document.h"
#include "ui/document/Workspace.h"

#include <algorithm>

namespace punctum::ui
{

QString editsText(const std::vector<std::string>& names)
{
    constexpr std::size_t kMost = 4;
    QStringList parts;
    for (std::size_t k = 0; k < std::min(kMost, names.size()); ++k) parts << toQString(names[k]);
    const QString list = parts.join(QStringLiteral(", "));
    return names.size() > kMost ? Recovery::tr("%1 and %2 more").arg(list, countText(names.size() - kMost)) : list;
}

namespace
{

QStringList filesOf(const Document& document)
{
    QStringList files;
    for (const Document::Part& part : document.parts()) files << part.path;
    return files;
}

}  // namespace

Recovery::Recovery(Workspace& workspace, std::filesystem::path folder)
    : m_workspace(workspace), m_folder(std::move(folder))
{
    connect(&workspace, &Workspace::documentLoaded, this, [this](Document* document) {
        if (const auto wanted = m_wanted.extract(filesOf(*document))) recoverFrom(*document, wanted.mapped());
    });
    connect(&workspace, &Workspace::jobEnded, this, [this] {
        if (!m_workspace.opening()) m_wanted.clear();  // the file could not be opened, which was said
    });
}

void Recovery::look(Document& document)
{
    if (m_folder.empty() || document.recovered()) return;
    const auto found = std::make_shared<std::optional<FoundJournal>>();
    m_workspace.startJob(
        tr("Look for unsaved edits of %1").arg(document.name()),
        [session = document.session(), found](Progress& progress) { *found = session->findJournal(progress); },
        [this, found, target = QPointer<Document>(&document)](const JobInfo& info) {
            if (info.state == JobState::Failed) m_workspace.say(MessageKind::Warning, toQString(info.error));
            if (target && *found) offer(*target, std::make_shared<const FoundJournal>(std::move(**found)));
        },
        true, JobTurn::Idle);
}

void Recovery::offer(Document& document, const std::shared_ptr<const FoundJournal>& journal)
{
    const auto names = journal->contents.inForce();
    const std::string& damage = journal->contents.damage;
    if (!ask || (names.empty() && damage.empty())) return;
    QString reason =
        names.size() == 1
            ? tr("The program ended before this edit of %1 was saved: %2.").arg(document.name(), editsText(names))
            : tr("The program ended before %1 edits of %2 were saved: %3.")
                  .arg(countText(names.size()), document.name(), editsText(names));
    if (!damage.empty()) reason += QLatin1Char(' ') + toQString(damage);
    reason +=
        QLatin1Char(' ') +
        tr("Recover does it again, and can be undone. Later asks you when the file is opened next. Set aside, you "
           "are not asked again, and File > Recover Edits has them.");
    ask({tr("Recover unsaved edits?"), reason, tr("&Recover"), tr("&Later"), true},
        [this, target = QPointer<Document>(&document), journal](RecoveryAnswer answer) {
            if (!target || answer == RecoveryAnswer::Later) return;
            if (answer == RecoveryAnswer::Recover) return recover(*target, journal);
            m_workspace.startJob(
                tr("Set the journal aside"),
                [session = target->session(), journal](Progress&) { session->setAside(journal->path); },
                [this](const JobInfo& info) {
                    if (info.state == JobState::Failed) m_workspace.say(MessageKind::Error, toQString(info.error));
                },
                true);
        });
}

void Recovery::recover(Document& document, const std::shared_ptr<const FoundJournal>& journal)
{
    const auto replayed = std::make_shared<Replayed>();
    m_workspace.startJob(
        tr("Recover edits of %1").arg(document.name()),
        [session = document.session(), journal, replayed](Progress& progress) {
            *replayed = session->recover(*journal, progress);
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
                m_workspace.say(MessageKind::Info,
                                tr("The unsaved edits of %1 are back: %2.")
                                    .arg(target->name(), editsText(journal->contents.inForce())),
                                {}, target);
        });
}

// -- those that can be had back

void Recovery::listKept(std::function<void(std::vector<KeptJournal>)> found)
{
    const auto list = std::make_shared<std::vector<KeptJournal>>();
    m_workspace.startJob(
        tr("Look for unsaved edits"),
        [folder = m_folder, list](Progress& progress) { *list = keptJournals(folder, progress); },
        [list, found = std::move(found)](const JobInfo&) { found(std::move(*list)); }, true);
}

void Recovery::recoverKept(const KeptJournal& kept)
{
    if (kept.files.empty()) return;
    QStringList files;
    for (const std::filesystem::path& file : kept.files) files << toQString(file);
    for (Document* document : m_workspace.documents())
        if (filesOf(*document) == files && !document->loading()) {
            m_workspace.setActive(document);
            return recoverFrom(*document, kept.path);
        }
    m_wanted[files] = kept.path;
    m_workspace.open(files);
}

void Recovery::recoverFrom(Document& document, const std::filesystem::path& path)
{
    const auto journal = std::make_shared<FoundJournal>();
    m_workspace.startJob(
        tr("Read the journal"),
        [path, journal](Progress&) {
            *journal = {path, readJournal(path)};
        },
        [this, journal, target = QPointer<Document>(&document)](const JobInfo& info) {
            if (info.state == JobState::Failed) m_workspace.say(MessageKind::Error, toQString(info.error));
            if (info.state == JobState::Finished && target) recover(*target, journal);
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
