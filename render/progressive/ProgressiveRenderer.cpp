// SPDX-License-Identifier: MIT
#include "render/progressive/ProgressiveRenderer.h"

#include "render/progressive/Clock.h"
#include "render/scene/PointIds.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <bitset>
#include <cmath>
#include <limits>
#include <mutex>
#include <shared_mutex>

namespace punctum::render
{

namespace
{

/// Of each frame in motion while an attribute streams, beside what drawing takes: so that 100 M points are drawn on
/// two cores in frames of less than 33 ms.
constexpr double kStreamSeconds = 0.003;
/// Of a frame in which nothing but streaming happens, as all that is visible is up to date.
constexpr double kStreamAlone = 0.020;
/// Of a frame of a still view that is not full yet, as a multiple: making the picture costs as much as drawing
/// millions of points, and nobody waits for the next one as in motion.
constexpr double kStillFrame = 2.0;
/// What is in sight of a cloud beyond memory is drawn again while it is read: in so many steps, and when nothing
/// more has come for so many seconds.
constexpr double kStepsInSight = 4.0;
constexpr double kNothingMore = 0.1;

/// Whether a point gives way to the surface that is made of its class: selected ones do not.
bool isReplaced(const PointStore& store, const LayerColors& colors, Slot slot, const std::bitset<256>& classes)
{
    if (!classes[store.classes()[slot]]) return false;
    if (!colors.marked) return true;
    const bool marked = (store.words()[slot] & selectedBit(colors.kind)) != 0;
    return marked == (colors.kind == WordKind::Color);  // see selectedBit()
}

}  // namespace

ProgressiveRenderer::ProgressiveRenderer(std::unique_ptr<RasterBackend> backend) : m_backend(std::move(backend)) {}

ProgressiveRenderer::~ProgressiveRenderer() = default;

void ProgressiveRenderer::setBackend(std::unique_ptr<RasterBackend> backend)
{
    m_backend = std::move(backend);
    m_picture.forgetBackend();
    m_scheduler.forgetCosts();
    m_targetChanged = true;
}

ViewCloud* ProgressiveRenderer::find(const PointCloud& cloud) noexcept
{
    const auto it = std::find_if(m_clouds.begin(), m_clouds.end(),
                                 [&](const auto& entry) { return &entry->store->cloud() == &cloud; });
    return it == m_clouds.end() ? nullptr : it->get();
}

void ProgressiveRenderer::addCloud(std::shared_ptr<PointStore> store)
{
    PointIds ids;  // whether there are enough for this one, too
    for (const auto& entry : m_clouds) ids.take(entry->store->slotCount());
    ids.take(store->slotCount());
    auto entry = std::make_unique<ViewCloud>();
    entry->store = std::move(store);
    entry->arranged = entry->store->arranged();
    applyDisplay(*entry);
    m_clouds.push_back(std::move(entry));
    m_layersChanged = true;
    m_legend.attributesChanged();
}

void ProgressiveRenderer::removeCloud(const PointCloud& cloud)
{
    std::erase_if(m_clouds, [&](const auto& entry) { return &entry->store->cloud() == &cloud; });
    m_layersChanged = true;
    m_legend.valuesChanged();
}

void ProgressiveRenderer::loadingEnded(const PointCloud& cloud, const RawBounds& bounds)
{
    ViewCloud* const entry = find(cloud);
    if (entry == nullptr) return;
    entry->loading = false;
    const std::shared_lock lock(cloud.mutex());
    entry->store->setBounds(bounds);
    // Batches that were under way when the attribute was switched may have written the old one's words.
    if (entry->store->stale()) entry->store->markStale(nullptr);
    // Slots seen half-written are put right by drawing everything once more into a buffer made anew.
    m_viewChanged = true;
    m_legend.valuesChanged();
}

void ProgressiveRenderer::valuesChanged(const PointCloud& cloud, const ChangeNotice& notice)
{
    ViewCloud* const entry = find(cloud);
    if (entry == nullptr) return;
    if (notice.kind == ChangeNotice::Kind::Deleted) {
        m_legend.valuesChanged();
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
            if (!m_scene.allClassesVisible) m_words.redrawAfter();
            outdateWords();
            return;
        }
        if (shown == nullptr) shown = cloud.findAttribute(firstAttribute(cloud, {0, cloud.size()}));
        entry->store->show(*shown);
        m_legend.attributesChanged();
    } else {
        const bool classesChanged = classes != nullptr && notice.concerns(*classes);
        const bool shownChanged = notice.concerns(before);
        if (!classesChanged && !shownChanged) return;
        entry->store->markStale(notice.points.get());
        if (shownChanged) m_legend.valuesChanged();
        if (classesChanged && !m_scene.allClassesVisible) m_words.redrawAfter();
    }
    outdateColors();
}

