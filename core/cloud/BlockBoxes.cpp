// SPDX-License-Identifier: MIT
#include "core/cloud/BlockBoxes.h"

#include "core/cloud/LeastMost.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace punctum
{

BlockBoxes::BlockBoxes(PointIndex points) : m_points(points), m_boxes(std::size_t((points + kPoints - 1) / kPoints))
{
}

RawBounds BlockBoxes::operator[](std::size_t stretch) const noexcept
{
    const Box& box = m_boxes[stretch];
    RawBounds bounds;
    if (box.low[0].load(std::memory_order_relaxed) > box.high[0].load(std::memory_order_relaxed)) return bounds;
    for (int axis = 0; axis < 3; ++axis) {
        bounds.min[axis] = box.low[std::size_t(axis)].load(std::memory_order_relaxed);
        bounds.max[axis] = box.high[std::size_t(axis)].load(std::memory_order_relaxed);
    }
    return bounds;
}

RawBounds BlockBoxes::bounds() const noexcept
{
    RawBounds all;
    for (std::size_t k = 0; k < m_boxes.size(); ++k) all.include((*this)[k]);
    return all;
}

RawBounds BlockBoxes::include(PointRange range, const std::int32_t* x, const std::int32_t* y,
                              const std::int32_t* z) noexcept
{
    const RawBounds all = grow(range, x, y, z);
    m_included.fetch_add(range.size(), std::memory_order_release);
    return all;
}

RawBounds BlockBoxes::grow(PointRange range, const std::int32_t* x, const std::int32_t* y,
                           const std::int32_t* z) noexcept
{
    const std::int32_t* const axes[3] = {x, y, z};
    RawBounds all;
    for (PointIndex first = range.first, last = first; first < range.last; first = last) {
        last = std::min(range.last, (first / kPoints + 1) * kPoints);
        Box& box = m_boxes[std::size_t(first / kPoints)];
        for (int axis = 0; axis < 3; ++axis) {
            const LeastMost part = leastAndMost(axes[axis] + (first - range.first), std::size_t(last - first));
            all.min[axis] = std::min<std::int64_t>(all.min[axis], part.least);
            all.max[axis] = std::max<std::int64_t>(all.max[axis], part.most);
            auto &low = box.low[std::size_t(axis)], &high = box.high[std::size_t(axis)];
            for (auto seen = low.load(std::memory_order_relaxed);
                 part.least < seen && !low.compare_exchange_weak(seen, part.least, std::memory_order_relaxed);) {
            }
            for (auto seen = high.load(std::memory_order_relaxed);
                 part.most > seen && !high.compare_exchange_weak(seen, part.most, std::memory_order_relaxed);) {
            }
        }
    }
    return all;
}

void BlockBoxes::includeAll(const std::int32_t* x, const std::int32_t* y, const std::int32_t* z)
{
    tbb::parallel_for(std::size_t(0), size(), [&](std::size_t stretch) {
        const PointRange range = points(stretch);
        include(range, x + range.first, y + range.first, z + range.first);
    });
}

RawBounds boundsOf(const PointCloud& cloud, PointRange range)
{
    RawBounds bounds;
    const std::span<const std::int32_t> axes[] = {cloud.rawX(), cloud.rawY(), cloud.rawZ()};
    for (int axis = 0; axis < 3; ++axis) {
        const LeastMost found = leastAndMost(axes[axis].data() + range.first, std::size_t(range.size()));
        if (range.empty()) continue;
        bounds.min[axis] = found.least;
        bounds.max[axis] = found.most;
    }
    return bounds;
}

}  // namespace punctum
