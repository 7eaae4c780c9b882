// SPDX-License-Identifier: MIT
#include "core/surface/SurfaceHeights.h"

#include "core/task/Progress.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>

namespace punctum
{

namespace
{

constexpr std::size_t kSortWords = 1024;  ///< of a set that one task sorts

}  // namespace

void forHeightsAbove(const SurfaceTiles& tiles, const PointCloud& cloud, const PointSet& points, Progress& progress,
                     const HeightsAbove& f)
{
    const auto x = cloud.rawX(), y = cloud.rawY(), z = cloud.rawZ();
    const std::size_t words = points.words().size(), blocks = (words + kSortWords - 1) / kSortWords;
    progress.begin("Measuring heights above the surface", 2 * words + tiles.size());

    // how many over each tile, then where each one's are, then which they are
    std::vector<std::atomic<std::uint32_t>> counts(tiles.size() + 1);
    const auto forBlocks = [&](auto&& g) {
        tbb::parallel_for(std::size_t(0), blocks, [&](std::size_t b) {
            if (progress.cancelled()) return;
            const std::size_t last = std::min(words, (b + 1) * kSortWords);
            std::size_t near = 0;
            points.forEachInWords(b * kSortWords, last, [&](PointIndex i) {
                if (near >= tiles.size() || !tiles.box(near).holds(x[i], y[i]))
                    near = tiles.tileAt(x[i], y[i]).value_or(tiles.size());
                g(i, near);
            });
            progress.add(last - b * kSortWords);
        });
        progress.check();
    };
    forBlocks([&](PointIndex, std::size_t tile) { counts[tile].fetch_add(1, std::memory_order_relaxed); });
    std::vector<std::size_t> starts(tiles.size() + 2);
    for (std::size_t t = 0; t <= tiles.size(); ++t) {
        starts[t + 1] = starts[t] + counts[t].load();
        counts[t].store(0);
    }
    std::vector<std::uint32_t> sorted(starts.back());
    forBlocks([&](PointIndex i, std::size_t tile) {
        sorted[starts[tile] + counts[tile].fetch_add(1, std::memory_order_relaxed)] = std::uint32_t(i);
    });
    const double step = tiles.steps()[2];
    tbb::parallel_for(std::size_t(0), tiles.size(), [&](std::size_t t) {
        const std::span<std::uint32_t> own(sorted.data() + starts[t], starts[t + 1] - starts[t]);
        if (progress.cancelled() || own.empty()) return;
        std::sort(own.begin(), own.end());
        const SurfaceNet net = tiles.net(t);
        std::vector<float> heights(own.size());
        std::uint32_t near = 0;
        for (std::size_t k = 0; k < own.size(); ++k) {
            const std::uint32_t i = own[k];
            const std::optional<double> ground = net.height(x[i], y[i], near);
            heights[k] = ground ? float((double(z[i]) - *ground) * step) : NAN;
        }
        f(own, heights);
        progress.add(1);
    });
    progress.check();
}

PointSet pointsBetween(const SurfaceTiles& tiles, const PointCloud& cloud, const PointSet& among, double low,
                       double high, Progress& progress)
{
    PointSet found(cloud.size());
    forHeightsAbove(tiles, cloud, among, progress,
                    [&](std::span<const std::uint32_t> points, std::span<const float> heights) {
                        for (std::size_t k = 0; k < points.size(); ++k)
                            if (double(heights[k]) >= low && double(heights[k]) <= high)
                                found.insertShared(points[k]);
                    });
    return found;
}

}  // namespace punctum
