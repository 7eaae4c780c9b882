// SPDX-License-Identifier: MIT
#include "render/order/RunOrder.h"

#include "core/cloud/LeastMost.h"
#include "core/task/Progress.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <utility>

namespace punctum::render
{

namespace
{

constexpr int kMortonBits = 21;  ///< of each axis: three of them are a code

/// The lowest 21 bits, two zeros between any two of them.
constexpr std::uint64_t spreadBits(std::uint64_t v) noexcept
{
    v &= (std::uint64_t(1) << kMortonBits) - 1;
    v = (v | v << 32) & 0x001F00000000FFFFu;
    v = (v | v << 16) & 0x001F0000FF0000FFu;
    v = (v | v << 8) & 0x100F00F00F00F00Fu;
    v = (v | v << 4) & 0x10C30C30C30C30C3u;
    return (v | v << 2) & 0x1249249249249249u;
}

/// Codes of places between the bounds of a cloud.
class MortonCode
{
public:
    explicit MortonCode(const RawBounds& bounds) : m_low(bounds.min)
    {
        const glm::i64vec3 extent = bounds.empty() ? glm::i64vec3(0) : bounds.max - bounds.min;
        // One step for all axes: the curve fills cubes.
        const int width = std::bit_width(std::uint64_t(std::max({extent.x, extent.y, extent.z})));
        m_shift = std::max(0, width - kMortonBits);
    }
    std::uint64_t operator()(const glm::i64vec3& raw) const noexcept
    {
        const glm::i64vec3 at = raw - m_low;
        return spreadBits(std::uint64_t(at.x) >> m_shift) | spreadBits(std::uint64_t(at.y) >> m_shift) << 1 |
               spreadBits(std::uint64_t(at.z) >> m_shift) << 2;
    }

private:
    glm::i64vec3 m_low;
    int m_shift = 0;
};

/// In parallel; cancelled between any two comparisons.
template <typename T>
void sortAll(std::vector<T>& values, Progress& progress)
{
    tbb::parallel_sort(values.begin(), values.end(), [&](const T& a, const T& b) {
        progress.check();
        return a < b;
    });
    progress.add(values.size());
}

}  // namespace

RunOrder::RunOrder(std::vector<std::uint32_t> runs, int bits, PointIndex points)
    : m_bits(bits), m_points(points), m_runs(std::move(runs)), m_places(m_runs.size())
{
    assert(m_runs.size() == (points + runPoints() - 1) >> bits);
    assert(points % runPoints() == 0 || m_runs.back() == m_runs.size() - 1);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, m_runs.size(), 1 << 14), [&](const auto& r) {
        for (std::size_t k = r.begin(); k != r.end(); ++k) m_places[m_runs[k]] = std::uint32_t(k);
    });
}

RunOrder RunOrder::ofLongRuns(const PointCloud& cloud, Progress& progress)
{
    constexpr PointIndex kRun = PointIndex(1) << kLongBits;
    const auto count = std::size_t((cloud.size() + kRun - 1) / kRun);
    const MortonCode codeOf(cloud.computeBounds());
    const std::array<const std::int32_t*, 3> axes{cloud.rawX().data(), cloud.rawY().data(), cloud.rawZ().data()};
    std::vector<std::pair<std::uint64_t, std::uint32_t>> sorted(count);  // code, run
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 256), [&](const auto& r) {
        for (std::size_t run = r.begin(); run != r.end(); ++run) {
            const PointIndex first = PointIndex(run) * kRun, n = std::min(kRun, cloud.size() - first);
            glm::i64vec3 middle;
            for (int axis = 0; axis < 3; ++axis) {
                const LeastMost box = leastAndMost(axes[std::size_t(axis)] + first, std::size_t(n));
                middle[axis] = box.least + (std::int64_t(box.most) - box.least) / 2;
            }
            // A run that is not whole stays at the end.
            sorted[run] = {n == kRun ? codeOf(middle) : UINT64_MAX, std::uint32_t(run)};
        }
    });
    sortAll(sorted, progress);
    std::vector<std::uint32_t> runs(count);
    for (std::size_t k = 0; k < count; ++k) runs[k] = sorted[k].second;
    return {std::move(runs), kLongBits, cloud.size()};
}

RunOrder RunOrder::ofPoints(const PointCloud& cloud, Progress& progress)
{
    const MortonCode codeOf(cloud.computeBounds());
    const auto x = cloud.rawX(), y = cloud.rawY(), z = cloud.rawZ();
    std::vector<std::uint32_t> points(std::size_t(cloud.size()));
    for (PointIndex first = 0; first < cloud.size(); first += kSortedPoints) {
        // The higher bits of a code, and below them which point it is: one number is sorted sooner than two.
        std::vector<std::uint64_t> sorted(std::size_t(std::min(kSortedPoints, cloud.size() - first)));
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, sorted.size(), 1 << 14), [&](const auto& r) {
            for (std::size_t k = r.begin(); k != r.end(); ++k) {
                const PointIndex i = first + k;
                sorted[k] = (codeOf({x[i], y[i], z[i]}) >> (kSortedBits - 1) << kSortedBits) | k;
            }
        });
        sortAll(sorted, progress);
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, sorted.size(), 1 << 14), [&](const auto& r) {
            for (std::size_t k = r.begin(); k != r.end(); ++k)
                points[std::size_t(first) + k] = std::uint32_t(first + (sorted[k] & (kSortedPoints - 1)));
        });
    }
    return {std::move(points), 0, cloud.size()};
}

void RunOrder::coordinatesAt(const PointCloud& cloud, PointRange places, std::int32_t* x, std::int32_t* y,
                             std::int32_t* z) const
{
    const std::array<const std::int32_t*, 3> from{cloud.rawX().data(), cloud.rawY().data(), cloud.rawZ().data()};
    const std::array<std::int32_t*, 3> to{x, y, z};
    if (m_bits == 0) {
        const auto points = pointsAt(places);
        for (std::size_t axis = 0; axis < 3; ++axis)
            for (std::size_t k = 0; k < points.size(); ++k) to[axis][k] = from[axis][points[k]];
        return;
    }
    forRuns(places, [&](PointRange points, PointIndex place) {
        for (std::size_t axis = 0; axis < 3; ++axis)
            std::copy_n(from[axis] + points.first, points.size(), to[axis] + (place - places.first));
    });
}

}  // namespace punctum::render
