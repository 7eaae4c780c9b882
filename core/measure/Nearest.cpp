// SPDX-License-Identifier: MIT
#include "core/measure/Nearest.h"

#include "core/task/LockedLoop.h"
#include "core/task/Progress.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <shared_mutex>

namespace punctum
{

namespace
{

constexpr PointIndex kGrain = 1 << 16;

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
    Best best = runLocked(lock, [&] {
        return tbb::parallel_reduce(
            tbb::blocked_range<PointIndex>(0, cloud.size(), kGrain), Best{count, {}},
            [&](const tbb::blocked_range<PointIndex>& range, Best nearest) {
                if (progress.cancelled()) return nearest;
                for (PointIndex i = range.begin(); i < range.end(); ++i) {
                    const double x = (double(raw[0][i]) - from[0]) * unit.x,
                                 y = (double(raw[1][i]) - from[1]) * unit.y,
                                 z = (double(raw[2][i]) - from[2]) * unit.z;
                    if (i != point && (deleted == nullptr || !deleted->contains(i)))
                        nearest.add({i, x * x + y * y + z * z});
                }
                return nearest;
            },
            [](Best a, const Best& b) {
                for (const NearPoint& p : b.heap) a.add(p);
                return a;
            });
    });
    progress.check();
    std::sort(best.heap.begin(), best.heap.end(), nearer);
    for (NearPoint& p : best.heap) p.distance = std::sqrt(p.distance);
    return std::move(best.heap);
}

}  // namespace punctum
