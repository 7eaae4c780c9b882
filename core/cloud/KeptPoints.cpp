// SPDX-License-Identifier: MIT
#include "core/cloud/KeptPoints.h"

#include "core/cloud/PointSet.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace punctum
{

namespace
{

/// How many runs of no members begin in a set.
std::size_t gapsIn(const PointSet& set)
{
    std::size_t gaps = 0;
    std::uint64_t before = ~std::uint64_t(0);
    for (const std::uint64_t word : set.words()) {
        gaps += std::size_t(std::popcount(~word & (word << 1 | before >> 63)));
        before = word;
    }
    return gaps;
}

}  // namespace

KeptPoints::KeptPoints(std::vector<PointRange> ranges)
{
    auto runs = std::make_shared<Runs>();
    runs->ranges = std::move(ranges);
    std::erase_if(runs->ranges, [](const PointRange& r) { return r.empty(); });
    runs->before.reserve(runs->ranges.size());
    for (const PointRange& r : runs->ranges) {
        runs->before.push_back(runs->count);
        runs->count += r.size();
    }
    m_runs = std::move(runs);
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
    // At once: of a thinned cloud there are many, and a list that grows takes three times its memory meanwhile.
    ranges.reserve(gapsIn(leftOut) + this->ranges().size());
    for (const PointRange& r : this->ranges())
        for (PointIndex i = next(r.first, r.last, false); i < r.last; i = next(i, r.last, false)) {
            ranges.push_back({i, next(i, r.last, true)});
            i = ranges.back().last;
        }
    return KeptPoints(std::move(ranges));
}

std::size_t KeptPoints::runOf(PointIndex place) const noexcept
{
    const auto& before = m_runs->before;
    return std::size_t(std::upper_bound(before.begin(), before.end(), place) - before.begin()) - 1;
}

PointIndex KeptPoints::index(PointIndex place) const noexcept
{
    const std::size_t k = runOf(place);
    return ranges()[k].first + (place - m_runs->before[k]);
}

PointIndex KeptPoints::placeOf(PointIndex index) const noexcept
{
    const auto after = std::upper_bound(ranges().begin(), ranges().end(), index,
                                        [](PointIndex i, const PointRange& r) { return i < r.first; });
    if (after == ranges().begin()) return 0;
    const auto k = std::size_t(after - ranges().begin()) - 1;
    return m_runs->before[k] + std::min(index - ranges()[k].first, ranges()[k].size());
}

PointSet KeptPoints::places(const PointSet& points) const
{
    PointSet places(count());
    for (std::size_t k = 0; k < ranges().size(); ++k)
        for (PointIndex i = ranges()[k].first; i < ranges()[k].last; ++i)
            if (points.contains(i)) places.insert(m_runs->before[k] + (i - ranges()[k].first));
    return places;
}

}  // namespace punctum
