// SPDX-License-Identifier: MIT
#include "core/neighbors/LeafSearch.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace punctum
{

namespace
{

constexpr std::size_t kMostListed = 1 << 20;    ///< points around a leaf; more are for the order's own search
constexpr std::size_t kMostGathered = 1 << 21;  ///< points that are kept from leaf to leaf
constexpr std::size_t kOversize = 256;          ///< points of a leaf that may be many in one place
constexpr std::size_t kRanked = 96;             ///< sorted by counting smaller ones, which has no branches
constexpr std::size_t kFewSlots = 1024, kManySlots = 1 << 16;
constexpr std::uint32_t kNoLeaf = UINT32_MAX;
constexpr std::uint32_t kNoPlace = UINT32_MAX;
constexpr int kShared = 2;           ///< levels above the leaves: the leaves of such a node share what is listed
constexpr int kUpper = 4;            ///< likewise: they share where leaves are looked for
constexpr double kUpperReach = 1.5;  ///< of the square that a leaf is listed to, for those beside it
constexpr double kLeastStep = 1e-9;  ///< beside the longest one; squares of shorter ones are lost in floats

std::size_t roundUp(std::size_t count)
{
    return (count + LeafScan::kTogether - 1) / LeafScan::kTogether * LeafScan::kTogether;
}

}  // namespace

LeafSearch::LeafSearch(const KdOrder& order, std::size_t most) : m_order(order), m_most(most)
{
    const auto& scale = order.scale();
    m_unit = std::max({scale[0], scale[1], scale[2]});
    for (std::size_t a = 0; a < 3; ++a) {
        m_steps[a] = scale[a] / m_unit;
        m_scan.steps[a] = float(m_steps[a] * m_steps[a]);
    }
    clear();
}

bool LeafSearch::canScan(const KdOrder& order)
{
    const auto& scale = order.scale();
    const double unit = std::max({scale[0], scale[1], scale[2]});
    const KdOrder::Box& all = order.box(1);
    for (std::size_t a = 0; a < 3; ++a) {
        if (!(scale[a] >= kLeastStep * unit) || !(scale[a] > 0) || !std::isfinite(scale[a])) return false;
        if (std::int64_t(all.max[a]) - all.min[a] > INT32_MAX) return false;
    }
    return true;
}

void LeafSearch::clear()
{
    m_x.clear();
    m_y.clear();
    m_z.clear();
    m_points.clear();
    m_slots.assign(std::clamp<std::size_t>(m_slots.size(), kFewSlots, kManySlots), {kNoLeaf, {}});
    m_used = 0;
    m_upper = 0;
    m_group = 0;
}

LeafSearch::Slice LeafSearch::gathered(std::size_t leaf)
{
    const auto number = std::uint32_t(leaf);
    const auto placeOf = [&] {
        std::size_t at = (number * 0x9E3779B1u) & (m_slots.size() - 1);
        while (m_slots[at].first != kNoLeaf && m_slots[at].first != number) at = (at + 1) & (m_slots.size() - 1);
        return at;
    };
    std::size_t at = placeOf();
    if (m_slots[at].first == number) return m_slots[at].second;
    if (2 * ++m_used > m_slots.size()) {
        std::vector<std::pair<std::uint32_t, Slice>> before(2 * m_slots.size(), {kNoLeaf, {}});
        before.swap(m_slots);
        for (const auto& slot : before) {
            if (slot.first == kNoLeaf) continue;
            std::size_t place = (slot.first * 0x9E3779B1u) & (m_slots.size() - 1);
            while (m_slots[place].first != kNoLeaf) place = (place + 1) & (m_slots.size() - 1);
            m_slots[place] = slot;
        }
        at = placeOf();
    }
    Slice slice;
    slice.first = std::uint32_t(m_x.size());
    const std::span<const std::uint32_t> points = m_order.points(leaf);
    if (points.size() <= kOversize || m_most == SIZE_MAX) {
        gather(points);
    } else {
        // Where many points are in one place, those of the lowest indices alone.
        const auto before = [&](std::uint32_t a, std::uint32_t b) {
            const KdOrder::Raw ra = m_order.raw(a), rb = m_order.raw(b);
            return ra < rb || (ra == rb && a < b);
        };
        m_ordered.assign(points.begin(), points.end());
        if (m_order.box(leaf).min == m_order.box(leaf).max) {
            m_ordered.resize(std::min(m_ordered.size(), m_most));  // they are in the order of their indices
        } else {
            std::sort(m_ordered.begin(), m_ordered.end(), before);
            std::size_t kept = 0, same = 0;
            KdOrder::Raw last{};
            for (const std::uint32_t p : m_ordered) {
                const KdOrder::Raw r = m_order.raw(p);
                same = kept > 0 && r == last ? same + 1 : 1;
                last = r;
                if (same <= m_most) m_ordered[kept++] = p;
            }
            m_ordered.resize(kept);
            std::sort(m_ordered.begin(), m_ordered.end());
        }
        gather(m_ordered);
    }
    slice.count = std::uint32_t(m_x.size() - slice.first);
    const std::size_t padded = roundUp(m_x.size());
    m_x.resize(padded);
    m_y.resize(padded);
    m_z.resize(padded);
    m_points.resize(padded);
    m_slots[at] = {number, slice};
    return slice;
}

void LeafSearch::gather(std::span<const std::uint32_t> points)
{
    const std::size_t first = m_x.size();
    m_x.resize(first + points.size());
    m_y.resize(first + points.size());
    m_z.resize(first + points.size());
    m_points.insert(m_points.end(), points.begin(), points.end());
    for (std::size_t k = 0; k < points.size(); ++k) {
        const KdOrder::Raw raw = m_order.raw(points[k]);
        m_x[first + k] = raw[0];
        m_y[first + k] = raw[1];
        m_z[first + k] = raw[2];
    }
}

void LeafSearch::addBox(const KdOrder::Box& box, Slice slice)
{
    constexpr std::size_t n = LeafScan::kTogether;
    const std::size_t at = m_firsts.size();
    if (at % n == 0) m_boxes.resize(m_boxes.size() + 6 * n);
    std::int32_t* const group = m_boxes.data() + at / n * 6 * n + at % n;
    for (std::size_t a = 0; a < 3; ++a) {
        group[a * n] = box.min[a];
        group[(a + 3) * n] = box.max[a];
    }
    m_firsts.push_back(slice.first);
    m_counts.push_back(slice.count);
}

/// Calls found(node) for the nodes of a level below `top` whose boxes are not further than that from a box, from
/// the lowest to the highest, until it returns false.
template <typename Found>
bool LeafSearch::forNear(std::size_t top, std::size_t level, const KdOrder::Box& own, double squared,
                         const Found& found) const
{
    std::array<std::size_t, 64> stack;
    stack[0] = top;
    for (std::size_t depth = 1; depth != 0;) {
        const std::size_t node = stack[--depth];
        const KdOrder::Box& box = m_order.box(node);
        if (box.empty()) continue;
        double distance = 0;
        for (std::size_t a = 0; a < 3; ++a) {
            const std::int32_t apart = std::max(std::max(box.min[a] - own.max[a], own.min[a] - box.max[a]), 0);
            const double d = double(apart) * m_steps[a];
            distance += d * d;
        }
        if (distance > squared) continue;
        if (node >= level) {
            if (!found(node)) return false;
            continue;
        }
        stack[depth++] = 2 * node + 1;
        stack[depth++] = 2 * node;
    }
    return true;
}

/// The node whose leaves share what is listed.
std::size_t LeafSearch::groupOf(std::size_t leaf)
{
    return std::max<std::size_t>(leaf >> kShared, 1);
}

bool LeafSearch::list(std::size_t leaf, double squared)
{
    if (squared <= listed(leaf)) return true;
    const std::size_t group = groupOf(leaf);
    const double limit = squared * (1 + 1e-6);
    m_group = 0;
    if (m_x.size() > kMostGathered) clear();
    m_boxes.clear();
    m_firsts.clear();
    m_counts.clear();
    const KdOrder::Box& own = m_order.box(group);
    const std::size_t upper = std::max<std::size_t>(leaf >> kUpper, 1);
    if (upper != m_upper || limit > m_upperLimit) {
        m_upper = upper;
        m_upperLimit = kUpperReach * limit;
        m_uppers.clear();
        forNear(1, std::bit_floor(upper), m_order.box(upper), m_upperLimit, [&](std::size_t node) {
            m_uppers.push_back(node);
            return true;
        });
    }
    std::size_t points = 0;
    const auto add = [&](std::size_t node) {
        const Slice slice = gathered(node);
        points += slice.count;
        if (points > kMostListed) return false;
        addBox(m_order.box(node), slice);
        return true;
    };
    for (const std::size_t top : m_uppers)
        if (!forNear(top, std::bit_floor(leaf), own, limit, add)) return false;
    m_group = group;
    m_groupSquared = squared;
    m_scan.boxes = m_boxes.data();
    m_scan.firsts = m_firsts.data();
    m_scan.counts = m_counts.data();
    m_scan.leaves = m_firsts.size();
    m_scan.x = m_x.data();
    m_scan.y = m_y.data();
    m_scan.z = m_z.data();
    if (m_squared.size() < points + 2 * LeafScan::kTogether) {
        m_squared.resize(2 * points + 2 * LeafScan::kTogether);
        m_places.resize(m_squared.size());
        m_sortedSquared.resize(m_squared.size());
        m_sortedPlaces.resize(m_squared.size());
        m_ranks.resize(m_squared.size());
    }
    return true;
}

void LeafSearch::from(std::uint32_t point)
{
    m_from = point;
    const KdOrder::Raw raw = m_order.raw(point);
    for (std::size_t a = 0; a < 3; ++a) m_scan.from[a] = raw[a];
}

bool LeafSearch::sortByRank(std::size_t found)
{
    std::fill_n(m_squared.data() + found, roundUp(found) - found, INFINITY);
    m_functions.rank(m_squared.data(), found, m_ranks.data());
    std::fill_n(m_sortedPlaces.data(), found, kNoPlace);
    bool equal = false;
    for (std::size_t i = 0; i < found; ++i) {
        std::uint32_t rank = m_ranks[i];
        for (; m_sortedPlaces[rank] != kNoPlace; ++rank) equal = true;
        m_sortedPlaces[rank] = m_places[i];
        m_sortedSquared[rank] = m_squared[i];
    }
    return equal;
}

void LeafSearch::sortByKey(std::size_t found, std::size_t k)
{
    // Floats that are not negative are in the order of their bits.
    m_keys.resize(found);
    for (std::size_t i = 0; i < found; ++i)
        m_keys[i] = std::uint64_t(std::bit_cast<std::uint32_t>(m_squared[i])) << 32 | m_places[i];
    const auto squaredOf = [](std::uint64_t key) { return std::bit_cast<float>(std::uint32_t(key >> 32)); };
    const auto kth = m_keys.begin() + std::ptrdiff_t(k) - 1;
    std::nth_element(m_keys.begin(), kth, m_keys.end());
    const float limit = squaredOf(*kth) * (1 + kLeafScanError);
    const auto end =
        std::partition(kth + 1, m_keys.end(), [&](std::uint64_t key) { return squaredOf(key) <= limit; });
    std::sort(m_keys.begin(), end);
    for (std::size_t i = 0; i < m_keys.size(); ++i) {
        m_sortedSquared[i] = squaredOf(m_keys[i]);
        m_sortedPlaces[i] = std::uint32_t(m_keys[i]);
    }
}

void LeafSearch::sortExactly(std::size_t count)
{
    m_exact.clear();
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t place = m_sortedPlaces[i];
        m_exact.push_back({exactSquared(place), m_points[place], place});
    }
    std::sort(m_exact.begin(), m_exact.end(), [](const Exact& a, const Exact& b) {
        return a.squared < b.squared || (a.squared == b.squared && a.point < b.point);
    });
    const double unit2 = m_unit * m_unit;
    for (std::size_t i = 0; i < count; ++i) {
        m_sortedSquared[i] = float(m_exact[i].squared / unit2);
        m_sortedPlaces[i] = m_exact[i].place;
    }
}

