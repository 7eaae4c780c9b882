// SPDX-License-Identifier: MIT
#include "ui/document/Openings.h"

#include "core/Error.h"
#include "core/task/Progress.h"
#include "render/scene/PointIds.h"
#include "render/store/CloudLoad.h"
#include "ui/basic/Text.h"
#include "ui/document/Workspace.h"

#include <QFileInfo>
#include <QHash>
#include <QPointer>
#include <QSet>

#include <algorithm>
#include <utility>

namespace punctum::ui
{

namespace
{

constexpr int kMostRemembered = 50;  // files of a survey without a folder, in the list of recent ones

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
        return {
            sentence + (document.many()
                            ? Workspace::tr(" What could be read is open; damaged files can be saved elsewhere.")
                            : Workspace::tr(" What could be read is open; it can be saved under another name.")),
            losses.size() == 1 ? QString() : losses.join(QLatin1Char('\n'))};
    }
    QStringList sentences = losses;  // of a survey: files that could not be opened
    for (const std::string& warning : warnings) sentences << toQString(warning);
    if (sentences.isEmpty()) return {};
    if (sentences.size() == 1) return {Workspace::tr("%1: %2").arg(document.name(), sentences.front()), {}};
    return {Workspace::tr("%1 opened with %2 warnings; the File panel lists them.")
                .arg(document.name(), countText(std::size_t(sentences.size()))),
            document.many() ? sentences.join(QLatin1Char('\n')) : QString()};
}

}  // namespace

/// Files on their way in.
struct Openings::Opening {
    QStringList paths;
    QString origin;
    QString title;  ///< for jobs and messages
    JobId job = 0;
    std::shared_ptr<Session> session;
    std::shared_ptr<render::PointStore> store;
    las::ReadResult result;
    QPointer<Document> document;  ///< GUI thread only
};

Openings::Openings(Workspace& workspace) : m_workspace(workspace) {}

void Openings::open(const QStringList& paths, const QString& origin)
{
    QHash<QString, Document*> known;
    for (const auto& other : m_opening)
        for (const QString& path : other->paths) known.insert(path, other->document);
    for (Document* document : m_workspace.documents())
        for (const Document::Part& part : document->parts()) known.insert(part.path, document);
    const auto opening = std::make_shared<Opening>();
    QSet<QString> seen;
    for (const QString& path : paths) {
        if (known.contains(path) || seen.contains(path)) continue;
        seen.insert(path);
        opening->paths << path;
    }
    const auto left =
        std::count_if(paths.begin(), paths.end(), [&](const QString& p) { return known.contains(p); });
    if (opening->paths.isEmpty()) {
        if (Document* const open = paths.isEmpty() ? nullptr : known.value(paths.front())) {
            m_workspace.setActive(open);
            if (paths.size() == 1 && open->many())
                m_workspace.say(
                    MessageKind::Info,
                    tr("%1 is open already, as one of %2.").arg(fileNameOf(paths.front()), open->name()), {}, open);
        }
        return;
    }
    if (left != 0)
        m_workspace.say(MessageKind::Info, left == 1
                                               ? tr("One of these files is open already and is left as it is.")
                                               : tr("%1 of these files are open already and are left as they are.")
                                                     .arg(countText(std::size_t(left))));
    const bool many = opening->paths.size() > 1;
    opening->origin = many && origin.isEmpty() && opening->paths.size() <= kMostRemembered
                          ? opening->paths.join(QLatin1Char('\n'))
                          : (many ? origin : QString());
    opening->title = !many              ? fileNameOf(opening->paths.front())
                     : origin.isEmpty() ? tr("%1 files").arg(countText(std::size_t(opening->paths.size())))
                                        : fileNameOf(origin);
    m_opening.push_back(opening);
    start(opening);
}

void Openings::start(const std::shared_ptr<Opening>& opening)
{
    opening->job = m_workspace.startJob(
        tr("Open %1").arg(opening->title),
        [this, opening, order = m_workspace.order(), room = m_workspace.room()](Progress& progress) {
            progress.begin("Reading headers", std::uint64_t(opening->paths.size()));
            std::vector<std::filesystem::path> places;
            places.reserve(std::size_t(opening->paths.size()));
            for (const QString& path : opening->paths) places.push_back(findPath(path));
            const render::CloudLoad load(Session::open(places, room, progress), order);
            progress.check();
            opening->session = load.session();
            opening->store = load.store();
            QMetaObject::invokeMethod(
                this, [this, opening] { ready(opening); }, Qt::QueuedConnection);
            opening->result = load.read(progress);
        },
        [this, opening](const JobInfo& info) { ended(opening, info); }, false, JobTurn::Queued);
}

void Openings::ready(const std::shared_ptr<Opening>& opening)
{
    render::PointIds ids;
    try {
        for (const Document* open : m_workspace.documents()) ids.take(open->store()->slotCount());
        ids.take(opening->store->slotCount());
    } catch (const Error& e) {
        m_workspace.cancel(opening->job);
        m_workspace.say(MessageKind::Error,
                        tr("%1 was not opened: %2").arg(opening->title, toQString(std::string(e.what()))));
        return;
    }
    Document& document = m_workspace.take(opening->session, opening->store);
    opening->document = &document;
    if (!opening->origin.isEmpty()) document.setOrigin(opening->origin);
    m_workspace.tie(document, opening->job);
    m_workspace.setActive(&document);
}

void Openings::ended(const std::shared_ptr<Opening>& opening, const JobInfo& info)
{
    std::erase(m_opening, opening);
    Document* const document = opening->document;
    const auto& documents = m_workspace.documents();
    const bool wanted = document && std::find(documents.begin(), documents.end(), document) != documents.end();
    if (info.state != JobState::Finished) {
        if (wanted) m_workspace.dropUnread(*document);
        if (info.state == JobState::Failed) m_workspace.say(MessageKind::Error, toQString(info.error));
        return;
    }
    if (!wanted) return;  // closed while its last points arrived
    m_workspace.finishLoading(*document, opening->result);
    tell(*document);
}

void Openings::tell(Document& document)
{
    const auto [sentence, details] = newsOf(document);
    if (!sentence.isEmpty()) m_workspace.say(MessageKind::Warning, sentence, details, &document);
}

}  // namespace punctum::ui
