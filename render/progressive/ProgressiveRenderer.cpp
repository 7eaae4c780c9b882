// SPDX-License-Identifier: MIT
#include "render/progressive/ProgressiveRenderer.h"

#include "core/task/Progress.h"
#include "render/progressive/Entry.h"
#include "render/scene/LayerLookup.h"
#include "render/scene/PointIds.h"
#include "render/store/Spacing.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>
#include <shared_mutex>

namespace punctum::render
{

namespace
{

/// px, while the spacing is guessed from a part of the points.
constexpr double kMostGuessedSize = 4.0;

/// Points of one step of attribute streaming: one or two milliseconds.
constexpr PointIndex kStreamPoints = 1 << 19;
/// Of each frame in motion while an attribute streams, beside what drawing takes: so that 100 M points are drawn on
/// two cores in frames of less than 33 ms.
constexpr double kStreamSeconds = 0.003;
/// Of a frame in which nothing but streaming happens, as all that is visible is up to date.
constexpr double kStreamAlone = 0.020;

/// What a device that keeps time is offered, as a multiple of what the last frames let expect: so that it decides,
/// and not much more is brought to it than it draws.
constexpr std::uint64_t kOffer = 4;
/// The first of it, by which it judges the rest: a share, and at most so many slots.
constexpr std::uint64_t kFirstShare = 32;
constexpr std::uint64_t kMostFirst = 1'000'000;

/// What a slot costs that is out of sight, next to one that is drawn.
constexpr double kUnseenCost = 0.01;

/// A lamp up and left of the eye, as maps have it: what is seen from the top is not all white then.
glm::vec3 lampOf(const Camera& camera)
{
    return glm::vec3(glm::normalize(camera.forward() + 0.55 * camera.right() - 0.55 * camera.up()));
}

}  // namespace

DisplaySettings::DisplaySettings()
{
    const auto& classes = asprsClasses();
    for (std::size_t k = 0; k < palette.size(); ++k) palette[k] = classes[k].color;
    classVisible.fill(true);
}

ProgressiveRenderer::ProgressiveRenderer(std::unique_ptr<RasterBackend> backend) : m_backend(std::move(backend)) {}

ProgressiveRenderer::~ProgressiveRenderer() = default;

void ProgressiveRenderer::setBackend(std::unique_ptr<RasterBackend> backend)
{
    m_backend = std::move(backend);
    m_imageThere = true;
    m_onDevice = false;
    m_cost.reset();
    m_colorCost.reset();
    m_resolveSeconds = 0;
    m_targetChanged = true;
}

ProgressiveRenderer::Entry* ProgressiveRenderer::find(const PointCloud& cloud) noexcept
{
    const auto it = std::find_if(m_entries.begin(), m_entries.end(),
                                 [&](const auto& entry) { return &entry->store->cloud() == &cloud; });
    return it == m_entries.end() ? nullptr : it->get();
}

void ProgressiveRenderer::addCloud(std::shared_ptr<PointStore> store)
{
    PointIds ids;  // whether there are enough for this one, too
    for (const auto& entry : m_entries) ids.take(entry->store->slotCount());
    ids.take(store->slotCount());
    auto entry = std::make_unique<Entry>();
    entry->store = std::move(store);
    applyDisplay(*entry);
    m_entries.push_back(std::move(entry));
    m_layersChanged = m_rangeNeeded = m_agreementNeeded = true;
}

void ProgressiveRenderer::removeCloud(const PointCloud& cloud)
{
    std::erase_if(m_entries, [&](const auto& entry) { return &entry->store->cloud() == &cloud; });
    m_layersChanged = m_rangeNeeded = true;
}

void ProgressiveRenderer::loadingEnded(const PointCloud& cloud, const RawBounds& bounds)
{
    Entry* const entry = find(cloud);
    if (entry == nullptr) return;
    entry->loading = false;
    const std::shared_lock lock(cloud.mutex());
    entry->store->setBounds(bounds);
    // Batches that were under way when the attribute was switched may have written the old one's words.
    if (entry->store->stale()) entry->store->markStale(nullptr);
    // Slots seen half-written are put right by drawing everything once more into a buffer made anew.
    m_viewChanged = m_rangeNeeded = true;
}

void ProgressiveRenderer::valuesChanged(const PointCloud& cloud, const ChangeNotice& notice)
{
    Entry* const entry = find(cloud);
    if (entry == nullptr) return;
    if (notice.kind == ChangeNotice::Kind::Deleted) {
        m_rangeNeeded = true;
        return;
    }
    const std::shared_lock lock(cloud.mutex());
    if (!entry->store->encoder()) return;
    const Attribute* const classes = cloud.findAttribute("Classification");
    const Attribute before = entry->store->shown();
    const Attribute* shown = cloud.findAttribute(before.name);
    if (notice.kind == ChangeNotice::Kind::Attributes) {
        if (shown != nullptr && shown->columns == before.columns) {
            // What is shown is as it was; but points are hidden by classes, which may be another column now.
            if (classes == nullptr || !notice.concerns(*classes)) return;
            entry->store->markStale(nullptr);
            if (!m_scene.allClassesVisible) m_redrawWhenFresh = true;
            m_resolveNeeded = m_visibleOutdated = true;
            return;
        }
        if (shown == nullptr) shown = cloud.findAttribute(firstAttribute(cloud, {0, cloud.size()}));
        entry->store->show(*shown);
        m_rangeNeeded = m_agreementNeeded = true;
    } else {
        const bool classesChanged = classes != nullptr && notice.concerns(*classes);
        const bool shownChanged = notice.concerns(before);
        if (!classesChanged && !shownChanged) return;
        entry->store->markStale(notice.points.get());
        if (shownChanged) m_rangeNeeded = true;
        if (classesChanged && !m_scene.allClassesVisible) m_redrawWhenFresh = true;
    }
    m_colors = {};
    m_resolveNeeded = m_visibleOutdated = true;
}

void ProgressiveRenderer::setPreview(const PointCloud& cloud, std::shared_ptr<const Preview> preview)
{
    Entry* const entry = find(cloud);
    if (entry == nullptr) return;
    {
        const std::shared_lock lock(cloud.mutex());
        entry->store->setPreview(std::move(preview));
    }
    storesChanged(StoreChange::Values);
}

void ProgressiveRenderer::hide(const PointCloud& cloud, const PointSet* points)
{
    Entry* const entry = find(cloud);
    if (entry == nullptr || (points == nullptr && !entry->store->hidesAny())) return;
    entry->store->hide(points);
    m_viewChanged = m_rangeNeeded = true;
}

void ProgressiveRenderer::storesChanged(StoreChange change)
{
    switch (change) {
        case StoreChange::Hidden:
            m_viewChanged = m_rangeNeeded = true;
            return;
        case StoreChange::Values:
            m_rangeNeeded = true;
            if (!m_scene.allClassesVisible) m_redrawWhenFresh = true;
            break;
        case StoreChange::Selection:
            break;
    }
    m_colors = {};
    m_resolveNeeded = m_visibleOutdated = true;
}

void ProgressiveRenderer::setSize(int width, int height)
{
    width = std::max(width, 1);
    height = std::max(height, 1);
    if (width == m_size.width && height == m_size.height) return;
    m_size.width = width;
    m_size.height = height;
    m_targetChanged = true;
}

void ProgressiveRenderer::setPart(std::optional<PicturePart> part, float eyeDomeExtent)
{
    if (part == m_part && eyeDomeExtent == m_partExtent) return;
    m_part = part;
    m_partExtent = eyeDomeExtent;
    m_viewChanged = true;
}

void ProgressiveRenderer::setCamera(const Camera& camera)
{
    if (camera == m_camera) return;
    m_camera = camera;
    m_viewChanged = true;
}

void ProgressiveRenderer::setDisplay(const DisplaySettings& display)
{
    if (display == m_display) return;
    const DisplaySettings before = std::exchange(m_display, display);
    if (before.samples != m_display.samples) m_targetChanged = true;
    if (before.sizing != m_display.sizing || before.pointSize != m_display.pointSize ||
        before.worldSize != m_display.worldSize || before.spacings != m_display.spacings ||
        before.round != m_display.round || before.classVisible != m_display.classVisible ||
        before.clip != m_display.clip || before.cuts != m_display.cuts)
        m_viewChanged = true;
    if (before.classVisible != m_display.classVisible || before.clip != m_display.clip) m_rangeNeeded = true;
    if (before.range != m_display.range || before.attribute != m_display.attribute) m_rangeNeeded = true;
    if (before.attribute != m_display.attribute) {
        for (const auto& entry : m_entries) applyDisplay(*entry);
        m_agreementNeeded = true;
    }
    m_resolveNeeded = m_visibleOutdated = true;
}

void ProgressiveRenderer::updateScene()
{
    m_size.samples = *std::find_if(kSampleCounts.rbegin(), kSampleCounts.rend() - 1,
                                   [&](int count) { return count <= m_display.samples; });
    m_scene.layers.clear();
    PointIds ids;
    Clip clip = m_display.clip;
    clip.planes.insert(clip.planes.end(), m_display.cuts.begin(), m_display.cuts.end());
    const PicturePart part = m_part.value_or(PicturePart{0, 0, m_size.width, m_size.height});
    WorldBounds all;
    for (const auto& entry : m_entries)
        all.include(entry->store->cloud().coordinates().toWorld(entry->store->bounds()));
    for (const auto& entry : m_entries) {
        m_scene.layers.push_back({entry->store.get(), ids.take(entry->store->slotCount()),
                                  makeProjection(m_camera, *entry->store, part, styleOf(*entry), all)});
        Layer& layer = m_scene.layers.back();
        layer.clip = makeClip(clip, *entry->store, layer.projection.reference);
        entry->weight = 1.0;
        // While a file loads the boxes still grow.
        if (entry->store->filled() < entry->store->cloud().size()) continue;
        const auto visible = std::make_shared<const VisibleStretches>(layer, m_size);
        entry->weight = std::min(1.0, visible->share() + kUnseenCost);
        if (!visible->all()) layer.visible = visible;
    }
    m_scene.classVisible = m_display.classVisible;
    m_scene.allClassesVisible =
        std::all_of(m_scene.classVisible.begin(), m_scene.classVisible.end(), [](bool visible) { return visible; });
}

PointStyle ProgressiveRenderer::styleOf(Entry& entry) const
{
    PointStyle style{m_display.leastPixels(), 0.0, m_display.round};
    if (m_display.sizing == PointSizing::World) style.size = m_display.worldSize;
    if (m_display.sizing != PointSizing::Density) return style;
    const PointIndex filled = entry.store->filled();
    const bool grown = filled > entry.filledAtSpacing + entry.filledAtSpacing / 2;
    if (grown || (filled != entry.filledAtSpacing && !entry.loading) || entry.spacingStretch != m_camera.stretch) {
        const std::shared_lock lock(entry.store->cloud().mutex());
        entry.spacing = pointSpacing(*entry.store, m_camera.stretch, m_entries.size());
        entry.filledAtSpacing = filled;
        entry.spacingStretch = m_camera.stretch;
    }
    style.size = entry.spacing * m_display.spacings;
    // Of a part of the points, the spacing is a guess, and larger than it will be: no blocks while a file loads.
    if (entry.loading) style.most = kMostGuessedSize;
    return style;
}

void ProgressiveRenderer::beginPass() noexcept
{
    for (const auto& entry : m_entries) {
        entry->drawn = entry->colored = 0;
        entry->filledAtStart = entry->store->filled();
    }
}

void ProgressiveRenderer::refreshVisible()
{
    if (!anyStale() || !std::exchange(m_visibleOutdated, false)) return;
    m_backend->visibleIds(m_visible);
    std::vector<std::vector<Slot>> slots(m_scene.layers.size());
    LayerLookup lookup(m_scene);
    for (const PointId id : m_visible) {
        const std::size_t layer = lookup.layerOf(id);
        slots[layer].push_back(id - m_scene.layers[layer].firstId);
    }
    for (std::size_t layer = 0; layer < m_entries.size(); ++layer) {
        PointStore& store = *m_entries[layer]->store;
        const std::shared_lock lock(store.cloud().mutex());
        store.refresh(slots[layer]);
    }
    m_colors = {};
    m_resolveNeeded = true;
}

void ProgressiveRenderer::streamAttributes(double deadline)
{
    bool fresh = true;
    for (const auto& entry : m_entries) {
        while (entry->store->stale() && now() < deadline) {
            const std::shared_lock lock(entry->store->cloud().mutex());
            entry->store->refreshNext(kStreamPoints);
        }
        fresh = fresh && !entry->store->stale();
    }
    if (fresh) wordsFresh();
}

/// Called in the frame that brings the last words, or finds that another renderer has.
void ProgressiveRenderer::wordsFresh() noexcept
{
    m_streaming = false;
    m_resolveNeeded = true;  // copies on devices get the rest of their words
    if (std::exchange(m_redrawWhenFresh, false)) m_viewChanged = true;
}

bool ProgressiveRenderer::anyStale() const noexcept
{
    return std::any_of(m_entries.begin(), m_entries.end(), [](const auto& e) { return e->store->stale(); });
}

void ProgressiveRenderer::beginGrown() noexcept
{
    for (const auto& entry : m_entries) {
        if (!entry->passDone() || entry->filledAtStart == entry->store->filled()) continue;
        entry->drawn = 0;
        m_colors = {};
        entry->filledAtStart = entry->store->filled();
    }
}

bool ProgressiveRenderer::partial() const noexcept
{
    return std::any_of(m_entries.begin(), m_entries.end(),
                       [](auto& e) { return e->drawn < e->store->slotCount(); });
}

void ProgressiveRenderer::fillTimed(double deadline)
{
    beginGrown();
    // The cloud that is furthest behind goes first, so that all converge together.
    std::vector<std::size_t> open;
    for (std::size_t k = 0; k < m_entries.size(); ++k)
        if (!m_entries[k]->passDone()) open.push_back(k);
    std::stable_sort(open.begin(), open.end(),
                     [&](std::size_t a, std::size_t b) { return m_entries[a]->share() < m_entries[b]->share(); });
    const double seconds = std::max(0.0, deadline - m_clockStarted);
    const std::uint64_t offer = kOffer * std::min<std::uint64_t>(m_cost.affordable(seconds), 0xFFFFFFFFu);
    std::uint64_t left = offer;
    for (const std::size_t k : open) {
        const Entry& entry = *m_entries[k];
        const Slot slots = entry.store->slotCount(), window = entry.store->order().windowSize();
        Slot at = entry.cursor;
        std::uint64_t undrawn = slots - entry.drawn;
        const auto take = [&](std::uint64_t wish) {
            wish = (wish + window - 1) / window * window;
            const auto count = Slot(std::min<std::uint64_t>({wish, undrawn, slots - at}));
            m_timedRuns.push_back({k, {at, at + count}, window});
            at = at + count == slots ? 0 : at + count;
            undrawn -= count;
            left -= std::min<std::uint64_t>(left, std::uint64_t(std::ceil(count * entry.weight)));
        };
        const auto slotsFor = [&](std::uint64_t drawn) {
            return std::uint64_t(std::min(double(drawn) / entry.weight, double(slots)));
        };
        if (m_timedRuns.empty())
            take(std::clamp<std::uint64_t>(slotsFor(offer / kFirstShare), kLeastRun, kMostFirst));
        while (left > 0 && undrawn > 0) take(slotsFor(left));
    }
    if (!m_timedRuns.empty()) m_backend->drawTimed(m_scene, m_timedRuns, seconds);
}

void ProgressiveRenderer::countTimed()
{
    if (m_timedRuns.empty()) return;
    const RasterBackend::Timed timed = m_backend->timed();
    m_fillDone = m_clockStarted + timed.done;
    m_passes.reproject = timed.before;
    m_passes.fill = timed.seconds;
    std::uint64_t left = timed.drawn;
    double weighted = 0;
    for (const RasterBackend::Run& run : m_timedRuns) {
        Entry& entry = *m_entries[run.layer];
        const auto count = Slot(std::min<std::uint64_t>(run.range.size(), left));
        if (count == 0) break;
        entry.cursor = run.range.first + count == entry.store->slotCount() ? 0 : run.range.first + count;
        entry.drawn += count;
        m_filled += count;
        weighted += count * entry.weight;
        left -= count;
    }
    m_cost.observe(std::uint64_t(std::ceil(weighted)), timed.seconds);
    m_timedRuns.clear();
}

void ProgressiveRenderer::fill(double deadline)
{
    if (m_pointsAFrame == 0 && m_backend->keepsTime()) return fillTimed(deadline);
    for (bool first = true;; first = false) {
        beginGrown();
        // The cloud that is furthest behind goes next, so that all converge together.
        std::size_t next = m_entries.size();
        double least = 1.0;
        for (std::size_t k = 0; k < m_entries.size(); ++k) {
            const Entry& entry = *m_entries[k];
            if (entry.passDone()) continue;
            if (next == m_entries.size() || entry.share() < least) {
                next = k;
                least = entry.share();
            }
        }
        const double started = now();
        const bool spent = m_pointsAFrame > 0 ? m_filled >= m_pointsAFrame : started >= deadline;
        if (next == m_entries.size() || (!first && spent)) return;

        Entry& entry = *m_entries[next];
        const Slot slots = entry.store->slotCount(), window = entry.store->order().windowSize();
        const auto affordable = std::uint64_t(
            std::min(double(m_cost.affordable(std::max(0.0, deadline - started))) / entry.weight, double(slots)));
        std::uint64_t run =
            m_pointsAFrame > 0 ? m_pointsAFrame - m_filled : std::max<std::uint64_t>(affordable, kLeastRun);
        // A picture that is nearly full is made full: one more frame for the rest would cost more.
        if (m_pointsAFrame == 0 && run + run / 4 >= slots - entry.drawn) run = slots;
        run = (run + window - 1) / window * window;
        const Slot count = Slot(std::min<std::uint64_t>({run, slots - entry.drawn, slots - entry.cursor}));
        m_backend->draw(m_scene, next, {entry.cursor, entry.cursor + count});
        m_backend->finish();
        m_cost.observe(std::uint64_t(std::ceil(count * entry.weight)), now() - started);
        entry.cursor = entry.cursor + count == slots ? 0 : entry.cursor + count;
        entry.drawn += count;
        m_filled += count;
    }
}

ResolveSettings ProgressiveRenderer::colorSettings() const
{
    ResolveSettings settings;
    for (const auto& entry : m_entries) {
        LayerColors colors;
        if (const auto encoder = entry->store->encoder()) {
            colors.kind = encoder->kind();
            colors.low = float(entry->range.first - encoder->bias());
            colors.high = float(entry->range.second - encoder->bias());
            colors.marked = encoder->selection() != nullptr;
        }
        settings.layers.push_back(colors);
    }
    settings.colorMap = banded(chosenColorMap(m_display.colorMap, shownAttribute()).table, m_display.bands);
    settings.palette = m_display.palette;
    settings.normals = m_display.normals;
    settings.eye = glm::vec3(m_camera.forward());
    settings.light = lampOf(m_camera);
    settings.tone = toneTable(m_display.tone);
    settings.backgroundTop = m_display.backgroundTop;
    settings.backgroundBottom = m_display.backgroundBottom;
    if (m_part) settings.rows = {m_part->y, m_part->height};
    if (!m_part || m_partExtent > 0)
        settings.eyeDome = {float(m_display.eyeDome), !m_camera.orthographic, m_display.eyeDomeReach(),
                            m_part ? m_partExtent : 0.0f};
    settings.closeHoles = m_display.fillHoles && partial();
    return settings;
}

bool ProgressiveRenderer::ready() const noexcept
{
    return !m_targetChanged && !m_layersChanged && !m_viewChanged && !m_resolveNeeded && !m_streaming &&
           std::all_of(m_entries.begin(), m_entries.end(), [&](const auto& e) {
               return e->complete() && !e->store->stale() &&
                      (!m_display.averaged || e->colored == e->store->slotCount());
           });
}

bool ProgressiveRenderer::converged() const noexcept
{
    return ready();
}

PointIndex ProgressiveRenderer::pointsInSight() const noexcept
{
    double points = 0;
    for (const Layer& layer : m_scene.layers)
        points += double(layer.store->cloud().size()) * (layer.visible ? layer.visible->share() : 1.0);
    return PointIndex(std::llround(points));
}

void ProgressiveRenderer::judgeColors()
{
    for (const auto& entry : m_entries) {
        PointStore& store = *entry->store;
        if (!store.encoder() || !store.colorsMisjudged()) continue;
        const std::shared_lock lock(store.cloud().mutex());
        store.show(store.shown());
        m_resolveNeeded = m_visibleOutdated = true;
    }
}

FrameReport ProgressiveRenderer::renderFrame(double budget)
{
    const double started = now();
    FrameReport report;
    for (const auto& entry : m_entries) {
        PointStore& store = *entry->store;
        // While loading the range follows the data, each time half as much again has come.
        if (entry->loading && store.filled() > entry->filledAtRange + entry->filledAtRange / 2)
            m_rangeNeeded = true;
    }
    agreeOnAttribute();
    judgeColors();
    if (!anyStale() && (m_streaming || m_redrawWhenFresh)) wordsFresh();
    if (ready() && !m_rangeNeeded) {
        report.converged = true;
        report.share = 1.0;
        return report;
    }
    m_filled = 0;
    m_timedRuns.clear();
    m_passes = {};
    const RasterBackend::Traffic before = m_backend->traffic();
    m_clockStarted = now();
    if (m_backend->keepsTime()) m_backend->startClock();
    const bool viewChanged = m_targetChanged || m_layersChanged || m_viewChanged;
    if (viewChanged) {
        m_visibleOutdated = m_resolveNeeded = true;
        updateScene();
        if (m_targetChanged) {
            m_backend->setTarget(m_size);
        } else if (m_layersChanged) {
            m_backend->clear();
        } else {
            m_backend->reproject(m_scene);
        }
        m_targetChanged = m_layersChanged = m_viewChanged = false;
        beginPass();
        // Where the device keeps the time it is told apart there.
        if (m_pointsAFrame > 0 || !m_backend->keepsTime()) m_backend->finish();
        m_passes.reproject = now() - m_clockStarted;
    }
    const bool streaming = m_streaming = anyStale();
    // Where making the picture takes most of a frame, a still one would hardly come on: half of the time is for
    // points.
    const double deadline =
        std::max(started + budget - m_resolveSeconds, viewChanged || budget <= 0 ? 0.0 : now() + m_resolveSeconds);
    // While an attribute streams, filling and streaming share what is left of the frame.
    const double fillStarted = now();
    fill(streaming ? now() + (deadline - now()) / 2 : deadline);
    m_passes.fill = now() - fillStarted;
    const bool filling = m_filled > 0 || !m_timedRuns.empty();
    if (filling) m_visibleOutdated = m_resolveNeeded = true;
    const bool refreshed = m_visibleOutdated;
    const double streamStarted = now();
    refreshVisible();
    if (streaming) {
        // A still picture in its new colors is shown first.
        const bool alone = !filling && !viewChanged;
        if (!alone)
            streamAttributes(std::max(deadline, now() + kStreamSeconds));
        else if (!refreshed)
            streamAttributes(started + kStreamAlone);
    }
    m_passes.stream = now() - streamStarted;
    if (m_rangeNeeded) {
        updateRange();
        m_resolveNeeded = true;
    }
    const ResolveSettings settings = colorSettings();
    if (m_display.averaged && std::all_of(m_entries.begin(), m_entries.end(),
                                          [](auto& e) { return e->complete() && !e->store->stale(); }))
        addColors(settings, deadline);
    // While all that is seen is up to date and the rest streams, the picture stays as it is.
    if (m_resolveNeeded) resolveImage(settings);
    report.filled = m_filled;

    std::uint64_t drawn = 0, slots = 0;
    for (const auto& entry : m_entries) {
        drawn += entry->drawn;
        slots += entry->store->slotCount();
    }
    report.share = slots == 0 ? 1.0 : double(drawn) / double(slots);
    report.converged = ready();
    report.passes = m_passes;
    const RasterBackend::Traffic after = m_backend->traffic();
    report.bytesUp = after.up - before.up;
    report.bytesDown = after.down - before.down;
    report.seconds = now() - started;
    return report;
}

FrameReport ProgressiveRenderer::renderBruteForce()
{
    const double started = now();
    FrameReport report;
    agreeOnAttribute();
    judgeColors();
    updateScene();
    for (Layer& layer : m_scene.layers) layer.visible = nullptr;
    if (m_backend->target() == m_size)
        m_backend->clear();
    else
        m_backend->setTarget(m_size);
    m_targetChanged = m_layersChanged = m_viewChanged = false;
    beginPass();
    for (std::size_t k = 0; k < m_entries.size(); ++k) {
        Entry& entry = *m_entries[k];
        const Slot slots = entry.store->slotCount();
        m_backend->draw(m_scene, k, {0, slots});
        entry.drawn = slots;
        entry.cursor = 0;
        report.filled += slots;
    }
    m_backend->finish();
    m_visibleOutdated = true;
    refreshVisible();
    if (m_rangeNeeded) updateRange();
    const ResolveSettings settings = colorSettings();
    if (m_display.averaged) addColors(settings, std::numeric_limits<double>::infinity());
    resolveImage(settings);
    report.share = 1.0;
    report.converged = ready();
    report.seconds = now() - started;
    return report;
}

void ProgressiveRenderer::setSelection(const PointCloud& cloud, std::shared_ptr<const PointSet> selection)
{
    Entry* const entry = find(cloud);
    if (entry == nullptr) return;
    const std::shared_lock lock(cloud.mutex());
    entry->store->setSelection(std::move(selection));
    m_colors = {};
    m_resolveNeeded = m_visibleOutdated = true;
}

PointSet ProgressiveRenderer::visiblePoints(const PointCloud& cloud)
{
    PointSet points(cloud.size());
    if (m_targetChanged || m_layersChanged) return points;
    for (std::size_t layer = 0; layer < m_entries.size(); ++layer) {
        const PointStore& store = *m_entries[layer]->store;
        if (&store.cloud() != &cloud) continue;
        const PointId first = m_scene.layers[layer].firstId;
        m_backend->visibleIds(m_visible);
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, m_visible.size(), 1 << 14), [&](const auto& r) {
            for (std::size_t k = r.begin(); k != r.end(); ++k) {
                const PointId slot = m_visible[k] - first;  // of other clouds: wraps round, and is too large
                if (slot >= store.slotCount()) continue;
                const PointIndex i = store.order().indexOf(slot);
                if (i >= points.size()) continue;
                std::atomic_ref<std::uint64_t> word(points.words()[i / 64]);
                word.fetch_or(std::uint64_t(1) << (i % 64), std::memory_order_relaxed);
            }
        });
    }
    return points;
}

