// SPDX-License-Identifier: MIT
#include "ui/select/Selection.h"

#include "core/edit/History.h"
#include "core/expression/Condition.h"
#include "core/neighbors/KdOrder.h"
#include "core/task/Progress.h"
#include "ui/basic/Text.h"
#include "ui/document/Workspace.h"
#include "ui/view/ViewFilter.h"
#include "ui/view/ViewRenderer.h"
#include "ui/view/ViewSettings.h"

#include <algorithm>
#include <shared_mutex>
#include <utility>

namespace punctum::ui
{

Selection::Selection(Workspace& workspace, ViewRenderer& renderer, const ViewSettings& settings,
                     const ViewFilter& filter, QObject* parent)
    : QObject(parent), m_workspace(workspace), m_renderer(renderer), m_settings(settings), m_filter(filter)
{
    connect(&m_workspace, &Workspace::documentRemoved, this, [this](Document* document) {
        m_states.erase(document);
        m_steps.erase(document);
        emit changed();
    });
    connect(&m_workspace, &Workspace::cloudChanged, this,
            [this](const Document* document, const ChangeNotice& notice) {
                if (notice.kind == ChangeNotice::Kind::Deleted && document == active() && points(document))
                    dropDeleted();
            });
    connect(&m_workspace, &Workspace::activeChanged, this, [this] {
        abandon();
        emit changed();
    });
}

Document* Selection::active() const
{
    Document* const document = m_workspace.active();
    return document && !document->loading() ? document : nullptr;
}

void Selection::setMode(SelectMode mode)
{
    m_mode = mode;
    emit settingsChanged();
}

void Selection::setDepth(Depth depth)
{
    m_depth = depth;
    emit settingsChanged();
}

void Selection::setSlabThickness(double units)
{
    m_slab = std::max(units, 0.0);
    emit settingsChanged();
}

Selection::State Selection::state(const Document* document) const
{
    const auto found = m_states.find(document);
    return found == m_states.end() ? State{} : found->second;
}

std::shared_ptr<const PointSet> Selection::points(const Document* document) const
{
    return state(document).points;
}

PointIndex Selection::count() const
{
    return state(m_workspace.active()).count;
}

PointIndex Selection::hiddenCount() const
{
    return state(m_workspace.active()).hidden;
}

Selection::WhatTouchable Selection::touchable(const std::vector<ClipPlane>& cuts) const
{
    Touchable touchable;
    for (unsigned code = 0; code < 256; ++code) touchable.classes[code] = !m_settings.classLocked(code);
    const Document* const document = active();
    Visibility visibility = document ? m_filter.visibility(*document) : Visibility();
    visibility.clip.planes.insert(visibility.clip.planes.end(), cuts.begin(), cuts.end());
    return [touchable, visibility = std::move(visibility)](const PointCloud& cloud, const PointSet& among,
                                                           Progress& progress) {
        Touchable all = touchable;
        all.hidden = hiddenPoints(cloud, visibility, progress, &among);
        return all;
    };
}

// -- shapes

void Selection::begin(SelectMode mode, ViewRenderer* view, std::vector<ClipPlane> cuts)
{
    m_drawing = true;
    m_drawMode = mode;
    m_drawView = view;
    m_drawCuts = std::move(cuts);
    m_base = std::make_shared<Base>();
    m_shot.reset();
}

void Selection::viewMoved()
{
    m_shot.reset();
}

void Selection::draw(ScreenMask mask)
{
    if (m_drawing) askShape(std::move(mask), true);
}

void Selection::finish(ScreenMask mask)
{
    if (!std::exchange(m_drawing, false)) return;
    askShape(std::move(mask), false);
    m_shot.reset();
}

void Selection::abandon()
{
    if (!std::exchange(m_drawing, false)) return;
    m_shot.reset();
    std::erase_if(m_tasks, [this](const Task& task) { return task.base == m_base; });
    ++m_generation;
    if (m_job != 0) m_workspace.cancel(m_job);
    if (!m_base->known) return;  // nothing of it has been shown
    if (Document* const document = active()) publish(*document, m_base->state);
}

void Selection::askShape(ScreenMask mask, bool live)
{
    if (!active()) return;
    const bool none = !m_shot || (m_shot->answered && !m_shot->view);
    if (none) m_shot = takeShot(m_drawView ? *m_drawView : m_renderer);
    Task task;
    task.title = tr("Select");
    task.live = live;
    task.base = m_base;
    task.shot = m_shot;
    const auto find = [mask = std::move(mask), depth = m_depth, slab = m_slab](const ViewSnapshot& view,
                                                                               Progress& progress) {
        Region region;
        region.mask = mask;
        region.projection = view.projection;
        if (depth == Depth::Slab) {
            region.nearest = view.pivotDepth - slab / 2;
            region.furthest = view.pivotDepth + slab / 2;
        }
        PointSet found = pointsIn(region, *view.cloud, {}, progress);
        if (depth == Depth::Visible) combine(found, *view.visible, SelectMode::Intersect);
        return found;
    };
    task.work = putTogether(m_drawMode, touchable(m_drawCuts), find);
    ask(std::move(task));
}

Selection::Work Selection::putTogether(SelectMode mode, WhatTouchable touchable, Find find)
{
    return [mode, touchable = std::move(touchable), find = std::move(find)](
               const std::shared_ptr<const PointSet>& before, const ViewSnapshot& view, Progress& progress) {
        PointSet found = find(view, progress);
        keepTouchable(found, *view.cloud, touchable(*view.cloud, found, progress), progress);
        PointSet all = before && mode != SelectMode::Replace ? *before : PointSet(found.size());
        combine(all, found, mode);
        return all;
    };
}

// -- without a shape

void Selection::askFound(const QString& title, SelectMode mode, Find find)
{
    Task task;
    task.title = title;
    task.work = putTogether(mode, touchable(), std::move(find));
    ask(std::move(task));
}

void Selection::askNeighbors(const QString& title,
                             std::function<PointSet(const PointSet&, const KdOrder&, Progress&)> change)
{
    Task task;
    task.title = title;
    task.neighbors = true;
    if (!points(active())) return;
    task.work = [touchable = touchable(), change = std::move(change)](
                    const std::shared_ptr<const PointSet>& before, const ViewSnapshot& view, Progress& progress) {
        const auto places = KdOrder::of(*view.cloud, progress);
        PointSet all = change(*before, *places, progress);
        keepTouchable(all, *view.cloud, touchable(*view.cloud, all, progress), progress);
        return all;
    };
    ask(std::move(task));
}

void Selection::dropDeleted()
{
    Task task;
    task.title = tr("Select");
    task.kind = Kind::Follow;
    task.work = [](const std::shared_ptr<const PointSet>& before, const ViewSnapshot& view, Progress&) {
        PointSet all = before ? *before : PointSet(view.cloud->size());
        if (const auto deleted = deletedPoints(*view.cloud)) all.remove(*deleted);
        return all;
    };
    ask(std::move(task));
}

void Selection::clear()
{
    Document* const document = active();
    if (!document || !points(document)) return;
    m_tasks.clear();
    ++m_generation;
    noteStep(*document, Kind::New, tr("Clear the selection"), state(document));
    publish(*document, {});
}

void Selection::invert()
{
    Task task;
    task.title = tr("Invert the selection");
    task.work = [touchable = touchable()](const std::shared_ptr<const PointSet>& before, const ViewSnapshot& view,
                                          Progress& progress) {
        PointSet all = before ? *before : PointSet(view.cloud->size());
        all.invert();
        keepTouchable(all, *view.cloud, touchable(*view.cloud, all, progress), progress);
        return all;
    };
    ask(std::move(task));
}

void Selection::selectAll()
{
    askFound(tr("Select all"), m_mode, [](const ViewSnapshot& view, Progress&) {
        PointSet all(view.cloud->size());
        all.invert();
        return all;
    });
}

void Selection::selectByRule(const QString& text)
{
    Document* const document = active();
    if (!document) return;
    // The list of attributes is the document's own copy: the cloud itself is bound in the job, where waiting is
    // allowed.
    expression::Condition::check(text.toStdString());
    askCondition(text, m_mode);
}

void Selection::selectClass(unsigned code, SelectMode mode)
{
    askCondition(QStringLiteral("Classification == %1").arg(code), mode);
}

void Selection::selectFound(const QString& title, std::function<PointSet(const PointCloud&, Progress&)> find)
{
    if (!active()) return;
    askFound(title, m_mode, [find = std::move(find)](const ViewSnapshot& view, Progress& progress) {
        return find(*view.cloud, progress);
    });
}

void Selection::askCondition(const QString& text, SelectMode mode)
{
    askFound(tr("Select by rule"), mode, [text](const ViewSnapshot& view, Progress& progress) {
        return *expression::select(*view.cloud, expression::Condition(text.toStdString(), *view.cloud), progress);
    });
}

void Selection::grow(double distance)
{
    askNeighbors(tr("Grow the selection"), [distance](const PointSet& points, const KdOrder& order, Progress& p) {
        return grown(points, order, distance, p);
    });
}

void Selection::shrink(double distance)
{
    askNeighbors(tr("Shrink the selection"), [distance](const PointSet& points, const KdOrder& order, Progress& p) {
        return shrunk(points, order, distance, p);
    });
}

void Selection::connectNeighbors(double distance)
{
    askNeighbors(tr("Select connected points"),
                 [distance](const PointSet& points, const KdOrder& order, Progress& p) {
                     return connected(points, order, distance, p);
                 });
}

// -- one after the other

std::shared_ptr<Selection::Shot> Selection::takeShot(ViewRenderer& view)
{
    auto shot = std::make_shared<Shot>();
    view.snapshot(active()->cloud(), this, [this, shot](const std::shared_ptr<const ViewSnapshot>& seen) {
        shot->answered = true;
        shot->view = seen;
        startNext();
    });
    return shot;
}

void Selection::ask(Task task)
{
    task.document = active();
    if (!task.document) return;
    if (!task.base) task.base = std::make_shared<Base>();
    // a newer shape replaces one that nobody has begun
    if (!m_tasks.empty() && m_tasks.back().live) m_tasks.pop_back();
    m_tasks.push_back(std::move(task));
    startNext();
}

void Selection::startNext()
{
    while (m_job == 0 && !m_tasks.empty()) {
        Task& next = m_tasks.front();
        const bool wanted = next.document && next.document == active();
        if (wanted && !next.shot) next.shot = takeShot(m_renderer);
        if (wanted && !next.shot->answered) return;
        Task task = std::move(next);
        m_tasks.pop_front();
        if (wanted && task.shot->view)
            run(std::move(task));
        else if (wanted && !task.live)
            m_workspace.say(
                MessageKind::Warning,
                tr("Nothing was selected, because the view that the shape was drawn in is gone. Draw it "
                   "once more."));
    }
}

void Selection::run(Task task)
{
    struct Result : State {
        bool same = false;                ///< as the selection of before
        PointIndex joined = 0, left = 0;  ///< where it is told
    };
    const auto result = std::make_shared<Result>();
    m_running = task.kind;
    const std::uint64_t generation = m_generation;
    if (!std::exchange(task.base->known, true)) task.base->state = state(task.document);
    m_job = m_workspace.startJob(
        task.title,
        [view = task.shot->view, result, neighbors = task.neighbors, work = std::move(task.work),
         before = task.base->state.points](Progress& progress) {
            const auto points = std::make_shared<PointSet>(work(before, *view, progress));
            result->count = points->count();
            result->hidden = countWithout(*points, *view->visible);
            if (result->count != 0) result->points = points;
            result->same = before ? *before == *points : result->count == 0;
            if (!neighbors || !before) return;
            result->joined = countWithout(*points, *before);
            result->left = countWithout(*before, *points);
        },
        [this, result, generation, target = task.document, kind = task.kind, live = task.live, title = task.title,
         neighbors = task.neighbors, base = task.base](const JobInfo& info) {
            m_job = 0;
            if (info.state == JobState::Failed) m_workspace.say(MessageKind::Error, toQString(info.error));
            if (info.state == JobState::Finished && target && generation == m_generation) {
                if (!live && (kind != Kind::New || !result->same)) noteStep(*target, kind, title, base->state);
                publish(*target, *result);
                if (neighbors) emit neighborsTaken(result->joined, result->left);
            }
            emit changed();
            startNext();
        },
        true);
}

void Selection::publish(Document& document, State state)
{
    m_renderer.setSelection(document.cloud(), state.points);
    if (state.points)
        m_states[&document] = std::move(state);
    else
        m_states.erase(&document);
    emit changed();
}

// -- steps

std::size_t Selection::asked(Kind kind) const
{
    const auto waiting =
        std::count_if(m_tasks.begin(), m_tasks.end(), [kind](const Task& task) { return task.kind == kind; });
    return std::size_t(waiting) + (m_job != 0 && m_running == kind ? 1 : 0);
}

const SelectionSteps::Step* Selection::nextUndo() const
{
    const auto found = m_steps.find(m_workspace.active());
    return found == m_steps.end() ? nullptr : found->second.undo(asked(Kind::Undo));
}

const SelectionSteps::Step* Selection::nextRedo() const
{
    const auto found = m_steps.find(m_workspace.active());
    return found == m_steps.end() ? nullptr : found->second.redo(asked(Kind::Redo));
}

void Selection::askStep(Kind kind)
{
    const SelectionSteps::Step* const step = kind == Kind::Undo ? nextUndo() : nextRedo();
    if (!step) return;
    Task task;
    task.title = step->name;
    task.kind = kind;
    task.work = [kept = *step->kept](const std::shared_ptr<const PointSet>&, const ViewSnapshot& view, Progress&) {
        const auto points = kept.points();
        PointSet all = points ? *points : PointSet(view.cloud->size());
        if (const auto deleted = deletedPoints(*view.cloud)) all.remove(*deleted);
        return all;
    };
    ask(std::move(task));
}

std::shared_ptr<KeptSelection> Selection::keep(const Document& document, std::shared_ptr<const PointSet> points)
{
    auto kept = std::make_shared<KeptSelection>();
    kept->plain = std::move(points);
    if (!kept->plain) return kept;
    const auto packed = std::make_shared<std::shared_ptr<const PackedSet>>();
    m_workspace.startJob(
        tr("Select"),
        [points = kept->plain, packed](Progress&) {
            auto small = std::make_shared<const PackedSet>(*points);
            if (small->bytes() < points->words().size_bytes()) *packed = std::move(small);
        },
        [this, kept, packed, &document](const JobInfo&) {
            if (*packed) {
                kept->packed = *packed;
                kept->plain = nullptr;
            }
            if (const auto found = m_steps.find(&document); found != m_steps.end()) found->second.limit();
        },
        true);
    return kept;
}

void Selection::noteStep(Document& document, Kind kind, const QString& title, const State& before)
{
    SelectionSteps& steps = m_steps[&document];
    switch (kind) {
        case Kind::New:
            return steps.push({title, document.history().position(), keep(document, before.points)});
        case Kind::Undo:
            return steps.moveBack(keep(document, before.points));
        case Kind::Redo:
            return steps.moveOn(keep(document, before.points));
        case Kind::Follow:
            return;
    }
}

}  // namespace punctum::ui