void ProgressiveRenderer::setPreview(const PointCloud& cloud, std::shared_ptr<const Preview> preview)
{
    ViewCloud* const entry = find(cloud);
    if (entry == nullptr) return;
    {
        const std::shared_lock lock(cloud.mutex());
        entry->store->setPreview(std::move(preview));
    }
    storesChanged(StoreChange::Values);
}

void ProgressiveRenderer::setSurface(const PointCloud& cloud, std::shared_ptr<const SurfaceView> surface)
{
    ViewCloud* const entry = find(cloud);
    if (entry == nullptr || entry->surface == surface) return;
    entry->surface = std::move(surface);
    m_surfaceChanged = true;
    if (m_look.display.surface != SurfaceLook::None) m_picture.outdate();
}

bool ProgressiveRenderer::showsSurface() const noexcept
{
    return m_look.display.surface != SurfaceLook::None &&
           std::any_of(m_clouds.begin(), m_clouds.end(),
                       [](const auto& entry) { return entry->surface != nullptr; });
}

void ProgressiveRenderer::findReplaced(const ResolveSettings& settings)
{
    m_replaced.clear();
    if (m_look.display.surfaceReplaces.none()) return;
    m_backend->nearestIds(m_nearest);
    m_replaced.resize(m_nearest.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, m_nearest.size(), 1 << 12), [&](const auto& r) {
        PointId last = kNoPoint;  // neighbors often show the same point
        bool lastReplaced = false;
        for (std::size_t p = r.begin(); p != r.end(); ++p) {
            if (std::isinf(m_surface.depths()[p])) continue;
            if (const PointId id = m_nearest[p]; id != last) {
                last = id;
                const auto place = m_scene.ids.find(id);
                lastReplaced = place && isReplaced(*m_clouds[place->layer]->store, settings.layers[place->layer],
                                                   place->slot, m_look.display.surfaceReplaces);
            }
            m_replaced[p] = std::uint8_t(lastReplaced);
        }
    });
}

void ProgressiveRenderer::composeSurface(const ResolveSettings& settings)
{
    ResolveSettings alone = settings;
    alone.backgroundTop = alone.backgroundBottom = {0, 0, 0, 0};
    Image& picture = m_picture.makeHere(m_scene, alone, m_look.display.averaged, *m_backend);
    if (m_surfaceChanged || (m_surfaceCoarse && !m_moving)) {
        std::vector<SurfaceLayer> layers;
        const PicturePart part = m_look.part.value_or(PicturePart{0, 0, m_size.width, m_size.height});
        const double focal = part.height / 2.0 / std::tan(m_look.camera.fovY / 2);
        for (std::size_t k = 0; k < m_clouds.size(); ++k) {
            const Layer& layer = m_scene.layers[k];
            if (!m_clouds[k]->surface) continue;
            const CoordinateScale& grid = layer.store->cloud().coordinates();
            layers.push_back({m_clouds[k]->surface, layer.projection, layer.store->frame(), layer.clip,
                              layer.projection.perspective ? focal : focal / m_look.camera.pivotDepth(),
                              grid.scale.z, grid.offset.z});
        }
        m_surface.draw(layers, m_size, m_moving ? SurfaceRaster::kCoarseCell : SurfaceRaster::kFineCell,
                       m_look.display.surface, m_look.display.contours);
        m_surfaceCoarse = m_moving;
        m_surfaceChanged = false;
    }
    m_backend->depths(m_depths);
    findReplaced(settings);
    m_surface.compose(picture, {m_depths, m_replaced, m_look.display.pointsOnTop}, settings);
}

