// SPDX-License-Identifier: MIT
#include "core/neighbors/Neighbors.h"

#include "core/neighbors/LeafSearch.h"
#include "core/task/Progress.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace punctum
{

namespace
{

constexpr std::size_t kTilePoints = 8192;  ///< whose leaves, and those around, stay in the processor's second cache
constexpr int kMostTries = 7;              ///< scans for the k nearest, before the order's own search
constexpr double kFirstReach = 1.4;  ///< of the square of what the points before needed: most scans are then enough
constexpr double kNextReach = 1.6;   ///< of the square of the scan before, which was
constexpr double kListed = 2.6;      ///< as kFirstReach, of the leaves that are listed: for one more scan

/// Gathers what a visitor is told; one a task, its memory used again for each point.
class Report
{
public:
    Report(const KdOrder& order, const NeighborVisitor& visit) : m_order(order), m_visit(visit) {}

    void fromSearch(std::uint32_t point, const LeafSearch& search, std::size_t count)
    {
        m_points.resize(count);
        m_offsets.resize(count);
        m_squared.resize(count);
        const auto unit2 = float(search.unit() * search.unit());
        const auto places = search.places();
        const auto squares = search.squares();
        for (std::size_t j = 0; j < count; ++j) {
            m_points[j] = search.point(places[j]);
            m_offsets[j] = search.offset(places[j]);
            m_squared[j] = squares[j] * unit2;
        }
        again(point);
    }
    void fromOrder(std::uint32_t point, const std::vector<KdOrder::Found>& found)
    {
        const KdOrder::Place origin = KdOrder::place(m_order.raw(point));
        m_points.clear();
        m_offsets.clear();
        m_squared.clear();
        for (const KdOrder::Found& f : found) {
            m_points.push_back(f.point);
            m_offsets.push_back(m_order.local(f.point, origin));
            m_squared.push_back(float(f.squared));
        }
        again(point);
    }
    /// What was told last, of a point in the same place.
    void again(std::uint32_t point) const { m_visit({point, m_points, m_offsets, m_squared}); }

private:
    const KdOrder& m_order;
    const NeighborVisitor& m_visit;
    std::vector<std::uint32_t> m_points;
    std::vector<std::array<float, 3>> m_offsets;
    std::vector<float> m_squared;
};

/// The k nearest of the points of one leaf after another.
class NearestSearch
{
public:
    NearestSearch(const KdOrder& order, std::size_t k, const NeighborVisitor& visit)
        : m_order(order),
          m_k(std::min(k, order.size())),
          m_search(order, m_k),
          m_report(order, visit),
          m_scans(LeafSearch::canScan(order))
    {
    }
    /// What is known of the points before is forgotten, too: which search finds a point's neighbors, and with it
    /// the last bits of distances, goes by the tile alone, whatever the threads took before.
    void clear()
    {
        m_search.clear();
        m_reach = -1;
    }
    void leaf(std::size_t leaf, std::span<const std::uint32_t> points, const Progress& progress)
    {
        m_leaf = leaf;
        m_listed = m_search.listed(leaf);
        if (points.size() > kCheck) {  // many in one place, perhaps: those are searched for once
            m_byPlace.assign(points.begin(), points.end());
            std::sort(m_byPlace.begin(), m_byPlace.end(), [&](std::uint32_t a, std::uint32_t b) {
                const KdOrder::Raw ra = m_order.raw(a), rb = m_order.raw(b);
                return ra < rb || (ra == rb && a < b);
            });
            points = m_byPlace;
        }
        std::optional<KdOrder::Raw> last;
        std::size_t unchecked = 0;
        for (const std::uint32_t point : points) {
            if (++unchecked % kCheck == 0 && progress.cancelled()) return;
            const KdOrder::Raw raw = m_order.raw(point);
            if (last == raw) {
                m_report.again(point);
                continue;
            }
            last = raw;
            if (m_scans && scanned(point)) continue;
            m_order.nearest(point, m_k, m_found);
            m_report.fromOrder(point, m_found);
            m_reach = m_found.back().squared / (m_search.unit() * m_search.unit());
        }
    }

private:
    static constexpr std::size_t kCheck = 128;

    bool scanned(std::uint32_t point)
    {
        if (m_reach < 0) return false;
        m_search.from(point);
        m_reach = std::max(m_reach, 1.0);  // where many are in one place
        double limit = kFirstReach * m_reach;
        for (int tries = 0; tries < kMostTries; ++tries, limit *= kNextReach) {
            if (limit > m_listed) {
                m_listed = std::max(kListed * m_reach, 1.5 * limit);
                if (!m_search.list(m_leaf, m_listed)) {
                    m_listed = -1;
                    return false;
                }
            }
            const std::size_t found = m_search.scan(float(limit));
            if (found < m_k || !m_search.pick(found, m_k, float(limit))) continue;
            m_report.fromSearch(point, m_search, m_k);
            const double needed = m_search.squares()[m_k - 1];
            // A few points that are far from everything must not make scans of all that follow long.
            m_reach = found > 8 * m_k ? needed : m_reach + 0.25 * (std::min(needed, 4 * m_reach) - m_reach);
            return true;
        }
        return false;
    }

    const KdOrder& m_order;
    std::size_t m_k;
    LeafSearch m_search;
    Report m_report;
    bool m_scans;
    std::size_t m_leaf = 0;
    double m_reach = -1;   ///< squared distance of the k-th neighbor, of the points before; not known yet
    double m_listed = -1;  ///< up to which squared distance leaves are listed; below 0: none are
    std::vector<KdOrder::Found> m_found;
    std::vector<std::uint32_t> m_byPlace;
};

/// Calls work(leaf, points) for every leaf with points, of `of`, in parallel and tile by tile; makeWorker() gives a
/// task's worker, which has clear().
template <typename MakeWorker>
void forLeaves(const KdOrder& order, const std::string& stage, Progress& progress, const PointSet* of,
               MakeWorker&& makeWorker)
{
    progress.begin(stage, order.size());
    const auto tiles = order.tiles(kTilePoints);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, tiles.size(), 4), [&](const auto& range) {
        auto worker = makeWorker();
        std::vector<std::uint32_t> some;
        for (std::size_t k = range.begin(); k != range.end(); ++k) {
            worker.clear();
            const auto [first, last] = order.leaves(tiles[k]);
            for (std::size_t leaf = first; leaf < last && !progress.cancelled(); ++leaf) {
                std::span<const std::uint32_t> points = order.points(leaf);
                const std::size_t count = points.size();
                if (of != nullptr) {
                    some.clear();
                    for (const std::uint32_t p : points)
                        if (of->contains(p)) some.push_back(p);
                    points = some;
                }
                if (!points.empty()) worker.leaf(leaf, points, progress);
                progress.add(count);
            }
        }
    });
    progress.check();
}