bool LeafSearch::pick(std::size_t found, std::size_t k, float limit)
{
    if (found <= kRanked)
        sortByRank(found);
    else
        sortByKey(found, k);
    // Distances that floats cannot tell apart are computed exactly.
    const float last = m_sortedSquared[k - 1] * (1 + kLeafScanError);
    if (last > limit) return false;
    std::size_t count = k;
    while (count < found && m_sortedSquared[count] <= last) ++count;
    bool close = count > k;
    for (std::size_t i = 1; i < k; ++i)
        close |= m_sortedSquared[i] <= m_sortedSquared[i - 1] * (1 + kLeafScanError);
    if (close) sortExactly(count);
    m_sortedSquared.swap(m_squared);
    m_sortedPlaces.swap(m_places);
    return true;
}

std::size_t LeafSearch::keepWithin(std::size_t found, double radius)
{
    const double limit = radius * radius;
    const auto sure = float(limit / (m_unit * m_unit) * (1 - double(kLeafScanError)));
    std::size_t kept = 0;
    for (std::size_t i = 0; i < found; ++i) {
        if (m_squared[i] > sure && exactSquared(m_places[i]) > limit) continue;
        m_squared[kept] = m_squared[i];
        m_places[kept++] = m_places[i];
    }
    return kept;
}

std::size_t LeafSearch::countWithin(double radius, std::size_t enough)
{
    const double limit = radius * radius, steps = limit / (m_unit * m_unit);
    std::size_t looks = 0;
    std::size_t count =
        m_functions.count(m_scan, float(steps * (1 - double(kLeafScanError))),
                          float(steps * (1 + double(kLeafScanError))), enough, m_places.data(), &looks);
    for (std::size_t i = 0; i < looks && count < enough; ++i) count += exactSquared(m_places[i]) <= limit;
    return count;
}

}  // namespace punctum
