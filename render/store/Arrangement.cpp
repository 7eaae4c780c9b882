// SPDX-License-Identifier: MIT
#include "render/store/Arrangement.h"

#include "core/Memory.h"
#include "core/cloud/LeastMost.h"
#include "core/task/LockedLoop.h"
#include "core/task/Progress.h"
#include "render/store/PointStore.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <shared_mutex>
#include <vector>

namespace punctum::render
{

namespace
{

/// For slots, their order and sorting, while it is made.
constexpr std::uint64_t kBytesAPoint = 48;
/// What points that change places one by one must be worth, next to whole runs.
constexpr double kDearer = 4;
/// Where runs of 64 points reach so much of what stretches of 16,384 do, points are all over the place one by one.
constexpr double kScattered = 0.5;
/// Stretches that are made under one lock: 2 M points.
constexpr std::size_t kSlabStretches = 128;

std::shared_ptr<const BlockBoxes> boxesOf(const PointCloud& cloud, const RunOrder& runs)
{
    auto boxes = std::make_shared<BlockBoxes>(cloud.size());
    tbb::parallel_for(std::size_t(0), boxes->size(), [&](std::size_t stretch) {
        const PointRange places = boxes->points(stretch);
        std::array<std::vector<std::int32_t>, 3> raw;
        for (auto& axis : raw) axis.resize(std::size_t(places.size()));
        runs.coordinatesAt(cloud, places, raw[0].data(), raw[1].data(), raw[2].data());
        boxes->include(places, raw[0].data(), raw[1].data(), raw[2].data());
    });
    return boxes;
}

/// How likely a cube of a tenth of each side of the bounds, anywhere in them, meets a box.
double chanceOf(const RawBounds& box, const RawBounds& bounds)
{
    double chance = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
        const double all = double(bounds.max[axis] - bounds.min[axis]);
        // It does where it begins within the box, or a side's length before it.
        if (all > 0) chance *= std::min(1.0, double(box.max[axis] - box.min[axis]) / all + 0.1);
    }
    return chance;
}

/// The same of the boxes of runs of 64 points, on average of some thousand of them.
double chanceOfRuns(const PointCloud& cloud, const RawBounds& bounds)
{
    constexpr PointIndex kRun = PointIndex(1) << RunOrder::kLongBits;
    const PointIndex runs = cloud.size() / kRun, step = std::max<PointIndex>(1, runs / 4096);
    const std::array<const std::int32_t*, 3> axes{cloud.rawX().data(), cloud.rawY().data(), cloud.rawZ().data()};
    double sum = 0;
    PointIndex looked = 0;
    for (PointIndex run = 0; run < runs; run += step, ++looked) {
        RawBounds box;
        for (int axis = 0; axis < 3; ++axis) {
            const LeastMost part = leastAndMost(axes[std::size_t(axis)] + run * kRun, std::size_t(kRun));
            box.min[axis] = part.least;
            box.max[axis] = part.most;
        }
        sum += chanceOf(box, bounds);
    }
    return looked == 0 ? 1.0 : sum / double(looked);
}

}  // namespace

double shareOfTenth(const BlockBoxes& boxes, const RawBounds& bounds) noexcept
{
    double sum = 0;
    for (std::size_t k = 0; k < boxes.size(); ++k) sum += chanceOf(boxes[k], bounds);
    return boxes.size() == 0 ? 1.0 : sum / double(boxes.size());
}

std::unique_ptr<Arrangement> PointStore::arrangement(const RawBounds& bounds, Progress& progress,
                                                     double worth) const
{
    const PointIndex points = m_cloud->size();
    if (m_order.kind() != OrderKind::Stratified || arranged() || !full() || points == 0) return nullptr;
    // A view may go on without: what is left of the memory is for what cannot.
    if (points > availableMemory() / 2 / kBytesAPoint) return nullptr;
    const double before = shareOfTenth(*m_cloud->boxes(), bounds);
    const bool scattered = chanceOfRuns(*m_cloud, bounds) > kScattered * before;
    const double least = scattered ? kDearer * worth : worth;
    if (before * double(points) < least) return nullptr;
    progress.begin("Arranging points", points + (scattered ? points : points >> RunOrder::kLongBits));
    auto made = std::make_unique<Arrangement>();
    made->runs = std::make_shared<RunOrder>(scattered ? RunOrder::ofPoints(*m_cloud, progress)
                                                      : RunOrder::ofLongRuns(*m_cloud, progress));
    progress.check();
    made->boxes = boxesOf(*m_cloud, *made->runs);
    if ((before - shareOfTenth(*made->boxes, bounds)) * double(points) < least) return nullptr;
    progress.check();
    made->bounds = bounds;
    made->frame = LocalFrame::around(bounds);
    made->arrays = SlotArrays(slotCount());
    // In this order: what changes after it was noted is made anew by arrange().
    made->wordChanges = m_wordChanges.load(std::memory_order_acquire);
    const auto current = encoder();
    Attribute classes;
    {
        const std::shared_lock lock(m_cloud->mutex());
        if (const Attribute* const found = m_cloud->findAttribute("Classification")) classes = *found;
    }
    SlotOrder order(OrderKind::Stratified, points);
    order.setRuns(made->runs);
    const std::size_t stretches = made->boxes->size();
    for (std::size_t slab = 0; slab < stretches; slab += kSlabStretches) {
        progress.check();
        const std::size_t slabEnd = std::min(stretches, slab + kSlabStretches);
        const std::shared_lock lock(m_cloud->mutex());
        forPiecesLocked(lock, slabEnd - slab, 1, [&](std::size_t first, std::size_t) {
            const PointRange places = made->boxes->points(slab + first);
            (void)dealOut(*m_cloud, places, *current, classes, made->arrays, order, &made->frame);
            progress.add(places.size());
        });
    }
    return made;
}

void PointStore::arrange(Arrangement&& made)
{
    if (m_hidesAny) {
        Buffer hidden(slotCount(), BufferUse::Drawing);
        const SlotOrder before = m_order;
        SlotOrder after = m_order;
        after.setRuns(made.runs);
        auto* const from = reinterpret_cast<const std::uint8_t*>(m_hidden.data());
        auto* const to = reinterpret_cast<std::uint8_t*>(hidden.data());
        tbb::parallel_for(tbb::blocked_range<PointIndex>(0, m_cloud->size(), kStretchPoints), [&](const auto& r) {
            for (PointIndex i = r.begin(); i != r.end(); ++i) to[after.slotOf(i)] = from[before.slotOf(i)];
        });
        m_hidden = std::move(hidden);
        ++m_hiddenVersion;
    }
    m_order.setRuns(made.runs);
    m_boxes = made.boxes;
    m_bounds = made.bounds;
    m_frame = made.frame;
    m_outgrown.store(false, std::memory_order_relaxed);
    std::swap(m_slots, made.arrays);
    for (Slot block = 0; block < blocks(); ++block) {
        m_positionVersions[block].fetch_add(1, std::memory_order_release);
        m_wordVersions[block].fetch_add(1, std::memory_order_release);
    }
    m_stale = false;
    if (made.wordChanges != m_wordChanges.load(std::memory_order_acquire)) markStale(nullptr);
}

}  // namespace punctum::render
