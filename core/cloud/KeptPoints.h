// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Column.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace punctum
{

class PointSet;

/// Those points of a cloud that a file holds, in their order: all, or all but deleted and unreadable ones. Maps
/// their places in the file to indices of the cloud and back. Immutable; some 24 bytes for each run of points.
class KeptPoints
{
public:
    KeptPoints() = default;
    /// `ranges`: of the cloud, rising, without overlap.
    explicit KeptPoints(std::vector<PointRange> ranges);
    static KeptPoints all(PointIndex points) { return KeptPoints({{0, points}}); }
    /// Without the members of `leftOut`.
    KeptPoints without(const PointSet& leftOut) const;

    const std::vector<PointRange>& ranges() const noexcept { return m_ranges; }
    PointIndex count() const noexcept { return m_count; }
    /// Index in the cloud of the point at `place`, which is less than count().
    PointIndex index(PointIndex place) const noexcept;
    /// How many kept points come before this index of the cloud: its place, if it is kept.
    PointIndex placeOf(PointIndex index) const noexcept;
    /// The set with places in the file for indices of the cloud; members that are not kept are lost.
    PointSet places(const PointSet& points) const;

    /// Calls f(range of the cloud, place of its first point) for the runs of the places `places`, in order.
    template <typename F>
    void forEachRun(PointRange places, F&& f) const
    {
        for (std::size_t k = places.empty() ? 0 : runOf(places.first); !places.empty(); ++k) {
            const PointIndex first = m_ranges[k].first + (places.first - m_before[k]);
            const PointIndex n = std::min(places.size(), m_ranges[k].last - first);
            f(PointRange{first, first + n}, places.first);
            places.first += n;
        }
    }

private:
    std::size_t runOf(PointIndex place) const noexcept;

    std::vector<PointRange> m_ranges;  ///< none is empty
    std::vector<PointIndex> m_before;  ///< kept points before each of them
    PointIndex m_count = 0;
};

}  // namespace punctum
