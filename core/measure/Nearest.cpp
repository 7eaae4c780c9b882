// SPDX-License-Identifier: MIT
#include "core/measure/Nearest.h"

#include "core/cloud/BlockBoxes.h"
#include "core/task/LockedLoop.h"
#include "core/task/Progress.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <shared_mutex>
#include <utility>

namespace punctum
{

namespace
{

bool nearer(const NearPoint& a, const NearPoint& b)
{
    return a.distance != b.distance ? a.distance < b.distance : a.index < b.index;
}

/// A heap of the nearest so far, the farthest of them on top. Distances are squares.
struct Best {
    std::size_t most = 0;
    std::vector<NearPoint> heap;

    void add(const NearPoint& p)
    {
        if (heap.size() == most) {
            if (!nearer(p, heap.front())) return;
            std::pop_heap(heap.begin(), heap.end(), nearer);
            heap.pop_back();
        }
        heap.push_back(p);
        std::push_heap(heap.begin(), heap.end(), nearer);
    }
};

}  // namespace

std::vector<NearPoint> nearestTo(const PointCloud& cloud, PointIndex point, std::size_t count,
                                 const glm::dvec3& stretch, Progress& progress)
{
    if (count == 0 || point >= cloud.size()) return {};
    const std::shared_lock lock(cloud.mutex());
    const std::array<std::span<const std::int32_t>, 3> raw{cloud.rawX(), cloud.rawY(), cloud.rawZ()};
    const PointSet* const deleted = cloud.deleted().get();
    const glm::dvec3 unit = cloud.coordinates().scale * stretch;
    const std::array<double, 3> from{double(raw[0][point]), double(raw[1][point]), double(raw[2][point])};
    const auto boxes = cloud.boxes();
    // Of a box, by the very operations that distances of points are computed by: no point of it is nearer.
    const auto distanceTo = [&](const RawBounds& box) {
        std::array<double, 3> d{};
        for (int axis = 0; axis < 3; ++axis) {
            const double at = from[std::size_t(axis)];
            const double away = std::max({double(box.min[axis]) - at, at - double(box.max[axis]), 0.0});
            d[std::size_t(axis)] = away * unit[axis];
        }
        return d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    };
    const auto look = [&](std::size_t block, Best& nearest) {
        if (progress.cancelled()) return;
        const PointRange range = boxes->points(block);
        for (PointIndex i = range.first; i < range.last; ++i) {
            const double x = (double(raw[0][i]) - from[0]) * unit.x, y = (double(raw[1][i]) - from[1]) * unit.y,
                         z = (double(raw[2][i]) - from[2]) * unit.z;
            if (i != point && (deleted == nullptr || !deleted->contains(i)))
                nearest.add({i, x * x + y * y + z * z});
        }
    };
    std::vector<std::pair<double, std::size_t>> order(boxes->size());
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = {distanceTo((*boxes)[k]), k};
    std::sort(order.begin(), order.end());
    // The nearest stretches first, until there are points enough; then those that may have nearer ones.
    Best best{count, {}};
    std::size_t done = 0;
    while (done < order.size() && best.heap.size() < count) look(order[done++].second, best);
    const auto last =
        best.heap.size() < count
            ? order.end()
            : std::upper_bound(order.begin(), order.end(), std::pair(best.heap.front().distance, boxes->size()));
    const Best others = runLocked(lock, [&] {
        return tbb::parallel_reduce(
            tbb::blocked_range<std::size_t>(done, std::max(done, std::size_t(last - order.begin()))),
            Best{count, {}},
            [&](const tbb::blocked_range<std::size_t>& range, Best nearest) {
                for (std::size_t k = range.begin(); k < range.end(); ++k) look(order[k].second, nearest);
                return nearest;
            },
            [](Best a, const Best& b) {
                for (const NearPoint& p : b.heap) a.add(p);
                return a;
            });
    });
    for (const NearPoint& p : others.heap) best.add(p);
    progress.check();
    std::sort(best.heap.begin(), best.heap.end(), nearer);
    for (NearPoint& p : best.heap) p.distance = std::sqrt(p.distance);
    return std::move(best.heap);
}

}  // namespace punctum
