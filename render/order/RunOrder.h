// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace punctum
{
class Progress;
}

namespace punctum::render
{

/// Another order of a cloud's points, by whole runs of consecutive ones, so that points that lie together come
/// together where the file has them all over the place. A point's *place* is its number in that order; the file's
/// own order stays what it is. Immutable; any thread.
///
/// Runs are of 64 points (8 bytes a run), or of one, for clouds of which already 64 consecutive points lie anywhere
/// (8 bytes a point): thinned and merged scans.
class RunOrder
{
public:
    static constexpr int kLongBits = 6;  ///< of the length of a long run

    /// `runs`: all runs of 2^bits points of a cloud of `points` points, in their new order. The cloud's last run
    /// stays the last one where it has fewer points than the others.
    RunOrder(std::vector<std::uint32_t> runs, int bits, PointIndex points);
    /// By the Morton codes of the middles of runs of 64 points, along a curve that fills space (G. M. Morton,
    /// 1966). In parallel, some nanoseconds a point. Adds runs to the progress. Throws Cancelled.
    static RunOrder ofLongRuns(const PointCloud& cloud, Progress& progress);
    /// By the codes of the points themselves, among each kSortedPoints consecutive ones, so that sorting stays
    /// quick and what is gathered by places is near. In parallel, some 100 ns a point and core. Adds points to the
    /// progress. Throws Cancelled.
    static RunOrder ofPoints(const PointCloud& cloud, Progress& progress);
    static constexpr int kSortedBits = 22;
    static constexpr PointIndex kSortedPoints = PointIndex(1) << kSortedBits;

    PointIndex points() const noexcept { return m_points; }
    PointIndex runPoints() const noexcept { return PointIndex(1) << m_bits; }
    PointIndex placeOf(PointIndex index) const noexcept
    {
        return (PointIndex(m_places[index >> m_bits]) << m_bits) | (index & (runPoints() - 1));
    }
    PointIndex indexAt(PointIndex place) const noexcept
    {
        return (PointIndex(m_runs[place >> m_bits]) << m_bits) | (place & (runPoints() - 1));
    }
    /// Calls f(points, place) for the points at some places, run by run: `points` are consecutive, and the first
    /// one is at `place`.
    template <typename F>
    void forRuns(PointRange places, F&& f) const
    {
        for (PointIndex at = places.first, end = at; at < places.last; at = end) {
            end = std::min(places.last, ((at >> m_bits) + 1) << m_bits);
            const PointIndex first = indexAt(at);
            f(PointRange{first, first + (end - at)}, at);
        }
    }
    /// Raw coordinates of the points at some places, so many each.
    void coordinatesAt(const PointCloud& cloud, PointRange places, std::int32_t* x, std::int32_t* y,
                       std::int32_t* z) const;
    /// The points at some places, where runs are of one point.
    std::span<const std::uint32_t> pointsAt(PointRange places) const noexcept
    {
        return std::span(m_runs).subspan(std::size_t(places.first), std::size_t(places.size()));
    }

private:
    int m_bits;
    PointIndex m_points;
    std::vector<std::uint32_t> m_runs;    ///< by place
    std::vector<std::uint32_t> m_places;  ///< by run
};

}  // namespace punctum::render
