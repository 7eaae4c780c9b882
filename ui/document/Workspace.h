// SPDX-License-Identifier: MIT
#pragma once

#include "core/edit/HistoryRoom.h"
#include "core/edit/Recipe.h"
#include "core/process/Step.h"
#include "core/session/Session.h"
#include "core/task/Jobs.h"
#include "render/order/SlotOrder.h"
#include "ui/basic/Question.h"
#include "ui/document/Document.h"

#include <QObject>
#include <QPointer>
#include <QTimer>

#include <functional>
#include <map>
#include <memory>
#include <set>
#include <vector>

namespace punctum::ui
{

class Openings;
class Recovery;
class Saves;

/// How grave a message to the user is.
enum class MessageKind { Info, Warning, Error };

/// The open documents, which of them is active, and the jobs that open, change and save them.
///
/// GUI thread only; every call returns at once, and the work is done by jobs. Signals come in the GUI thread.
/// Results of a job whose document has been closed meanwhile are dropped. Destroying it cancels all jobs.
class Workspace final : public QObject
{
    Q_OBJECT
public:
    using Ended = std::function<void(const JobInfo&)>;

    /// `room`: what each document may keep for undo; in its folder unsaved edits are noted down as well, in case of
    /// a crash.
    explicit Workspace(HistoryRoom room = {}, QObject* parent = nullptr);
    ~Workspace() override;

    const std::vector<Document*>& documents() const noexcept { return m_documents; }
    /// Null when nothing is open.
    Document* active() const noexcept { return m_active; }
    void setActive(Document* document);
    Document* find(const PointCloud* cloud) const;

    /// Reads these files as one document, a survey where they are several. It is there, and active, as soon as
    /// headers and columns are, and fills meanwhile. Where none can be read there is one message, and nothing else
    /// changes. Files that are open already are left as they are; when all are, their document becomes active.
    /// `origin`: the folder or virtual point cloud that they were found in, if it was that which the user opened.
    void open(const QStringList& paths, const QString& origin = {});
    void open(const QString& path) { open(QStringList(path)); }
    /// In which the points of files that are opened from now on are drawn.
    void setOrder(render::OrderKind order) noexcept { m_order = order; }
    render::OrderKind order() const noexcept { return m_order; }
    /// Files whose opening has begun and that are not documents yet, or still loading.
    bool opening() const noexcept;
    /// Without asking; a job that works on it is cancelled.
    void close(Document& document);
    /// Asked before a save that would leave something out or upgrade it: `what` says what, and `answer` is to be
    /// called with whether to go on, any time later.
    using AskSave = std::function<void(const QString& what, std::function<void(bool)> answer)>;
    /// Writes LAS or LAZ by the path's ending, and tells what that changed. `ended(true)`: written and renamed over
    /// `path`. Without `ask` it goes on in any case.
    /// Of a survey, `path` empty or its own: the files that changed, all or none; a folder: all files under their
    /// names there.
    void save(Document& document, const QString& path, std::function<void(bool)> ended = {}, AskSave ask = {});
    /// These files of a survey alone, in their own place.
    void saveParts(Document& document, std::vector<std::size_t> parts);
    /// All points of a survey into one file, which is none of its files; nothing counts as saved.
    void merge(Document& document, const QString& path);
    /// Asked by a save that cannot go on without the user's word. Without it, such a save fails with a message.
    AskQuestion askQuestion;
    void undo(Document& document);
    void redo(Document& document);
    /// Undoes or redoes until so many of the history's commands are in force.
    void walk(Document& document, std::size_t position);
    /// Runs a processing step and applies its command; stepEnded tells the result.
    JobId run(Document& document, const Step& step, const StepValues& values);

    /// Session::edit(). `ended` is called in the GUI thread; a failure is told by it alone.
    using EditEnded = std::function<void(const JobInfo&, const EditOutcome&)>;
    JobId edit(Document& document, const QString& title, const Recipe& recipe, EditEnded ended);