void ProgressiveRenderer::hide(const PointCloud& cloud, const PointSet* points)
{
    ViewCloud* const entry = find(cloud);
    if (entry == nullptr || (points == nullptr && !entry->store->hidesAny())) return;
    entry->store->hide(points);
    m_viewChanged = true;
    m_legend.valuesChanged();
}

void ProgressiveRenderer::arrange(const PointCloud& cloud, Arrangement&& arrangement)
{
    ViewCloud* const entry = find(cloud);
    if (entry == nullptr) return;
    {
        const std::shared_lock lock(cloud.mutex());
        entry->store->arrange(std::move(arrangement));
    }
    storesChanged(StoreChange::Slots);
}

void ProgressiveRenderer::keepThroughArranging()
{
    const bool shows = !m_targetChanged && !m_layersChanged;
    if (shows && !std::exchange(m_slotsChanged, true)) m_backend->visibleIds(m_kept);
    for (std::size_t layer = 0; layer < m_clouds.size(); ++layer) {
        ViewCloud& cloud = *m_clouds[layer];
        if (cloud.store->arranged() == std::exchange(cloud.arranged, cloud.store->arranged()) || !shows) continue;
        // Stores are arranged once: before, places were those of the file.
        const SlotOrder& order = cloud.store->order();
        const PointId first = m_scene.layers[layer].firstId;
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, m_kept.size(), 1 << 14), [&](const auto& r) {
            for (std::size_t k = r.begin(); k != r.end(); ++k) {
                const auto place = m_scene.ids.find(m_kept[k]);
                if (place && place->layer == layer) m_kept[k] = first + order.slotOf(order.placeAt(place->slot));
            }
        });
    }
}

void ProgressiveRenderer::storesChanged(StoreChange change)
{
    switch (change) {
        case StoreChange::Slots:
            keepThroughArranging();  // ids have other meanings; values and ranges are as they were
            break;
        case StoreChange::Hidden:
            m_viewChanged = true;
            m_legend.valuesChanged();
            return;
        case StoreChange::Values:
            m_legend.valuesChanged();
            if (!m_scene.allClassesVisible) m_words.redrawAfter();
            break;
        case StoreChange::Selection:
            break;
    }
    outdateColors();
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
    if (part == m_look.part && eyeDomeExtent == m_look.partExtent) return;
    m_look.part = part;
    m_look.partExtent = eyeDomeExtent;
    m_viewChanged = true;
}

void ProgressiveRenderer::setCamera(const Camera& camera)
{
    if (camera == m_look.camera) return;
    m_look.camera = camera;
    m_viewChanged = true;
}

void ProgressiveRenderer::setDisplay(const DisplaySettings& display)
{
    if (display == m_look.display) return;
    const DisplaySettings before = std::exchange(m_look.display, display);
    if (before.samples != m_look.display.samples) m_targetChanged = true;
    if (before.sizing != m_look.display.sizing || before.pointSize != m_look.display.pointSize ||
        before.worldSize != m_look.display.worldSize || before.spacings != m_look.display.spacings ||
        before.round != m_look.display.round || before.classVisible != m_look.display.classVisible ||
        before.clip != m_look.display.clip || before.cuts != m_look.display.cuts)
        m_viewChanged = true;
    if (before.surface != m_look.display.surface || before.contours != m_look.display.contours)
        m_surfaceChanged = true;
    if (before.classVisible != m_look.display.classVisible || before.clip != m_look.display.clip)
        m_legend.valuesChanged();
    if (before.range != m_look.display.range || before.attribute != m_look.display.attribute)
        m_legend.valuesChanged();
    if (before.attribute != m_look.display.attribute) {
        for (const auto& entry : m_clouds) applyDisplay(*entry);
        m_legend.attributesChanged();
    }
    outdateWords();
}

void ProgressiveRenderer::applyDisplay(ViewCloud& cloud)
{
    if (!m_look.display.attribute.empty()) SharedLegend::show(cloud, m_look.display.attribute);
}

