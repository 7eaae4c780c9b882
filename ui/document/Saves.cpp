// SPDX-License-Identifier: MIT
#include "ui/document/Saves.h"

#include "core/Error.h"
#include "core/task/Progress.h"
#include "ui/basic/Text.h"
#include "ui/document/SavingText.h"

#include <QDir>

#include <filesystem>
#include <mutex>
#include <optional>
#include <utility>

namespace punctum::ui
{

Saves::Saves(Workspace& workspace) : m_workspace(workspace) {}

/// One save, until it is done or given up.
struct Saves::Saving {
    QPointer<Document> document;  ///< null once it is closed
    std::shared_ptr<Session> session;
    std::filesystem::path original;
    std::filesystem::path target;    ///< of a survey: the folder
    bool inPlace = false;            ///< of a survey: each file where it is
    std::vector<std::size_t> parts;  ///< of a survey: these alone; empty: those that changed, or all
    QString name;                    ///< for jobs and messages
    std::optional<Forecast> forecast;
    las::WriteOptions options;
    std::function<void(bool)> ended;
    SaveOutcome outcome;
    std::optional<las::WriteQuestion> question;  ///< why it stopped, where the user can decide
};

/// Null: it cannot be, which was said.
std::shared_ptr<Saves::Saving> Saves::begin(Document& document, const QString& path,
                                            std::function<void(bool)> ended)
{
    const bool inPlace = document.many() && (path.isEmpty() || path == document.path());
    const std::filesystem::path target =
        toPath(QDir::cleanPath(QDir::current().absoluteFilePath(inPlace ? document.path() : path)));
    const auto refuse = [&](const QString& sentence) {
        m_workspace.say(MessageKind::Error, sentence);
        if (ended) ended(false);
        return nullptr;
    };
    if (document.loading())
        return refuse(tr("%1 is still being read: save it when all points are here.").arg(document.name()));
    if (!document.replaceable() && target == document.session()->openedPath())
        return refuse(
            tr("%1 is damaged, and only part of it could be read: save under another name.").arg(document.name()));
    auto saving = std::make_shared<Saving>();
    saving->document = &document;
    saving->session = document.session();
    saving->original = toPath(document.path());
    saving->target = target;
    saving->inPlace = inPlace;
    saving->name = document.many() ? document.name() : toQString(target.filename());
    saving->options.upgrade = document.upgradeAllowed();
    saving->ended = std::move(ended);
    return saving;
}

void Saves::saveParts(Document& document, std::vector<std::size_t> parts)
{
    const auto saving = begin(document, {}, {});
    if (!saving || parts.empty()) return;
    if (parts.size() == 1 && parts.front() < document.parts().size())
        saving->name = document.parts()[parts.front()].name;
    saving->parts = std::move(parts);
    startSave(saving);
}

void Saves::save(Document& document, const QString& path, std::function<void(bool)> ended, Workspace::AskSave ask)
{
    const auto saving = begin(document, path, std::move(ended));
    if (!saving) return;
    if (document.many() && !saving->inPlace) return askReplacing(saving, [this, saving] { startSave(saving); });
    if (!ask || saving->inPlace) return startSave(saving);

    // First what it would change, then the question, then the save.
    m_workspace.startJob(
        tr("Compare %1 with the file").arg(document.name()),
        [saving](Progress& progress) {
            try {
                saving->forecast = saving->session->foresee(saving->target, progress);
            } catch (const Error&) {
                saving->forecast.reset();  // then it is asked nothing; what cannot be written is told by the save
            }
        },
        [this, saving, ask = std::move(ask)](const JobInfo& info) {
            const auto proceed = [this, saving](bool wanted) {
                if (wanted && saving->document)
                    startSave(saving);
                else if (saving->ended)
                    saving->ended(false);
            };
            if (info.state != JobState::Finished) {
                if (info.state == JobState::Failed) m_workspace.say(MessageKind::Error, toQString(info.error));
                return proceed(false);
            }
            const QString question = saving->forecast ? savingQuestion(saving->forecast->preview) : QString();
            if (question.isEmpty()) return proceed(true);
            ask(question, [saving, proceed](bool wanted) {
                if (wanted && upgrades(saving->forecast->preview)) {  // that was part of the question
                    saving->options.upgrade = true;
                    if (saving->document) saving->document->allowUpgrade();
                }
                proceed(wanted);
            });
        },
        true);
}

void Saves::startSave(const std::shared_ptr<Saving>& saving)
{
    // Closing a document does not stop the save that was asked for before: the job is not tied to it.
    m_workspace.startJob(
        tr("Save %1").arg(saving->name),
        [saving](Progress& progress) {
            saving->question.reset();
            try {
                saving->outcome =
                    saving->session->save({.target = saving->inPlace ? std::filesystem::path() : saving->target,
                                           .options = saving->options,
                                           .forecast = std::move(saving->forecast),
                                           .parts = saving->parts},
                                          progress);
            } catch (const las::WriteQuestion& question) {
                saving->question = question;
                throw;
            }
        },
        [this, saving](const JobInfo& info) {
            if (info.state == JobState::Failed && saving->question && m_workspace.askQuestion)
                return askFor(saving);
            const bool done = info.state == JobState::Finished;
            if (info.state == JobState::Failed) m_workspace.say(MessageKind::Error, toQString(info.error));
            if (done) {
                const bool many = saving->session->many();
                const Document::LastSave save{many ? savedPartsText(saving->outcome, saving->session->parts(),
                                                                    saving->inPlace, saving->target)
                                                   : savedText(saving->outcome, saving->target),
                                              savedDetails(saving->outcome, saving->original, saving->target)};
                m_workspace.say(MessageKind::Info, save.sentence, save.details);
                if (saving->outcome.disturbed)
                    m_workspace.say(MessageKind::Warning,
                                    tr("Points were edited while the file was written. It lacks these edits, and a "
                                       "crash would lose them: save once more."));
                else if (saving->outcome.others)
                    m_workspace.say(
                        MessageKind::Warning,
                        tr("The other files have edits that are not saved, and a crash would lose them: "
                           "save them, too."));
                if (saving->document) {
                    saving->document->setSavedAs(saving->target, save);
                    countUnsaved(*saving->document);
                    emit saved(saving->document);
                }
            }
            if (saving->ended) saving->ended(done);
        });
}

/// A yes to what stopped the save is noted in its options, and begins it again.
void Saves::askFor(const std::shared_ptr<Saving>& saving)
{
    Question question;
    question.reason = toQString(std::string(saving->question->what()));
    const bool several = saving->session->many() && saving->parts.size() != 1;  // a yes is one to all of them
    switch (saving->question->kind()) {
        case las::WriteQuestion::Kind::TargetChanged:
            question.text = several ? tr("Replace the changed files?") : tr("Replace the changed file?");
            if (several)
                question.reason +=
                    QLatin1Char(' ') + tr("Other files of this save that another program changed are "
                                          "replaced then, too.");
            question.yes = tr("&Replace");
            break;
        case las::WriteQuestion::Kind::TargetProtected:
            question.text =
                several ? tr("Replace the write-protected files?") : tr("Replace the write-protected file?");
            if (several)
                question.reason += QLatin1Char(' ') +
                                   tr("Other files of this save that are write-protected are replaced then, too.");
            question.yes = tr("&Replace");
            break;
        case las::WriteQuestion::Kind::Upgrade:
            question.text = tr("Save as %1?").arg(toQString(saving->question->becomes()));
            question.reason +=
                QLatin1Char(' ') + tr("Every value is kept. Programs that know only older formats cannot read the "
                                      "file then. You are asked once for this file.");
            question.yes = tr("&Save");
            break;
        case las::WriteQuestion::Kind::Lossy:
            question.text =
                tr("Save as %1, without what it cannot hold?").arg(toQString(saving->question->becomes()));
            question.yes = tr("&Save");
            break;
    }
    m_workspace.askQuestion(question, [this, saving](bool wanted) {
        if (!wanted) {
            if (saving->ended) saving->ended(false);
            return;
        }
        switch (saving->question->kind()) {
            case las::WriteQuestion::Kind::TargetChanged:
                saving->options.overwriteChanged = true;
                break;
            case las::WriteQuestion::Kind::TargetProtected:
                saving->options.replaceProtected = true;
                break;
            case las::WriteQuestion::Kind::Upgrade:
                saving->options.upgrade = true;
                if (saving->document) saving->document->allowUpgrade();
                break;
            case las::WriteQuestion::Kind::Lossy:
                saving->options.lossy = true;
                break;
        }
        startSave(saving);
    });
}

/// In a folder that has files of those names already.
void Saves::askReplacing(const std::shared_ptr<Saving>& saving, std::function<void()> proceed)
{
    const auto there = std::make_shared<QStringList>();
    m_workspace.startJob(
        tr("Look into %1").arg(toQString(saving->target.filename())),
        [saving, there](Progress& progress) {
            for (const SessionPart& part : saving->session->parts()) {
                progress.check();
                std::error_code unknown;
                const std::filesystem::path target = saving->target / part.path.filename();
                if (target != part.path && std::filesystem::exists(target, unknown))
                    *there << toQString(target.filename());
            }
        },
        [this, saving, there, proceed = std::move(proceed)](const JobInfo& info) {
            const auto give = [saving](bool wanted, const std::function<void()>& go) {
                if (wanted) return go();
                if (saving->ended) saving->ended(false);
            };
            if (info.state == JobState::Failed) m_workspace.say(MessageKind::Error, toQString(info.error));
            if (info.state != JobState::Finished) return give(false, proceed);
            if (there->isEmpty() || !m_workspace.askQuestion) return give(there->isEmpty(), proceed);
            const QString folder = toQString(saving->target.filename());
            m_workspace.askQuestion(
                {there->size() == 1
                     ? tr("Replace %1 in %2?").arg(there->front(), folder)
                     : tr("Replace %1 files in %2?").arg(countText(std::size_t(there->size())), folder),
                 tr("There are files of these names already, which are gone then."), tr("&Replace")},
                [give, proceed](bool wanted) { give(wanted, proceed); });
        },
        true);
}

void Saves::merge(Document& document, const QString& path)
{
    const auto saving = begin(document, path, {});
    if (!saving) return;
    const auto report = std::make_shared<las::WriteReport>();
    m_workspace.startJob(
        tr("Save %1 as one file").arg(document.name()),
        [saving, report](Progress& progress) {
            *report = saving->session->merge(saving->target, saving->options, progress);
        },
        [this, saving, report](const JobInfo& info) {
            if (info.state == JobState::Failed) m_workspace.say(MessageKind::Error, toQString(info.error));
            if (info.state != JobState::Finished) return;
            QString sentence = tr("Saved all files as %1: %2, %3. The files stay open as they are.")
                                   .arg(toQString(saving->target.filename()), pointsText(report->points),
                                        bytesText(report->bytes));
            for (const std::string& note : report->notes) sentence += QLatin1Char(' ') + toQString(note);
            m_workspace.say(MessageKind::Info, sentence);
        });
}

void Saves::countUnsaved(Document& document)
{
    if (!m_workspace.find(document.cloud().get())) return;  // closed while it was saved
    Count& count = m_counts[&document];
    if (count.job != 0) {
        count.again = true;
        return;
    }
    if (!document.modified()) {
        document.setChangedParts({});
        return document.setUnsavedChanges({});
    }
    struct Found {
        QString sentence;
        std::vector<bool> parts;
    };
    const auto found = std::make_shared<Found>();
    const QPointer<Document> target(&document);
    count.job = m_workspace.startJob(
        tr("Unsaved changes of %1").arg(document.name()),
        [session = document.session(), found](Progress& progress) {
            found->sentence = toQString(session->unsavedChanges(progress));
            if (session->many()) found->parts = session->changedParts(progress);
        },
        [this, target, found](const JobInfo& info) {
            const auto counted = target ? m_counts.find(target.data()) : m_counts.end();
            if (counted == m_counts.end()) return;
            counted->second.job = 0;
            const bool known = info.state == JobState::Finished;
            target->setUnsavedChanges(known ? found->sentence : QString());
            target->setChangedParts(known ? found->parts : std::vector<bool>());
            if (std::exchange(counted->second.again, false)) countUnsaved(*target);
        },
        true);
    m_workspace.tie(document, count.job);
}

}  // namespace punctum::ui
