// SPDX-License-Identifier: MIT
#include "core/cloud/KeptPoints.h"

#include "core/cloud/PointSet.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace punctum
{

KeptPoints::KeptPoints(std::vector<PointRange> ranges) : m_ranges(std::move(ranges))
{
    std::erase_if(m_ranges, [](const PointRange& r) { return r.empty(); });
    m_before.reserve(m_ranges.size());
    for (const PointRange& r : m_ranges) {
        m_before.push_back(m_count);
        m_count += r.size();
    }
}

KeptPoints KeptPoints::without(const PointSet& leftOut) const
{
    // The first index from `i` on whose membership is `member`, or `last`.
    const auto next = [&](PointIndex i, PointIndex last, bool member) {
        while (i < last) {
            const std::uint64_t word = leftOut.words()[std::size_t(i / 64)];
            const std::uint64_t left = (member ? word : ~word) >> (i % 64);
            if (left != 0) return std::min(last, i + PointIndex(std::countr_zero(left)));
            i = (i / 64 + 1) * 64;
        }
        return last;
    };
    std::vector<PointRange> ranges;
    for (const PointRange& r : m_ranges)
        for (PointIndex i = next(r.first, r.last, false); i < r.last; i = next(i, r.last, false)) {
            ranges.push_back({i, next(i, r.last, true)});
            i = ranges.back().last;
        }
    return KeptPoints(std::move(ranges));
}

std::size_t KeptPoints::runOf(PointIndex place) const noexcept
{
    return std::size_t(std::upper_bound(m_before.begin(), m_before.end(), place) - m_before.begin()) - 1;
}

PointIndex KeptPoints::index(PointIndex place) const noexcept
{
    const std::size_t k = runOf(place);
    return m_ranges[k].first + (place - m_before[k]);
}

PointIndex KeptPoints::placeOf(PointIndex index) const noexcept
{
    const auto after = std::upper_bound(m_ranges.begin(), m_ranges.end(), index,
                                        [](PointIndex i, const PointRange& r) { return i < r.first; });
    if (after == m_ranges.begin()) return 0;
    const auto k = std::size_t(after - m_ranges.begin()) - 1;
    return m_before[k] + std::min(index - m_ranges[k].first, m_ranges[k].size());
}

PointSet KeptPoints::places(const PointSet& points) const
{
    PointSet places(m_count);
    for (std::size_t k = 0; k < m_ranges.size(); ++k)
        for (PointIndex i = m_ranges[k].first; i < m_ranges[k].last; ++i)
            if (points.contains(i)) places.insert(m_before[k] + (i - m_ranges[k].first));
    return places;
}

}  // namespace punctum