void ProgressiveRenderer::outdateWords() noexcept
{
    m_words.outdate();
    m_picture.outdate();
}

void ProgressiveRenderer::outdateColors()
{
    m_picture.forgetColors();
    outdateWords();
}

void ProgressiveRenderer::wordsFresh() noexcept
{
    m_picture.outdate();  // copies on devices get the rest of their words
    if (m_words.end()) m_viewChanged = true;
}

void ProgressiveRenderer::agree()
{
    if (m_legend.agree(m_clouds, m_look.display)) outdateWords();
    if (WordStream::judgeColors(m_clouds)) outdateWords();
}

void ProgressiveRenderer::refreshVisible()
{
    if (!m_words.refreshVisible(m_clouds, m_scene, *m_backend)) return;
    m_picture.forgetColors();
    m_picture.outdate();
}

void ProgressiveRenderer::updateScene()
{
    m_size.samples = samplesOf(m_look.display);
    makeScene(m_clouds, m_look, m_size, m_backend->drawsPartly(), m_scene);
}

void ProgressiveRenderer::resolveImage(ResolveSettings settings)
{
    double began = now();
    if (showsSurface())
        composeSurface(settings);
    else
        m_picture.make(m_scene, settings, m_look.display.averaged, *m_backend);
    // The device may still have been drawing.
    if (m_scheduler.pending()) began = std::max(began, m_scheduler.countTimed(m_clouds, *m_backend, m_passes));
    if (settings.closeHoles && !FrameScheduler::partial(m_clouds)) {
        settings.closeHoles = false;  // it has drawn all: the picture is finished, and nothing is guessed
        return resolveImage(settings);
    }
    m_passes.resolve = m_picture.finish(*m_backend, began);
}

bool ProgressiveRenderer::copyPicture(unsigned texture)
{
    if (!m_picture.onDevice() || m_targetChanged) return false;
    m_backend->copyPicture(texture);
    m_backend->finish();
    return true;
}

bool ProgressiveRenderer::converged() const noexcept
{
    return !m_targetChanged && !m_layersChanged && !m_slotsChanged && !m_viewChanged && !m_picture.outdated() &&
           !(m_surfaceCoarse && showsSurface()) && !m_words.streaming() &&
           std::all_of(m_clouds.begin(), m_clouds.end(), [&](const auto& e) {
               return e->complete() && !e->store->stale() &&
                      (!m_look.display.averaged || e->colored == e->store->slotCount());
           });
}

bool ProgressiveRenderer::drawsPartly() const noexcept
{
    return std::any_of(m_clouds.begin(), m_clouds.end(), [](const auto& cloud) { return cloud->partly; });
}

bool ProgressiveRenderer::current() const noexcept
{
    return std::all_of(m_clouds.begin(), m_clouds.end(), [](const auto& cloud) {
        return cloud->partly ? cloud->newInSight == 0 : cloud->complete();
    });
}

/// Of clouds that load and are drawn partly: how much of what has come is in sight.
void ProgressiveRenderer::noteArrivals()
{
    const bool drawn = !m_layersChanged && m_scene.layers.size() == m_clouds.size();
    for (std::size_t k = 0; k < m_clouds.size(); ++k) {
        ViewCloud& cloud = *m_clouds[k];
        const std::size_t arrivals = cloud.store->arrivals();
        if (!drawn || !cloud.partly) {
            cloud.arrivals = arrivals;
            continue;
        }
        const Layer& layer = m_scene.layers[k];
        if (arrivals != cloud.arrivals) {
            std::vector<PointRange> points;
            cloud.store->arrivedPoints(std::exchange(cloud.arrivals, arrivals), arrivals, points);
            if (const PointIndex seen = render::pointsInSight(layer, m_size, points); seen != 0) {
                cloud.newInSight += seen;
                cloud.newestInSight = now();
            }
        }
        const double known = layer.visible ? double(layer.visible->known()) * double(PointStore::kStretchPoints)
                                           : double(cloud.store->cloud().size());
        cloud.grownInSight = cloud.newInSight != 0 && (double(cloud.newInSight) * kStepsInSight >= known ||
                                                       now() - cloud.newestInSight > kNothingMore);
    }
}

