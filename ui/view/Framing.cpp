// SPDX-License-Identifier: MIT
#include "ui/view/Framing.h"

#include "core/task/Progress.h"
#include "ui/basic/Text.h"
#include "ui/document/Document.h"
#include "ui/document/Workspace.h"
#include "ui/view/ViewFilter.h"
#include "ui/view/Viewport.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <memory>
#include <utility>

namespace punctum::ui
{

namespace
{

constexpr double kNeighbors = 20.0;  // times the largest file's extent
constexpr double kSpeck = 8.0;       // px: what is smaller cannot be seen

constexpr std::size_t kFewFiles = 50;     ///< more are looked at once for all that happens together
constexpr int kRefreshPause = 150;        // ms
constexpr std::size_t kToldOneByOne = 8;  ///< of more files that are open, only the active one's strays are told

bool same(const WorldBounds& a, const WorldBounds& b)
{
    return a.min == b.min && a.max == b.max;
}

}  // namespace

Framing::Framing(Workspace& workspace, const ViewFilter& filter, Viewport& viewport, QObject* parent)
    : QObject(parent), m_workspace(workspace), m_filter(filter), m_viewport(viewport)
{
    connect(&workspace, &Workspace::documentAdded, this, &Framing::documentAdded);
    connect(&workspace, &Workspace::documentLoaded, this, &Framing::documentLoaded);
    connect(&workspace, &Workspace::documentRemoved, this, &Framing::documentRemoved);
    connect(&workspace, &Workspace::documentStateChanged, this, [this] { refresh(nullptr); });
    connect(&workspace, &Workspace::activeChanged, this, [this](Document* document) {
        const auto found = m_camerasBefore.find(document);  // it has just been added
        if (found != m_camerasBefore.end() && found->second.second == m_viewport.userMoves()) refresh(document);
    });
    m_refresh.setSingleShot(true);
    m_refresh.setInterval(kRefreshPause);
    connect(&m_refresh, &QTimer::timeout, this, [this] {
        updateSceneBounds();
        const QPointer<Document> fit = std::exchange(m_refreshFit, nullptr);
        if (fit && m_refreshMoves == m_viewport.userMoves()) fitFor(*fit);
    });
}

void Framing::refresh(Document* fit)
{
    if (m_workspace.documents().size() <= kFewFiles) {
        updateSceneBounds();
        if (fit) fitFor(*fit);
        return;
    }
    if (fit) {
        m_refreshFit = fit;
        m_refreshMoves = m_viewport.userMoves();
    }
    if (!m_refresh.isActive()) m_refresh.start();
}

WorldBounds Framing::boundsOf(const Document& document) const
{
    // What was found holds as long as the points are where they were.
    const auto found = m_extents.find(&document);
    const bool known = found != m_extents.end() && same(found->second.all, document.bounds());
    return known ? found->second.typical : document.bounds();
}

void Framing::updateSceneBounds()
{
    WorldBounds all;
    for (const Document* document : m_workspace.documents()) all.include(boundsOf(*document));
    const auto& documents = m_workspace.documents();
    m_viewport.setSceneBounds(all, documents.empty() ? glm::dvec3(1.0) : documents.front()->viewStretch(all));
}

void Framing::fitFor(const Document& document)
{
    // Neighbors are shown together; of surveys far apart the active one, because both would be specks.
    WorldBounds all = boundsOf(document);
    double largest = 0.0;
    for (const Document* other : m_workspace.documents()) {
        const WorldBounds bounds = boundsOf(*other);
        all.include(bounds);
        if (!bounds.empty()) largest = std::max(largest, glm::length(bounds.max - bounds.min));
    }
    const bool together = all.empty() || glm::length(all.max - all.min) <= kNeighbors * largest;
    const Document* const active = m_workspace.active();
    if (!together && active && active != &document && showsAnything()) return;
    m_viewport.fitTo(together ? all : boundsOf(document), false);
    m_fitted = {};
    if (const auto found = m_extents.find(&document); found != m_extents.end()) m_fitted = found->second;
    m_fittedAll = false;
}

// -- what is shown

void Framing::find(const std::vector<Document*>& documents, JobTurn turn, Found found)
{
    struct Part {
        std::shared_ptr<PointCloud> cloud;
        RawBounds readable;
        glm::dvec3 stretch{1.0};
        Visibility visibility;
    };
    std::vector<Part> parts;
    const auto extent = std::make_shared<ShownExtent>();
    for (const Document* document : documents) {
        if (document->loading()) {
            // Its points are not there yet.
            extent->include({document->bounds(), document->bounds(), document->points(), 0});
            continue;
        }
        parts.push_back({document->cloud(), document->rawBounds(), document->viewStretch(document->bounds()),
                         m_filter.visibility(*document)});
    }
    m_workspace.startJob(
        tr("Fit"),
        [parts = std::move(parts), extent](Progress& progress) {
            for (const Part& part : parts) {
                const auto hidden = hiddenPoints(*part.cloud, part.visibility, progress);
                extent->include(shownExtent(*part.cloud, part.readable, hidden.get(), part.stretch, progress));
            }
        },
        [extent, found = std::move(found)](const JobInfo& info) {
            if (info.state == JobState::Finished) found(*extent);
        },
        true, turn);
}

void Framing::fitTo(const ShownExtent& extent)
{
    if (extent.points == 0) {
        m_workspace.say(MessageKind::Info, tr("No point is shown, so there is nothing to fit the view to."));
        return;
    }
    // Where all but the strays are shown already, they are what is asked for.
    m_fittedAll =
        extent.strays > 0 && m_viewport.fitted() && !m_fittedAll && same(m_fitted.typical, extent.typical);
    m_fitted = extent;
    m_viewport.fitTo(m_fittedAll ? extent.all : extent.typical);
}

void Framing::fitShown(const std::vector<Document*>& documents)
{
    if (documents.empty()) return;
    find(documents, JobTurn::AtOnce, [this, request = ++m_request](const ShownExtent& extent) {
        if (request == m_request) fitTo(extent);
    });
}

void Framing::fitAll()
{
    fitShown(m_workspace.documents());
}

void Framing::fitActive()
{
    if (Document* const active = m_workspace.active()) fitShown({active});
}

void Framing::removeStrays()
{
    Document* const active = m_workspace.active();
    if (active == nullptr || active->loading()) return;
    const auto ended = [this, target = QPointer<Document>(active)](const JobInfo& info,
                                                                   const EditOutcome& outcome) {
        if (!target || info.state == JobState::Cancelled) return;
        if (info.state == JobState::Failed)
            m_workspace.say(MessageKind::Error, toQString(info.error), {}, target);
        else if (outcome.changed == 0)
            m_workspace.say(MessageKind::Info,
                            tr("%1: no point lies far away from all the others.").arg(target->name()), {}, target);
        else
            m_workspace.say(MessageKind::Info,
                            outcome.changed == 1
                                ? tr("%1: one point far away was deleted. Undo brings it back.").arg(target->name())
                                : tr("%1: %2 far away were deleted. Undo brings them back.")
                                      .arg(target->name(), pointsText(outcome.changed)),
                            {}, target);
        if (info.state == JobState::Finished) fitShown({target});
    };
    m_workspace.edit(*active, tr("Remove strays"), {"strays", {}, nullptr}, ended);
}

bool Framing::showsAnything() const
{
    const QSize size = m_viewport.pictureSize();
    const auto& documents = m_workspace.documents();
    return std::any_of(documents.begin(), documents.end(), [&](const Document* document) {
        return m_viewport.camera().seenSize(boundsOf(*document), {size.width(), size.height()}) >= kSpeck;
    });
}

// -- files that come and go

void Framing::documentAdded(Document* document)
{
    const bool keep = std::exchange(m_keepOnce, false);
    // Where the view is to stay, it is as if the user had moved it since.
    m_camerasBefore[document] = {m_viewport.camera(), m_viewport.userMoves() - (keep ? 1 : 0)};
    refresh(keep ? nullptr : document);
}

void Framing::documentLoaded(Document* document)
{
    refresh(nullptr);
    // The header's box was only a first idea.
    const std::uint64_t moves = m_camerasBefore[document].second;
    m_camerasBefore.erase(document);
    find({document}, JobTurn::Queued,
         [this, moves, target = QPointer<Document>(document)](const ShownExtent& extent) {
             if (!target) return;
             m_extents[target] = extent;
             updateSceneBounds();
             if (moves == m_viewport.userMoves()) fitFor(*target);
             const bool few = m_workspace.documents().size() <= kToldOneByOne;
             if (extent.strays > 0 && (few || target == m_workspace.active()))
                 m_workspace.say(
                     MessageKind::Info,
                     extent.strays == 1
                         ? tr("%1: one point lies far away from all the others, outside the view. F shows it, too; "
                              "Process > Remove Strays deletes it.")
                               .arg(target->name())
                         : tr("%1: %2 lie far away from all the others, outside the view. F shows them, too; "
                              "Process > Remove Strays deletes them.")
                               .arg(target->name(), pointsText(extent.strays)));
         });
}

void Framing::documentRemoved(Document* document, bool openingFailed)
{
    m_extents.erase(document);
    updateSceneBounds();
    const auto found = m_camerasBefore.find(document);
    const auto before =
        found == m_camerasBefore.end() ? std::pair(render::Camera(), ~std::uint64_t(0)) : found->second;
    m_camerasBefore.erase(document);
    if (openingFailed && before.second == m_viewport.userMoves())
        m_viewport.setCamera(before.first);
    else if (m_workspace.active() && !showsAnything())  // of files far apart the one that was looked at is gone
        fitFor(*m_workspace.active());
}

}  // namespace punctum::ui
