// SPDX-License-Identifier: MIT
#include "core/cloud/ShownExtent.h"

#include "core/cloud/BlockBoxes.h"
#include "core/cloud/Slabs.h"
#include "core/task/Progress.h"

#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <mutex>
#include <vector>

namespace punctum
{

namespace
{

constexpr PointIndex kExtentSamples = 65'536;
constexpr double kTail = 0.002;     // of the points, at each end of an axis
constexpr std::size_t kFewest = 8;  // points among which strays can be told
constexpr double kRoom = 1.0;       // sizes of the cloud beyond its ranges

/// Calls f(index) for the points of some words that are in `box` and not hidden.
template <typename F>
void forEachShown(const PointCloud& cloud, const RawBounds& box, const PointSet* hidden, std::size_t firstWord,
                  std::size_t lastWord, F&& f)
{
    const auto x = cloud.rawX(), y = cloud.rawY(), z = cloud.rawZ();
    for (std::size_t w = firstWord; w != lastWord; ++w) {
        for (std::uint64_t bits = shownBits(cloud.size(), hidden, w); bits != 0; bits &= bits - 1) {
            const PointIndex i = w * 64 + std::size_t(std::countr_zero(bits));
            const bool inside = (x[i] >= box.min.x) & (x[i] <= box.max.x) & (y[i] >= box.min.y) &
                                (y[i] <= box.max.y) & (z[i] >= box.min.z) & (z[i] <= box.max.z);
            if (inside) f(i);
        }
    }
}

struct Counted {
    RawBounds bounds;
    PointIndex points = 0;
};

/// How many points are shown inside of a box, and their own bounds.
Counted countIn(const PointCloud& cloud, const RawBounds& box, const PointSet* hidden, Progress& progress)
{
    const auto x = cloud.rawX(), y = cloud.rawY(), z = cloud.rawZ();
    const auto boxes = cloud.boxes();
    Counted all;
    std::mutex gate;
    forEachSlab(cloud, progress, [&](std::size_t firstWord, std::size_t lastWord) {
        Counted part;
        forStretches(firstWord, lastWord, [&](std::size_t stretch, std::size_t first, std::size_t last) {
            const RawBounds here = (*boxes)[stretch];
            if (!box.meets(here)) return;
            if (box.holds(here)) {
                const PointIndex shown = shownIn(cloud.size(), hidden, first, last);
                const bool whole = shown == boxes->points(stretch).size();
                if (whole) part.bounds.include(here);
                if (whole || shown == 0 || part.bounds.holds(here)) {
                    part.points += shown;
                    return;
                }
            }
            forEachShown(cloud, box, hidden, first, last, [&](PointIndex i) {
                part.bounds.include(x[i], y[i], z[i]);
                ++part.points;
            });
        });
        const std::lock_guard lock(gate);
        all.bounds.include(part.bounds);
        all.points += part.points;
    });
    return all;
}

using Sample = std::array<std::vector<std::int32_t>, 3>;

/// Raw coordinates of about kExtentSamples of the shown points, spread evenly over them.
Sample sampleOf(const PointCloud& cloud, const RawBounds& box, const PointSet* hidden, PointIndex points,
                Progress& progress)
{
    // Multiples of the golden ratio are spread evenly over the whole numbers of 64 bits: those below a bound are
    // taken.
    constexpr std::uint64_t kGolden = 0x9E3779B97F4A7C15u;
    const std::uint64_t bound = points <= kExtentSamples
                                    ? std::numeric_limits<std::uint64_t>::max()
                                    : std::numeric_limits<std::uint64_t>::max() / points * kExtentSamples;
    const auto x = cloud.rawX(), y = cloud.rawY(), z = cloud.rawZ();
    const auto boxes = cloud.boxes();
    Sample all;
    std::mutex gate;
    forEachSlab(cloud, progress, [&](std::size_t firstWord, std::size_t lastWord) {
        Sample part;
        const auto take = [&](PointIndex i) {
            part[0].push_back(x[i]);
            part[1].push_back(y[i]);
            part[2].push_back(z[i]);
        };
        forStretches(firstWord, lastWord, [&](std::size_t stretch, std::size_t first, std::size_t last) {
            const RawBounds here = (*boxes)[stretch];
            if (!box.meets(here)) return;
            if (!box.holds(here)) {
                forEachShown(cloud, box, hidden, first, last, [&](PointIndex i) {
                    if (i * kGolden <= bound) take(i);
                });
                return;
            }
            // Coordinates need not be looked at to tell whether a point is taken.
            for (std::size_t w = first; w != last; ++w)
                for (std::uint64_t bits = shownBits(cloud.size(), hidden, w); bits != 0; bits &= bits - 1) {
                    const PointIndex i = w * 64 + std::size_t(std::countr_zero(bits));
                    if (i * kGolden <= bound) take(i);
                }
        });
        const std::lock_guard lock(gate);
        for (std::size_t axis = 0; axis < 3; ++axis)
            all[axis].insert(all[axis].end(), part[axis].begin(), part[axis].end());
    });
    return all;
}

/// The box beyond which a point is a stray.
RawBounds fenceOf(Sample& sample, const glm::dvec3& unit)
{
    const std::size_t count = sample[0].size();
    const std::size_t tail = std::max<std::size_t>(1, std::size_t(double(count) * kTail));
    glm::dvec3 low, high;
    for (int axis = 0; axis < 3; ++axis) {
        auto& values = sample[std::size_t(axis)];
        const auto first = values.begin() + std::ptrdiff_t(tail), last = values.end() - 1 - std::ptrdiff_t(tail);
        std::nth_element(values.begin(), first, values.end());
        low[axis] = *first;
        std::nth_element(values.begin(), last, values.end());
        high[axis] = *last;
    }
    const glm::dvec3 widths = (high - low) * unit;
    const double size = std::max({widths.x, widths.y, widths.z});
    RawBounds fence;
    for (int axis = 0; axis < 3; ++axis) {
        // Raw coordinates have 32 bits: beyond them there is nothing.
        const double room = std::min(kRoom * size / std::max(unit[axis], 1e-300), 4e9);
        fence.min[axis] = std::int64_t(low[axis] - room);
        fence.max[axis] = std::int64_t(high[axis] + room);
    }
    return fence;
}

}  // namespace

void ShownExtent::include(const ShownExtent& other) noexcept
{
    all.include(other.all);
    typical.include(other.typical);
    points += other.points;
    strays += other.strays;
}

ShownExtent shownExtent(const PointCloud& cloud, const RawBounds& readable, const PointSet* hidden,
                        const glm::dvec3& stretch, Progress& progress)
{
    ShownExtent extent;
    if (readable.empty()) return extent;
    progress.begin("Finding the extent", 3 * cloud.size());
    const Counted shown = countIn(cloud, readable, hidden, progress);
    if (shown.points == 0) return extent;
    const CoordinateScale& grid = cloud.coordinates();
    extent.points = shown.points;
    extent.all = extent.typical = grid.toWorld(shown.bounds);
    Sample sample = sampleOf(cloud, readable, hidden, shown.points, progress);
    if (sample[0].size() < kFewest) return extent;
    const RawBounds fence = fenceOf(sample, glm::abs(grid.scale) * stretch);
    // Of points that all lie in one place, but for some, nobody can say which are meant.
    if (fence.holds(shown.bounds) || fence.min == fence.max) return extent;
    RawBounds inside;
    inside.min = glm::max(fence.min, readable.min);
    inside.max = glm::min(fence.max, readable.max);
    const Counted typical = countIn(cloud, inside, hidden, progress);
    if (typical.points == 0) return extent;
    extent.typical = grid.toWorld(typical.bounds);
    extent.strays = shown.points - typical.points;
    return extent;
}

}  // namespace punctum
