// SPDX-License-Identifier: MIT
#include "ui/document/Openings.h"

#include "core/Error.h"
#include "core/task/Progress.h"
#include "render/scene/PointIds.h"
#include "render/store/CloudLoad.h"
#include "ui/basic/Text.h"
#include "ui/document/Workspace.h"

#include <QFileInfo>
#include <QPointer>
#include <QSet>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>
#include <utility>

namespace punctum::ui
{

namespace
{

constexpr std::size_t kListedOneByOne = 8;  ///< more files at once are one job in the list
constexpr std::size_t kMostAtOnce = 12;     ///< read, or read and not yet taken in by the window
constexpr std::chrono::milliseconds kBatchStep(50);

QString fileNameOf(const QString& path)
{
    return QFileInfo(path).fileName();
}

/// What its file has to say: a sentence, and lines that it leads to. Empty: nothing.
std::pair<QString, QString> newsOf(const Document& document)
{
    const QStringList& losses = document.losses();
    const std::vector<std::string>& warnings = document.facts().warnings;
    if (document.recovered()) {
        const QString sentence = losses.size() == 1
                                     ? Workspace::tr("%1 is damaged: %2").arg(document.name(), losses.front())
                                     : Workspace::tr("%1 is damaged in %2 ways; the File panel lists them.")
                                           .arg(document.name())
                                           .arg(losses.size());
        return {sentence + Workspace::tr(" What could be read is open; it can be saved under another name."),
                losses.size() == 1 ? QString() : losses.join(QLatin1Char('\n'))};
    }
    if (warnings.size() == 1)
        return {Workspace::tr("%1: %2").arg(document.name(), toQString(warnings.front())), {}};
    if (!warnings.empty())
        return {Workspace::tr("%1 opened with %2 warnings; the File panel lists them.")
                    .arg(document.name())
                    .arg(warnings.size()),
                {}};
    return {};
}

}  // namespace

/// One file on its way in.
struct Openings::Opening {
    QString path;
    std::shared_ptr<Batch> batch;
    JobId job = 0;
    std::shared_ptr<Session> session;
    std::shared_ptr<render::PointStore> store;
    las::ReadResult result;
    QPointer<Document> document;  ///< GUI thread only
};

/// Files that were asked for together. GUI thread only, but for `ended`.
struct Openings::Batch {
    QString origin;
    std::size_t files = 0;
    std::atomic<std::size_t> ended = 0;  ///< of them
    bool listed = false;                 ///< as one job
    bool active = false;                 ///< one of them has become active
    QStringList failures, damages, remarks;
};

Openings::Openings(Workspace& workspace) : m_workspace(workspace) {}

void Openings::open(const QStringList& paths, const QString& origin)
{
    QSet<QString> known;
    for (const Document* document : m_workspace.documents()) known.insert(document->path());
    for (const auto& other : m_opening) known.insert(other->path);
    for (const auto& other : m_waiting) known.insert(other->path);
    const auto batch = std::make_shared<Batch>();
    batch->origin = origin;
    std::vector<std::shared_ptr<Opening>> fresh;
    for (const QString& path : paths) {
        if (known.contains(path)) continue;
        known.insert(path);
        fresh.push_back(std::make_shared<Opening>());
        fresh.back()->path = path;
        fresh.back()->batch = batch;
    }
    if (fresh.empty()) return;
    batch->files = fresh.size();
    batch->listed = fresh.size() > kListedOneByOne;
    if (batch->listed) startBatch(batch);
    m_waiting.insert(m_waiting.end(), fresh.begin(), fresh.end());
    startNext();
}

void Openings::startNext()
{
    while (m_opening.size() < kMostAtOnce && !m_waiting.empty()) {
        const std::shared_ptr<Opening> next = std::move(m_waiting.front());
        m_waiting.pop_front();
        m_opening.push_back(next);
        start(next);
    }
}

void Openings::start(const std::shared_ptr<Opening>& opening)
{
    opening->job = m_workspace.startJob(
        tr("Open %1").arg(fileNameOf(opening->path)),
        [this, opening, order = m_workspace.order(), room = m_workspace.room()](Progress& progress) {
            progress.begin("Reading the header", 1);
            const std::filesystem::path place = findPath(opening->path);
            const render::CloudLoad load(Session::open(place, room), order);
            progress.check();
            opening->session = load.session();
            opening->store = load.store();
            QMetaObject::invokeMethod(
                this, [this, opening] { ready(opening); }, Qt::QueuedConnection);
            opening->result = load.read(progress);
        },
        [this, opening](const JobInfo& info) { ended(opening, info); }, opening->batch->listed, JobTurn::Queued);
}

void Openings::ready(const std::shared_ptr<Opening>& opening)
{
    render::PointIds ids;
    try {
        for (const Document* open : m_workspace.documents()) ids.take(open->store()->slotCount());
        ids.take(opening->store->slotCount());
    } catch (const Error& e) {
        m_workspace.cancel(opening->job);
        fail(*opening,
             tr("%1 was not opened: %2").arg(fileNameOf(opening->path), toQString(std::string(e.what()))));
        return;
    }
    Document& document = m_workspace.take(opening->session, opening->store);
    opening->document = &document;
    if (opening->batch->files > 1 && !opening->batch->origin.isEmpty()) document.setOrigin(opening->batch->origin);
    m_workspace.tie(document, opening->job);
    if (!std::exchange(opening->batch->active, true)) m_workspace.setActive(&document);
}

void Openings::ended(const std::shared_ptr<Opening>& opening, const JobInfo& info)
{
    std::erase(m_opening, opening);
    ++opening->batch->ended;
    startNext();
    Document* const document = opening->document;
    const auto& documents = m_workspace.documents();
    const bool wanted = document && std::find(documents.begin(), documents.end(), document) != documents.end();
    if (info.state != JobState::Finished) {
        if (wanted) m_workspace.dropUnread(*document);
        if (info.state == JobState::Failed) fail(*opening, toQString(info.error));
        return;
    }
    if (!wanted) return;  // closed while its last points arrived
    m_workspace.finishLoading(*document, opening->result);
    tell(opening->batch, *document);
}

void Openings::fail(const Opening& opening, const QString& sentence)
{
    if (opening.batch->listed)
        opening.batch->failures << sentence;
    else
        m_workspace.say(MessageKind::Error, sentence);
}

void Openings::tell(const std::shared_ptr<Batch>& batch, Document& document)
{
    const auto [sentence, details] = newsOf(document);
    if (sentence.isEmpty()) return;
    if (!batch->listed)
        m_workspace.say(MessageKind::Warning, sentence, details, &document);
    else
        (document.recovered() ? batch->damages : batch->remarks)
            << (details.isEmpty() ? sentence : sentence + QLatin1Char('\n') + details);
}

void Openings::startBatch(const std::shared_ptr<Batch>& batch)
{
    m_workspace.startJob(
        tr("Open %1 files").arg(countText(batch->files)),
        [batch](Progress& progress) {
            progress.begin("Reading files", batch->files);
            for (std::size_t counted = 0; counted < batch->files;) {
                progress.check();
                const std::size_t now = batch->ended;
                progress.add(now - counted);
                counted = now;
                if (counted < batch->files) std::this_thread::sleep_for(kBatchStep);
            }
        },
        [this, batch](const JobInfo& info) { endBatch(batch, info); });
}

void Openings::endBatch(const std::shared_ptr<Batch>& batch, const JobInfo& info)
{
    if (info.state == JobState::Cancelled) {
        std::erase_if(m_waiting, [&](const auto& opening) { return opening->batch == batch; });
        for (const auto& opening : m_opening)
            if (opening->batch == batch) m_workspace.cancel(opening->job);
    }
    const QString files = countText(batch->files);
    const auto say = [&](MessageKind kind, const QString& sentence, const QStringList& lines) {
        if (lines.isEmpty()) return;
        m_workspace.say(kind, sentence.arg(countText(std::size_t(lines.size())), files),
                        lines.join(QLatin1Char('\n')));
    };
    say(MessageKind::Warning, tr("%1 of %2 files opened with warnings."), batch->remarks);
    say(MessageKind::Warning,
        tr("%1 of %2 files are damaged; what could be read is open, and can be saved under another name."),
        batch->damages);
    say(MessageKind::Error, tr("%1 of %2 files could not be opened."), batch->failures);
}

}  // namespace punctum::ui
