// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Column.h"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

namespace punctum
{

class PointSet;

/// Those points of a cloud that a file holds, in their order: all, or all but deleted and unreadable ones. Maps
/// their places in the file to indices of the cloud and back. Immutable; 24 bytes for each run of points, which
/// copies share.
class KeptPoints
{
public:
    KeptPoints() : KeptPoints(std::vector<PointRange>()) {}
    /// `ranges`: of the cloud, rising, without overlap.
    explicit KeptPoints(std::vector<PointRange> ranges);
    static KeptPoints all(PointIndex points) { return KeptPoints({{0, points}}); }
    /// Without the members of `leftOut`.
    KeptPoints without(const PointSet& leftOut) const;

    const std::vector<PointRange>& ranges() const noexcept { return m_runs->ranges; }
    PointIndex count() const noexcept { return m_runs->count; }
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
            const PointRange& run = m_runs->ranges[k];
            const PointIndex first = run.first + (places.first - m_runs->before[k]);
            const PointIndex n = std::min(places.size(), run.last - first);
            f(PointRange{first, first + n}, places.first);
            places.first += n;
        }
    }

private:
    std::size_t runOf(PointIndex place) const noexcept;

    struct Runs {
        std::vector<PointRange> ranges;  ///< none is empty
        std::vector<PointIndex> before;  ///< kept points before each of them
        PointIndex count = 0;
    };
    std::shared_ptr<const Runs> m_runs;  ///< never null
};

}  // namespace punctum