PointIndex ProgressiveRenderer::pointsInSight() const noexcept
{
    double points = 0;
    for (const Layer& layer : m_scene.layers)
        points += double(layer.store->cloud().size()) * (layer.visible ? layer.visible->share() : 1.0);
    return PointIndex(std::llround(points));
}

FrameReport ProgressiveRenderer::renderFrame(double budget)
{
    const double started = now();
    FrameReport report;
    for (const auto& entry : m_clouds) {
        PointStore& store = *entry->store;
        // While loading the range follows the data, each time half as much again has come.
        if (entry->loading && store.filled() > entry->filledAtRange + entry->filledAtRange / 2)
            m_legend.valuesChanged();
    }
    noteArrivals();
    agree();
    if (m_words.waiting() && !WordStream::anyStale(m_clouds)) wordsFresh();
    if (converged() && !m_legend.rangeNeeded()) {
        report.current = current();
        report.converged = true;
        report.share = 1.0;
        report.partly = drawsPartly();
        report.asked = pointsInSight();
        return report;
    }
    m_passes = {};
    const RasterBackend::Traffic before = m_backend->traffic();
    m_scheduler.beginFrame(*m_backend);
    const bool viewChanged = m_targetChanged || m_layersChanged || m_slotsChanged || m_viewChanged;
    m_moving = viewChanged && !m_targetChanged && budget > 0;
    if (!viewChanged && m_surfaceCoarse && showsSurface()) m_picture.outdate();
    if (viewChanged) {
        m_surfaceChanged = true;
        outdateWords();
        updateScene();
        if (m_targetChanged) {
            m_backend->setTarget(m_size);
        } else if (m_layersChanged) {
            m_backend->clear();
        } else if (m_slotsChanged) {
            m_backend->redraw(m_scene, m_kept);
        } else {
            m_backend->reproject(m_scene);
        }
        m_targetChanged = m_layersChanged = m_slotsChanged = m_viewChanged = false;
        FrameScheduler::beginPass(m_clouds);
        // Where the device keeps the time it is told apart there.
        if (!m_scheduler.deviceDecides(*m_backend)) m_backend->finish();
        m_passes.reproject = now() - m_scheduler.frameBegan();
    } else if (FrameScheduler::beginGrown(m_clouds, true)) {
        updateScene();  // boxes have grown, too
        m_picture.forgetColors();
    }
    const bool streaming = m_words.begin(m_clouds);
    // Where making the picture takes most of a frame, a still one would hardly come on: half of the time is for
    // points.
    const double resolving = m_picture.seconds();
    const double deadline =
        viewChanged ? started + budget - resolving
                    : std::max(started + kStillFrame * budget - resolving, budget <= 0 ? 0.0 : now() + resolving);
    // While an attribute streams, filling and streaming share what is left of the frame.
    const double fillStarted = now();
    const double fillDeadline = streaming ? now() + (deadline - now()) / 2 : deadline;
    if (m_scheduler.fill(m_clouds, m_scene, *m_backend, fillDeadline)) m_picture.forgetColors();
    m_passes.fill = now() - fillStarted;
    const bool filling = m_scheduler.filled() > 0 || m_scheduler.pending();
    if (filling) outdateWords();
    const bool refreshed = m_words.outdated();
    const double streamStarted = now();
    refreshVisible();
    if (streaming) {
        // A still picture in its new colors is shown first.
        const bool alone = !filling && !viewChanged;
        const bool rest = !alone || !refreshed;
        const double until = alone ? started + kStreamAlone : std::max(deadline, now() + kStreamSeconds);
        if (rest && WordStream::refreshRest(m_clouds, until)) wordsFresh();
    }
    m_passes.stream = now() - streamStarted;
    if (m_legend.rangeNeeded()) {
        m_legend.updateRange(m_clouds, m_look.display);
        m_picture.outdate();
    }
    const ResolveSettings settings = colorsOf(m_clouds, m_look);
    if (m_look.display.averaged &&
        std::all_of(m_clouds.begin(), m_clouds.end(), [](auto& e) { return e->complete() && !e->store->stale(); }))
        m_picture.addColors(m_clouds, m_scene, settings, *m_backend, deadline);
    // While all that is seen is up to date and the rest streams, the picture stays as it is.
    if (m_picture.outdated()) resolveImage(settings);
    report.filled = m_scheduler.filled();

    std::uint64_t drawn = 0, slots = 0;
    for (const auto& entry : m_clouds) {
        drawn += entry->drawn;
        slots += entry->store->slotCount();
    }
    report.share = slots == 0 ? 1.0 : double(drawn) / double(slots);
    report.partly = drawsPartly();
    report.asked = pointsInSight();
    report.converged = converged();
    report.current = current();
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
    agree();
    updateScene();
    for (Layer& layer : m_scene.layers) layer.visible = nullptr;
    if (m_backend->target() == m_size)
        m_backend->clear();
    else
        m_backend->setTarget(m_size);
    m_targetChanged = m_layersChanged = m_slotsChanged = m_viewChanged = false;
    m_surfaceChanged = true;
    m_moving = false;
    FrameScheduler::beginPass(m_clouds);
    for (std::size_t k = 0; k < m_clouds.size(); ++k) {
        ViewCloud& entry = *m_clouds[k];
        const Slot slots = entry.store->slotCount();
        m_backend->draw(m_scene, k, {0, slots});
        entry.drawn = slots;
        entry.cursor = 0;
        report.filled += slots;
    }
    m_backend->finish();
    m_words.outdate();
    refreshVisible();
    if (m_legend.rangeNeeded()) m_legend.updateRange(m_clouds, m_look.display);
    const ResolveSettings settings = colorsOf(m_clouds, m_look);
    if (m_look.display.averaged)
        m_picture.addColors(m_clouds, m_scene, settings, *m_backend, std::numeric_limits<double>::infinity());
    resolveImage(settings);
    report.share = 1.0;
    report.converged = converged();
    report.seconds = now() - started;
    return report;
}

