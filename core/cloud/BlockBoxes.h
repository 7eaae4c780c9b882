// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <vector>

namespace punctum
{

/// The box of each stretch of kPoints consecutive points of a cloud, in raw coordinates: what lies outside of a
/// view, a shape or a clip is left out by whole stretches. Exact: all points of a stretch are in its box, deleted
/// ones too, and on each of its faces there is one. See PointCloud::boxes().
///
/// A reader includes points as they come, in any order, each point once:
///     cloud->setArriving(std::make_shared<BlockBoxes>(cloud->size()));
///     cloud->arriving()->include(range, &x[range.first], &y[range.first], &z[range.first]);
class BlockBoxes
{
public:
    /// Words of a PointSet that a stretch has.
    static constexpr std::size_t kWords = 256;
    static constexpr PointIndex kPoints = PointIndex(kWords) * 64;

    /// The boxes of `points` points, all empty. Throws std::bad_alloc.
    explicit BlockBoxes(PointIndex points);

    std::size_t size() const noexcept { return m_boxes.size(); }
    /// Points of a stretch; the last one may have fewer than kPoints.
    PointRange points(std::size_t stretch) const noexcept
    {
        return {stretch * kPoints, std::min(m_points, (stretch + 1) * kPoints)};
    }
    /// Of the points that were included so far. Any thread.
    RawBounds operator[](std::size_t stretch) const noexcept;
    /// Of all of them.
    RawBounds bounds() const noexcept;

    /// Includes the points of a range, whose coordinates begin at x, y and z, and returns their own bounds. Any
    /// thread, several at a time, though they have points of one stretch. Some 0.3 ns a point when they are in the
    /// cache.
    RawBounds include(PointRange range, const std::int32_t* x, const std::int32_t* y,
                      const std::int32_t* z) noexcept;
    /// Includes points that include() will be told of once more: what is known before does not count.
    void includeAhead(PointRange range, const std::int32_t* x, const std::int32_t* y,
                      const std::int32_t* z) noexcept
    {
        (void)grow(range, x, y, z);
    }
    /// include() for all points, in parallel.
    void includeAll(const std::int32_t* x, const std::int32_t* y, const std::int32_t* z);
    /// Whether all points were included.
    bool complete() const noexcept { return m_included.load(std::memory_order_acquire) >= m_points; }

private:
    struct Box {
        std::array<std::atomic<std::int32_t>, 3> low{INT32_MAX, INT32_MAX, INT32_MAX};
        std::array<std::atomic<std::int32_t>, 3> high{INT32_MIN, INT32_MIN, INT32_MIN};
    };

    RawBounds grow(PointRange range, const std::int32_t* x, const std::int32_t* y, const std::int32_t* z) noexcept;

    PointIndex m_points;
    std::vector<Box> m_boxes;
    std::atomic<PointIndex> m_included{0};
};

/// Calls f(stretch, firstWord, lastWord) for the stretches that words of a set over the cloud belong to, one after
/// the other, with those of their words that are among these.
template <typename F>
void forStretches(std::size_t firstWord, std::size_t lastWord, F&& f)
{
    for (std::size_t first = firstWord, last = first; first < lastWord; first = last) {
        const std::size_t stretch = first / BlockBoxes::kWords;
        last = std::min(lastWord, (stretch + 1) * BlockBoxes::kWords);
        f(stretch, first, last);
    }
}

/// Bounds of a range of points that were read, from the points themselves. Any thread; some 0.3 ns a point.
RawBounds boundsOf(const PointCloud& cloud, PointRange range);

}  // namespace punctum