PictureProjection ProgressiveRenderer::projectionOf(const PointCloud& cloud) const
{
    for (const auto& entry : m_entries) {
        if (&entry->store->cloud() != &cloud) continue;
        const TargetSize size = m_backend->target();
        const LayerProjection p = makeProjection(m_camera, *entry->store, size);
        const LocalFrame& frame = entry->store->frame();
        const double step = 1 << frame.shift;  // raw units of a local one
        const auto row = [step](const glm::vec4& r) { return glm::dvec4(glm::dvec3(r) / step, r.w); };
        return {frame.toRaw(glm::dvec3(p.reference)),
                row(p.rowX),
                row(p.rowY),
                row(p.rowD),
                p.perspective,
                p.nearDepth};
    }
    return {};
}

std::optional<PickResult> ProgressiveRenderer::pick(int x, int y, int radius)
{
    if (m_targetChanged || m_layersChanged || m_entries.empty()) return std::nullopt;
    const auto hit = m_backend->pick(x, y, radius);
    if (!hit) return std::nullopt;
    LayerLookup lookup(m_scene);
    const std::size_t layer = lookup.layerOf(hit->id);
    const PointStore& store = *m_entries[layer]->store;
    const PointIndex index = store.order().indexOf(hit->id - m_scene.layers[layer].firstId);
    if (index >= store.cloud().size()) return std::nullopt;
    return PickResult{layer, index, store.cloud().world(index)};
}

}  // namespace punctum::render
