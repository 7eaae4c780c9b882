// SPDX-License-Identifier: MIT
#include "ui/document/Workspace.h"

#include "core/cloud/BlockBoxes.h"
#include "core/edit/History.h"
#include "core/measure/Spacing.h"
#include "core/session/FileFacts.h"
#include "core/task/Progress.h"
#include "render/store/PointStore.h"
#include "ui/basic/Text.h"
#include "ui/document/BackgroundPriority.h"
#include "ui/document/Distinctions.h"
#include "ui/document/Openings.h"
#include "ui/document/Recovery.h"
#include "ui/document/Saves.h"

#include <QDir>

#include <algorithm>
#include <chrono>
#include <shared_mutex>
#include <thread>

namespace punctum::ui
{

namespace
{

/// More values than that have no place in a legend.
constexpr std::size_t kListedValues = 64;

}  // namespace

Workspace::Workspace(HistoryRoom room, QObject* parent)
    : QObject(parent),
      m_room(std::move(room)),
      m_recovery(std::make_unique<Recovery>(*this, m_room.folder)),
      m_jobs(std::make_unique<Jobs>()),
      m_openings(std::make_unique<Openings>(*this)),
      m_saves(std::make_unique<Saves>(*this))
{
    m_names.setSingleShot(true);
    connect(&m_names, &QTimer::timeout, this, &Workspace::distinguish);
    connect(m_saves.get(), &Saves::saved, this, [this](Document* document) {
        m_names.start();
        emit saved(document);
    });
}

Workspace::~Workspace()
{
    m_jobs.reset();  // cancels and waits: from here on no thread knows of this object
    m_watches.clear();
    for (Document* document :
         m_documents)  // ended in order: what is unsaved was to be given up, or there is nothing
        document->session()->close();
    qDeleteAll(m_documents);
}

JobId Workspace::startJob(const QString& title, Jobs::Work work, Ended ended, bool quiet, JobTurn turn)
{
    auto inBackground = [work = std::move(work)](Progress& progress) {
        const BackgroundPriority priority;
        work(progress);
    };
    const JobId id = m_jobs->start(
        title.toStdString(), std::move(inBackground),
        [this, ended = std::move(ended)](const JobInfo& info) {
            QMetaObject::invokeMethod(
                this,
                [this, ended, info] {
                    for (auto it = m_documentJobs.begin(); it != m_documentJobs.end();)
                        it = it->second == info.id ? m_documentJobs.erase(it) : std::next(it);
                    if (ended)
                        ended(info);
                    else if (info.state == JobState::Failed)
                        say(MessageKind::Error, toQString(info.error));
                    emit jobEnded(info);
                    --m_unended;
                },
                Qt::QueuedConnection);
        },
        turn);
    ++m_unended;
    emit jobStarted(id, title, quiet);
    return id;
}

void Workspace::setActive(Document* document)
{
    if (document == m_active) return;
    m_active = document;
    emit activeChanged(document);
}

Document* Workspace::find(const PointCloud* cloud) const
{
    for (Document* document : m_documents)
        if (document->cloud().get() == cloud) return document;
    return nullptr;
}

// -- opening

bool Workspace::opening() const noexcept
{
    return m_openings->any();
}

void Workspace::open(const QStringList& paths, const QString& origin)
{
    QStringList wanted;
    for (const QString& path : paths) wanted << QDir::cleanPath(QDir::current().absoluteFilePath(path));
    m_openings->open(wanted, origin);
}

Document& Workspace::take(std::shared_ptr<Session> session, std::shared_ptr<render::PointStore> store)
{
    auto* document = new Document(std::move(session), std::move(store), this);
    m_documents.push_back(document);
    Watch& watch = m_watches[document];
    watch.subscription = document->cloud()->subscribe(
        [this, target = QPointer<Document>(document),
         cloud = std::weak_ptr<PointCloud>(document->cloud())](const ChangeNotice& notice) {
            After after;
            if (const auto alive = cloud.lock(); alive && notice.kind == ChangeNotice::Kind::Attributes) {
                const std::shared_lock lock(alive->mutex());
                after.attributes = alive->attributes();
            } else if (alive && notice.kind == ChangeNotice::Kind::Deleted) {
                after.deleted = deletedPoints(*alive);
                after.deletedCount = after.deleted ? after.deleted->count() : 0;
            }
            QMetaObject::invokeMethod(
                this,
                [this, target, notice, after = std::move(after)] {
                    if (target) handleNotice(*target, notice, after);
                },
                Qt::QueuedConnection);
        });
    connect(document, &Document::stateChanged, this, [this, document] { emit documentStateChanged(document); });
    m_names.start();
    emit documentAdded(document);
    return *document;
}

void Workspace::distinguish()
{
    std::map<QString, std::vector<Document*>> byName;
    for (Document* document : m_documents) byName[document->fileName()].push_back(document);
    for (const auto& [name, documents] : byName) {
        QStringList paths;
        for (const Document* document : documents) paths << document->path();
        const QStringList parts = documents.size() > 1 ? distinctionsOf(paths) : QStringList({QString()});
        for (std::size_t k = 0; k < documents.size(); ++k) documents[k]->setDistinction(parts[qsizetype(k)]);
    }
}

void Workspace::finishLoading(Document& document, const las::ReadResult& result)
{
    document.setLoaded(result);
    emit documentLoaded(&document);
    lookAtParts(document);
    analyze(document, {});
    m_recovery->look(document);
}

void Workspace::lookAtParts(Document& document)
{
    const auto facts = std::make_shared<std::vector<Document::PartFacts>>();
    tie(document, startJob(
                      tr("Look at the files of %1").arg(document.name()),
                      [session = document.session(), facts](Progress& progress) {
                          std::map<std::string, QString> names;  // PROJ takes its time: once for each system
                          const PointCloud& cloud = *session->cloud();
                          for (const SessionPart& part : session->parts()) {
                              progress.check();
                              const auto [name, isNew] = names.emplace(part.source->crs, QString());
                              if (isNew) name->second = toQString(crsNameOf(*part.source));
                              facts->push_back({{}, name->second});
                              // What could not be read is nowhere.
                              if (!part.damaged && !part.points.empty())
                                  facts->back().bounds = cloud.coordinates().toWorld(boundsOf(cloud, part.points));
                          }
                      },
                      [target = QPointer<Document>(&document), facts](const JobInfo& info) {
                          if (target && info.state == JobState::Finished) target->setPartFacts(*facts);
                      },
                      true));
}

void Workspace::dropUnread(Document& document)
{
    remove(document, true);
}

void Workspace::close(Document& document)
{
    remove(document, false);
}

void Workspace::remove(Document& document, bool openingFailed)
{
    const auto found = std::find(m_documents.begin(), m_documents.end(), &document);
    if (found == m_documents.end()) return;
    const auto [first, last] = m_documentJobs.equal_range(&document);
    for (auto it = first; it != last; ++it) m_jobs->cancel(it->second);
    m_documentJobs.erase(first, last);
    m_watches.erase(&document);
    m_saves->forget(document);
    const auto index = found - m_documents.begin();
    m_documents.erase(found);
    m_names.start();
    if (m_active == &document) {
        m_active = nullptr;
        if (!m_documents.empty()) m_active = m_documents[std::min(std::size_t(index), m_documents.size() - 1)];
        emit activeChanged(m_active);
    }
    emit documentRemoved(&document, openingFailed);
    // Giving back gigabytes takes a while: the last one to let go of them is a job, not the window.
    startJob(
        tr("Close %1").arg(document.name()),
        [session = document.session(), store = document.store()](Progress& progress) {
            session->close();
            while ((session.use_count() > 1 || store.use_count() > 1) && !progress.cancelled())
                std::this_thread::sleep_for(std::chrono::milliseconds(20));
        },
        {}, true);
    document.deleteLater();
}

// -- what the values are

void Workspace::handleNotice(Document& document, const ChangeNotice& notice, After after)
{
    if (!m_watches.contains(&document)) return;
    QStringList names;
    if (notice.kind == ChangeNotice::Kind::Attributes) {
        for (const std::string& name : notice.attributes) names << toQString(name);
        document.forgetFigures(names);
        document.setAttributes(std::move(after.attributes));
    } else if (notice.kind == ChangeNotice::Kind::Deleted) {
        document.setDeleted(std::move(after.deleted), after.deletedCount);
        for (const Attribute& attribute : document.attributes()) names << toQString(attribute.name);
    } else {
        for (const Attribute& attribute : document.attributes())
            if (notice.concerns(attribute)) names << toQString(attribute.name);
    }
    emit cloudChanged(&document, notice);
    document.noteEdit();
    if (!document.loading() && !names.isEmpty()) analyze(document, names);
}

void Workspace::analyze(Document& document, const QStringList& names)
{
    Watch& watch = m_watches[&document];
    if (watch.analysis != 0) {
        watch.pendingAnalysis += names;
        return;
    }
    std::vector<Attribute> wanted;
    for (const Attribute& attribute : document.attributes())
        if (attribute.kind != AttributeKind::Opaque &&
            (names.isEmpty() || names.contains(toQString(attribute.name))))
            wanted.push_back(attribute);
    // What the docks show first is counted first.
    std::stable_partition(wanted.begin(), wanted.end(),
                          [](const Attribute& a) { return a.kind == AttributeKind::Class; });

    const QPointer<Document> target(&document);
    const auto deliver = [this, target](auto&& apply) {
        QMetaObject::invokeMethod(
            this,
            [target, apply] {
                if (target) apply(*target);
            },
            Qt::QueuedConnection);
    };
    watch.analysis = startJob(
        tr("Value ranges of %1").arg(document.name()),
        [cloud = document.cloud(), wanted, deliver, stretch = document.viewStretch(document.bounds()),
         first = names.isEmpty()](Progress& progress) {
            if (first) {
                const double spacing = pointSpacing(*cloud, stretch, progress);
                deliver([spacing](Document& d) { d.setSpacing(spacing); });
            }
            for (const Attribute& attribute : wanted) {
                if (attribute.kind == AttributeKind::Class) {
                    std::array<std::uint64_t, 256> counts;
                    {
                        const std::shared_lock lock(cloud->mutex());
                        counts = countValues(attribute, progress, cloud->deleted().get());
                    }
                    deliver([counts](Document& d) { d.setClassCounts(counts); });
                }
                if (attribute.kind == AttributeKind::Category && attribute.integral()) {
                    DistinctValues values;
                    {
                        const std::shared_lock lock(cloud->mutex());
                        values = distinctValues(attribute, kListedValues, progress, cloud->deleted().get());
                    }
                    deliver([name = toQString(attribute.name), values = std::move(values)](Document& d) {
                        d.setValues(name, values);
                    });
                }
                AttributeFigures figures;
                for (std::uint32_t c = 0; c < attribute.components; ++c) {
                    const std::shared_lock lock(cloud->mutex());
                    figures[c] = computeStatistics(attribute, c, progress, cloud->deleted().get());
                }
                deliver([name = toQString(attribute.name), figures](Document& d) { d.setFigures(name, figures); });
            }
        },
        [this, target](const JobInfo&) {
            if (!target) return;
            const auto found = m_watches.find(target.data());
            if (found == m_watches.end()) return;
            found->second.analysis = 0;
            const QStringList pending = std::exchange(found->second.pendingAnalysis, {});
            if (!pending.isEmpty()) analyze(*target, pending);
        },
        true, names.isEmpty() ? JobTurn::Idle : JobTurn::AtOnce);
    tie(document, watch.analysis);
}

// -- changing

void Workspace::save(Document& document, const QString& path, std::function<void(bool)> ended, AskSave ask)
{
    m_saves->save(document, path, std::move(ended), std::move(ask));
}

void Workspace::saveParts(Document& document, std::vector<std::size_t> parts)
{
    m_saves->saveParts(document, std::move(parts));
}

void Workspace::merge(Document& document, const QString& path)
{
    m_saves->merge(document, path);
}

void Workspace::undo(Document& document)
{
    const History& history = document.history();
    if (history.canUndo())
        moveHistory(document, history.position() - 1, tr("Undo %1").arg(toQString(history.undoName())));
}

void Workspace::redo(Document& document)
{
    const History& history = document.history();
    if (history.canRedo())
        moveHistory(document, history.position() + 1, tr("Redo %1").arg(toQString(history.redoName())));
}

void Workspace::walk(Document& document, std::size_t position)
{
    if (position != document.history().position() && !document.loading())
        moveHistory(document, position, tr("Walk through the history of %1").arg(document.name()));
}

void Workspace::moveHistory(Document& document, std::size_t position, const QString& title)
{
    startJob(
        title, [session = document.session(), position](Progress& progress) { session->walk(position, progress); },
        [this, alive = QPointer<Document>(&document)](const JobInfo& info) {
            if (info.state == JobState::Failed) say(MessageKind::Error, toQString(info.error));
            if (alive) edited(*alive);
        },
        true);
}

JobId Workspace::edit(Document& document, const QString& title, const Recipe& recipe, EditEnded ended)
{
    auto outcome = std::make_shared<EditOutcome>();
    const JobId id = startJob(
        tr("%1 of %2").arg(title, document.name()),
        [session = document.session(), recipe, outcome](Progress& progress) {
            *outcome = session->edit(recipe, progress);
        },
        [this, alive = QPointer<Document>(&document), ended = std::move(ended), outcome](const JobInfo& info) {
            if (alive) edited(*alive);
            ended(info, *outcome);
        });
    tie(document, id);
    return id;
}

void Workspace::extract(Document& document, std::shared_ptr<const PointSet> points, const QString& path)
{
    const std::filesystem::path target = toPath(QDir::cleanPath(QDir::current().absoluteFilePath(path)));
    const auto report = std::make_shared<las::WriteReport>();
    startJob(
        tr("Save selected points of %1").arg(document.name()),
        [session = document.session(), points = std::move(points), target, report](Progress& progress) {
            *report = session->extract(*points, target, {}, progress);
        },
        [this, target, report](const JobInfo& info) {
            if (info.state == JobState::Failed) say(MessageKind::Error, toQString(info.error));
            if (info.state == JobState::Finished)
                say(MessageKind::Info,
                    tr("Saved %1 to %2.").arg(pointsText(report->points), toQString(target.filename())));
        });
}

void Workspace::edited(Document& document)
{
    document.noteEdit();
    for (const std::string& warning : document.session()->takeWarnings())
        say(MessageKind::Warning, toQString(warning), {}, &document);
    m_saves->countUnsaved(document);
}

JobId Workspace::run(Document& document, const Step& step, const StepValues& values)
{
    const QString title = toQString(step.title());
    return edit(document, title, Recipe{step.name(), values, nullptr},
                [this, title](const JobInfo& info, const EditOutcome& outcome) {
                    QStringList names;
                    for (const std::string& name : outcome.newAttributes) names << toQString(name);
                    emit stepEnded(info.id, title, outcome.changed, names, info);
                });
}

}  // namespace punctum::ui