/// What is within a radius of the points of one leaf after another.
class WithinSearch
{
public:
    WithinSearch(const KdOrder& order, double radius, const NeighborVisitor& visit)
        : m_order(order),
          m_radius(radius),
          m_search(order, SIZE_MAX),
          m_report(order, visit),
          m_scans(LeafSearch::canScan(order))
    {
        const double steps = radius / m_search.unit();
        m_limit = steps * steps * (1 + double(kLeafScanError));
        m_scans = m_scans && m_limit < 1e30;
    }
    void clear() { m_search.clear(); }
    void leaf(std::size_t leaf, std::span<const std::uint32_t> points, const Progress& progress)
    {
        const bool listed = m_scans && m_search.list(leaf, m_limit);
        for (const std::uint32_t point : points) {
            if (progress.cancelled()) return;
            if (listed) {
                m_search.from(point);
                const std::size_t found = m_search.scan(float(m_limit));
                m_report.fromSearch(point, m_search, m_search.keepWithin(found, m_radius));
            } else if (m_order.within(point, m_radius, m_found, progress)) {
                m_report.fromOrder(point, m_found);
            }
        }
    }

private:
    const KdOrder& m_order;
    double m_radius;
    double m_limit = 0;
    LeafSearch m_search;
    Report m_report;
    bool m_scans;
    std::vector<KdOrder::Found> m_found;
};

class CountSearch
{
public:
    using Visit = std::function<void(std::uint32_t, std::size_t)>;
    CountSearch(const KdOrder& order, double radius, std::size_t enough, const Visit& visit)
        : m_order(order),
          m_radius(radius),
          m_enough(enough),
          m_search(order, enough),
          m_visit(visit),
          m_scans(LeafSearch::canScan(order))
    {
        const double steps = radius / m_search.unit();
        m_limit = steps * steps * (1 + double(kLeafScanError));
        m_scans = m_scans && m_limit < 1e30;
    }
    void clear() { m_search.clear(); }
    void leaf(std::size_t leaf, std::span<const std::uint32_t> points, const Progress& progress)
    {
        // Where a leaf is no larger than the radius, its points are neighbors of each other.
        if (m_order.points(leaf).size() >= m_enough && diagonal(leaf) < m_radius * (1 - 1e-9)) {
            for (const std::uint32_t point : points) m_visit(point, m_order.points(leaf).size());
            return;
        }
        const bool listed = m_scans && m_search.list(leaf, m_limit);
        for (const std::uint32_t point : points) {
            if (progress.cancelled()) return;
            if (listed) {
                m_search.from(point);
                m_visit(point, m_search.countWithin(m_radius, m_enough));
            } else if (m_order.within(point, m_radius, m_found, progress)) {
                m_visit(point, m_found.size());
            }
        }
    }

private:
    double diagonal(std::size_t leaf) const
    {
        const KdOrder::Box& box = m_order.box(leaf);
        return std::sqrt(m_order.squaredDistance(KdOrder::place(box.min), KdOrder::Box{box.max, box.max}));
    }

    const KdOrder& m_order;
    double m_radius;
    double m_limit = 0;
    std::size_t m_enough;
    LeafSearch m_search;
    const Visit& m_visit;
    bool m_scans;
    std::vector<KdOrder::Found> m_found;
};

}  // namespace

void forEachNearest(const KdOrder& order, std::size_t k, const std::string& stage, Progress& progress,
                    const NeighborVisitor& visit, const PointSet* of)
{
    if (k == 0) return;
    forLeaves(order, stage, progress, of, [&] { return NearestSearch(order, k, visit); });
}

void forEachWithin(const KdOrder& order, double radius, const std::string& stage, Progress& progress,
                   const NeighborVisitor& visit, const PointSet* of)
{
    forLeaves(order, stage, progress, of, [&] { return WithinSearch(order, radius, visit); });
}

void forEachCount(const KdOrder& order, double radius, std::size_t enough, const std::string& stage,
                  Progress& progress, const std::function<void(std::uint32_t, std::size_t)>& visit,
                  const PointSet* of)
{
    forLeaves(order, stage, progress, of, [&] { return CountSearch(order, radius, enough, visit); });
}

}  // namespace punctum