void ProgressiveRenderer::setSelection(const PointCloud& cloud, std::shared_ptr<const PointSet> selection)
{
    ViewCloud* const entry = find(cloud);
    if (entry == nullptr) return;
    const std::shared_lock lock(cloud.mutex());
    entry->store->setSelection(std::move(selection));
    outdateColors();
}

PointSet ProgressiveRenderer::visiblePoints(const PointCloud& cloud)
{
    PointSet points(cloud.size());
    if (m_targetChanged || m_layersChanged || m_slotsChanged) return points;
    for (std::size_t layer = 0; layer < m_clouds.size(); ++layer) {
        const PointStore& store = *m_clouds[layer]->store;
        if (&store.cloud() != &cloud) continue;
        std::vector<PointId> visible;
        m_backend->visibleIds(visible);
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, visible.size(), 1 << 14), [&](const auto& r) {
            for (std::size_t k = r.begin(); k != r.end(); ++k) {
                const auto place = m_scene.ids.find(visible[k]);
                if (!place || place->layer != layer) continue;
                const PointIndex i = store.order().indexOf(place->slot);
                if (i < points.size()) points.insertShared(i);
            }
        });
    }
    return points;
}

PictureProjection ProgressiveRenderer::projectionOf(const PointCloud& cloud) const
{
    for (const auto& entry : m_clouds) {
        if (&entry->store->cloud() != &cloud) continue;
        const TargetSize size = m_backend->target();
        const LayerProjection p = makeProjection(m_look.camera, *entry->store, size);
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
    if (m_targetChanged || m_layersChanged || m_slotsChanged || m_clouds.empty()) return std::nullopt;
    const auto hit = m_backend->pick(x, y, radius);
    if (!hit) return std::nullopt;
    const auto place = m_scene.ids.find(hit->id);
    if (!place) return std::nullopt;
    const PointStore& store = *m_clouds[place->layer]->store;
    const PointIndex index = store.order().indexOf(place->slot);
    if (index >= store.cloud().size()) return std::nullopt;
    return PickResult{place->layer, index, store.cloud().world(index)};
}

}  // namespace punctum::render
