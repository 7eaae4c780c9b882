// SPDX-License-Identifier: MIT
#include "ui/document/Saves.h"

#include "core/Error.h"
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
    std::filesystem::path target;
    std::optional<Forecast> forecast;
    las::WriteOptions options;
    std::function<void(bool)> ended;
    SaveOutcome outcome;
    std::optional<las::WriteQuestion> question;  ///< why it stopped, where the user can decide
};

void Saves::save(Document& document, const QString& path, std::function<void(bool)> ended, Workspace::AskSave ask)
{
    const std::filesystem::path target = toPath(QDir::cleanPath(QDir::current().absoluteFilePath(path)));
    const auto refuse = [&](const QString& sentence) {
        m_workspace.say(MessageKind::Error, sentence);
        if (ended) ended(false);
    };
    if (document.loading())
        return refuse(tr("%1 is still being read: save it when all points are here.").arg(document.name()));
    if (document.recovered() && target == document.session()->openedPath())
        return refuse(
            tr("%1 is damaged, and only part of it could be read: save under another name.").arg(document.name()));
    auto saving = std::make_shared<Saving>();
    saving->document = &document;
    saving->session = document.session();
    saving->original = toPath(document.path());
    saving->target = target;
    saving->options.upgrade = document.upgradeAllowed();
    saving->ended = std::move(ended);
    if (!ask) return startSave(saving);

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
        tr("Save %1").arg(toQString(saving->target.filename())),
        [saving](Progress& progress) {
            saving->question.reset();
            try {
                saving->outcome = saving->session->save(
                    {saving->target, saving->options, true, std::move(saving->forecast)}, progress);
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
                const Document::LastSave save{savedText(saving->outcome, saving->target),
                                              savedDetails(saving->outcome, saving->original, saving->target)};
                m_workspace.say(MessageKind::Info, save.sentence, save.details);
                if (saving->outcome.disturbed)
                    m_workspace.say(MessageKind::Warning,
                                    tr("Points were edited while the file was written. It lacks these edits, and a "
                                       "crash would lose them: save once more."));
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
    switch (saving->question->kind()) {
        case las::WriteQuestion::Kind::TargetChanged:
            question.text = tr("Replace the changed file?");
            question.yes = tr("&Replace");
            break;
        case las::WriteQuestion::Kind::TargetProtected:
            question.text = tr("Replace the write-protected file?");
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

void Saves::countUnsaved(Document& document)
{
    if (!m_workspace.find(document.cloud().get())) return;  // closed while it was saved
    Count& count = m_counts[&document];
    if (count.job != 0) {
        count.again = true;
        return;
    }
    if (!document.modified()) return document.setUnsavedChanges({});
    auto changes = std::make_shared<QString>();
    const QPointer<Document> target(&document);
    count.job = m_workspace.startJob(
        tr("Unsaved changes of %1").arg(document.name()),
        [session = document.session(), changes](Progress& progress) {
            *changes = toQString(session->unsavedChanges(progress));
        },
        [this, target, changes](const JobInfo& info) {
            const auto counted = target ? m_counts.find(target.data()) : m_counts.end();
            if (counted == m_counts.end()) return;
            counted->second.job = 0;
            target->setUnsavedChanges(info.state == JobState::Finished ? *changes : QString());
            if (std::exchange(counted->second.again, false)) countUnsaved(*target);
        },
        true);
    m_workspace.tie(document, count.job);
}

}  // namespace punctum::ui
