// SPDX-License-Identifier: MIT
#pragma once

#include "core/neighbors/KdOrder.h"
#include "core/neighbors/LeafScan.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace punctum
{

/// Searches around the points of one leaf after another. The leaves near a leaf are listed once for all its points,
/// and their coordinates gathered once for a tile, so that each point is a scan of some hundred of them in the
/// cache. One a task; private to core/neighbors. Squared distances are in steps of the axis that has the longest
/// ones (unit()).
class LeafSearch
{
public:
    /// `most`: so many points of one place are kept, those of the lowest indices; no more of them can be asked for.
    LeafSearch(const KdOrder& order, std::size_t most);

    /// Whether the order's coordinates can be scanned: differences fit into 32 bits, and steps into floats.
    static bool canScan(const KdOrder& order);

    /// Forgets what was gathered.
    void clear();
    /// Lists the leaves whose boxes are not further than that from a leaf's box; false when that is too much.
    bool list(std::size_t leaf, double squared);
    /// Up to which squared distance leaves are listed already, as a leaf beside this one has the same ones near it;
    /// below 0: none are.
    double listed(std::size_t leaf) const { return m_group != 0 && m_group == groupOf(leaf) ? m_groupSquared : -1; }
    /// Points looked at from now on are near this one.
    void from(std::uint32_t point);

    /// The points not further than `limit`, in squares() and places().
    std::size_t scan(float limit) { return m_functions.scan(m_scan, limit, m_squared.data(), m_places.data()); }
    /// The k nearest of what scan(limit) found, in order, in squares() and places(). False where the scan was too
    /// short to tell; `k` must not be more than found.
    bool pick(std::size_t found, std::size_t k, float limit);
    /// Of what scan() found, those not further than `radius`, exactly.
    std::size_t keepWithin(std::size_t found, double radius);
    /// How many points are not further than `radius`, exactly, but no more than about `enough`.
    std::size_t countWithin(double radius, std::size_t enough);

    std::span<const float> squares() const { return m_squared; }
    std::span<const std::uint32_t> places() const { return m_places; }
    std::uint32_t point(std::uint32_t place) const { return m_points[place]; }
    std::array<float, 3> offset(std::uint32_t place) const
    {
        return {float(double(m_x[place] - m_scan.from[0]) * m_order.scale()[0]),
                float(double(m_y[place] - m_scan.from[1]) * m_order.scale()[1]),
                float(double(m_z[place] - m_scan.from[2]) * m_order.scale()[2])};
    }
    /// Length of the step that distances are in.
    double unit() const { return m_unit; }

private:
    struct Slice {
        std::uint32_t first = 0, count = 0;
    };
    static std::size_t groupOf(std::size_t leaf);
    Slice gathered(std::size_t leaf);
    void gather(std::span<const std::uint32_t> points);
    template <typename Found>
    bool forNear(std::size_t top, std::size_t level, const KdOrder::Box& own, double squared,
                 const Found& found) const;
    void addBox(const KdOrder::Box& box, Slice slice);
    double exactSquared(std::uint32_t place) const { return m_order.squaredDistance(m_from, m_points[place]); }
    bool sortByRank(std::size_t found);
    void sortByKey(std::size_t found, std::size_t k);
    void sortExactly(std::size_t count);

    const KdOrder& m_order;
    std::size_t m_most;
    double m_unit = 1;
    std::array<double, 3> m_steps{};  ///< of an axis, in units
    LeafFunctions m_functions = leafFunctions();
    LeafScan m_scan;
    std::uint32_t m_from = 0;

    std::vector<std::int32_t> m_x, m_y, m_z;
    std::vector<std::uint32_t> m_points;
    std::vector<std::pair<std::uint32_t, Slice>> m_slots;  ///< open addressing by leaf; a power of two
    std::size_t m_used = 0;

    std::size_t m_group = 0;            ///< the node whose leaves share what is listed; 0: none
    double m_groupSquared = 0;          ///< up to which squared distance that goes
    std::size_t m_upper = 0;            ///< an inner node, below which leaves were listed last; 0: none
    double m_upperLimit = 0;            ///< square up to which nodes of its level are listed
    std::vector<std::size_t> m_uppers;  ///< those

    std::vector<std::int32_t> m_boxes;
    std::vector<std::uint32_t> m_firsts, m_counts;

    std::vector<float> m_squared, m_sortedSquared;
    std::vector<std::uint32_t> m_places, m_sortedPlaces, m_ranks;
    std::vector<std::uint64_t> m_keys;
    struct Exact {
        double squared;
        std::uint32_t point, place;
    };
    std::vector<Exact> m_exact;
    std::vector<std::uint32_t> m_ordered;
};

}  // namespace punctum