    /// Writes these points alone to another file than the document's.
    void extract(Document& document, std::shared_ptr<const PointSet> points, const QString& path);

    /// The document was changed by a job of somebody else: says so, and counts what is unsaved.
    void edited(Document& document);
    Recovery& recovery() noexcept { return *m_recovery; }

    /// Any other long work. `ended` is called in the GUI thread, and tells why it failed; where there is none, that
    /// is told here. Quiet jobs leave the list at once.
    JobId startJob(const QString& title, Jobs::Work work, Ended ended = {}, bool quiet = false,
                   JobTurn turn = JobTurn::AtOnce);
    /// The job is cancelled when the document is closed.
    void tie(Document& document, JobId job) { m_documentJobs.emplace(&document, job); }
    void cancel(JobId id) { m_jobs->cancel(id); }
    Jobs& jobs() noexcept { return *m_jobs; }
    /// Whether a job runs, or has ended and its result is still on its way here.
    bool busy() const noexcept { return m_unended > 0; }

    /// Shows the user a sentence; `details`: lines of a report that it leads to; `about`: the document with which
    /// it loses its meaning.
    void say(MessageKind kind, const QString& sentence, const QString& details = {},
             const Document* about = nullptr)
    {
        emit message(kind, sentence, details, about);
    }

signals:
    void documentAdded(punctum::ui::Document* document);
    void documentLoaded(punctum::ui::Document* document);
    /// Comes while the document still exists, and is no longer in documents().
    void documentRemoved(punctum::ui::Document* document, bool openingFailed);
    void activeChanged(punctum::ui::Document* document);
    void documentStateChanged(punctum::ui::Document* document);
    void cloudChanged(punctum::ui::Document* document, const punctum::ChangeNotice& notice);
    void message(punctum::ui::MessageKind kind, const QString& sentence, const QString& details,
                 const punctum::ui::Document* about);
    void jobStarted(quint64 id, const QString& title, bool quiet);
    void jobEnded(const punctum::JobInfo& info);
    /// Of run() and of the Process panel. `changed`: points whose values differ now; `error`: empty unless it
    /// failed.
    void stepEnded(quint64 job, const QString& title, quint64 changed, const QStringList& newAttributes,
                   const punctum::JobInfo& info);
    void saved(punctum::ui::Document* document);

private:
    friend class Openings;
    /// A document of it, which fills from now on.
    Document& take(std::shared_ptr<Session> session, std::shared_ptr<render::PointStore> store);
    void finishLoading(Document& document, const las::ReadResult& result);
    void lookAtParts(Document& document);
    void dropUnread(Document& document);
    const HistoryRoom& room() const noexcept { return m_room; }
    void distinguish();
    void remove(Document& document, bool openingFailed);
    /// What of the cloud a notice makes out of date, as it is after the change.
    struct After {
        std::vector<Attribute> attributes;
        std::shared_ptr<const PointSet> deleted;
        PointIndex deletedCount = 0;
    };
    void handleNotice(Document& document, const ChangeNotice& notice, After after);
    void analyze(Document& document, const QStringList& names);
    void moveHistory(Document& document, std::size_t position, const QString& title);

    struct Watch {
        Subscription subscription;
        QStringList pendingAnalysis;
        JobId analysis = 0;
    };

    HistoryRoom m_room;
    std::unique_ptr<Recovery> m_recovery;  ///< outlives the jobs
    std::unique_ptr<Jobs> m_jobs;
    std::unique_ptr<Openings> m_openings;
    std::unique_ptr<Saves> m_saves;
    std::vector<Document*> m_documents;
    std::map<Document*, Watch> m_watches;
    std::multimap<Document*, JobId> m_documentJobs;
    Document* m_active = nullptr;
    std::size_t m_unended = 0;
    QTimer m_names;  ///< documents have come or gone since names were told apart
    render::OrderKind m_order = render::OrderKind::Stratified;
};

}  // namespace punctum::ui
