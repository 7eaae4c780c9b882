// SPDX-License-Identifier: MIT
// k-clustering: Goswami et al. 2013, section 3.3.3, algorithm 3.
#include "core/task/Progress.h"
#include "core/thin/Surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <queue>

namespace punctum
{

namespace
{

using Vector = SurfacePiece::Vector;

constexpr std::size_t kGroups = 8;
/// Splats are so large that disks of half again as many points as are wanted fill, side by side without overlap, as
/// much of the surface as they do where they are strewn at random (0.547, Renyi's constant for disks), which leaves
/// points that can be taken out where the surface does not bend.
constexpr double kCovered = 0.547, kMoreThanWanted = 1.5;
constexpr std::size_t kMostSplats = 96;       ///< neighbors of a splat
constexpr std::size_t kMostSurrounding = 24;  ///< chosen points around a chosen one
constexpr float kApart = 0.1f;  ///< share of a distance that counts as deviation: flat parts are thinned evenly
constexpr std::size_t kStepsPerLook = 256;

/// Splats of a piece in cells as large as the largest overlap reaches.
class SplatGrid
{
public:
    SplatGrid(const SurfacePiece& piece, float cell) : m_cell(cell)
    {
        for (std::uint32_t k = 0; k < piece.places.size(); ++k)
            m_sorted.emplace_back(keyOf(piece.places[k], 0, 0, 0), k);
        std::sort(m_sorted.begin(), m_sorted.end());
    }
    template <typename F>
    void forNear(const Vector& place, F&& f) const
    {
        for (int z = -1; z <= 1; ++z)
            for (int y = -1; y <= 1; ++y) {
                // three cells along x lie in a row
                const auto first =
                    std::lower_bound(m_sorted.begin(), m_sorted.end(), std::pair(keyOf(place, -1, y, z), 0u));
                const std::uint64_t last = keyOf(place, 1, y, z);
                for (auto s = first; s != m_sorted.end() && s->first <= last; ++s) f(s->second);
            }
    }

private:
    std::uint64_t keyOf(const Vector& place, int dx, int dy, int dz) const
    {
        const auto cell = [&](float v, int d) {
            return std::uint64_t(std::clamp(std::floor(v / m_cell), -500'000.0f, 500'000.0f) + float(500'001 + d));
        };
        return cell(place[2], dz) << 42 | cell(place[1], dy) << 21 | cell(place[0], dx);
    }
    float m_cell;
    std::vector<std::pair<std::uint64_t, std::uint32_t>> m_sorted;
};

class KClustering
{
public:
    KClustering(const SurfacePiece& piece, double share)
        : m_piece(piece),
          m_share(share),
          m_chosen(piece.points.size()),
          m_radius(piece.points.size()),
          m_near(piece.points.size()),
          m_stamp(piece.points.size())
    {
    }

    bool run(WorthOfPoints& worth, const Progress& progress)
    {
        return findNeighbors(progress) && chooseGroup(progress) && removeOverlap(progress) && fillGaps(progress) &&
               removeLeastDeviation(worth, progress) && addLeastOverlap(worth, progress);
    }

private:
    struct Entry {
        float value;
        std::uint32_t point, stamp;
        /// Of a std::priority_queue: the largest value is on top, of equal ones the first point.
        bool operator<(const Entry& other) const
        {
            return value != other.value ? value < other.value : point > other.point;
        }
    };
    using Queue = std::priority_queue<Entry>;

    float distance(std::uint32_t a, std::uint32_t b) const
    {
        const Vector &p = m_piece.places[a], &q = m_piece.places[b];
        return std::sqrt((p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]) +
                         (p[2] - q[2]) * (p[2] - q[2]));
    }
    /// How far two splats reach into each other.
    float overlap(std::uint32_t a, std::uint32_t b) const
    {
        return std::max(0.0f, m_radius[a] + m_radius[b] - distance(a, b));
    }
    float overlapWithChosen(std::uint32_t p) const
    {
        float sum = 0;
        for (const std::uint32_t q : m_near[p])
            if (m_chosen[q] && q != p) sum += overlap(p, q);
        return sum;
    }

    /// Line 1: splats that overlap, d < r1 + r2.
    bool findNeighbors(const Progress& progress)
    {
        const double ratio = double(m_piece.own) / std::max(1.0, m_share * kMoreThanWanted);
        std::vector<float> sorted;
        for (std::size_t k = 0; k < m_radius.size(); ++k) {
            m_radius[k] =
                float(std::sqrt(kCovered * std::max(1.0, ratio) * double(m_piece.areas[k]) / std::numbers::pi));
            sorted.push_back(m_radius[k]);
        }
        std::sort(sorted.begin(), sorted.end());
        // Single points far from all others would make the cells too large for the rest.
        const float most = std::max(1e-6f, 2 * sorted[sorted.size() * 9 / 10]);
        for (float& radius : m_radius) radius = std::min(radius, most / 2);
        const SplatGrid grid(m_piece, most);
        std::vector<std::pair<float, std::uint32_t>> found;
        for (std::uint32_t p = 0; p < m_near.size(); ++p) {
            if (p % kStepsPerLook == 0 && progress.cancelled()) return false;
            found.clear();
            grid.forNear(m_piece.places[p], [&](std::uint32_t q) {
                const float d = distance(p, q);
                if (q != p && (d < m_radius[p] + m_radius[q] || d == 0)) found.emplace_back(d, q);
            });
            const std::size_t kept = std::min(found.size(), kMostSplats);
            std::partial_sort(found.begin(), found.begin() + std::ptrdiff_t(kept), found.end());
            for (std::size_t k = 0; k < kept; ++k) m_near[p].push_back(found[k].second);
        }
        return true;
    }

    /// Lines 2 and 3: each splat goes into that of eight groups in which it overlaps least with those before it;
    /// the largest group is taken.
    bool chooseGroup(const Progress& progress)
    {
        std::vector<std::uint8_t> group(m_near.size(), kGroups);
        std::array<std::size_t, kGroups> count{};
        for (std::uint32_t p = 0; p < m_near.size(); ++p) {
            if (p % kStepsPerLook == 0 && progress.cancelled()) return false;
            std::array<float, kGroups> sum{};
            for (const std::uint32_t q : m_near[p])
                if (group[q] < kGroups) sum[group[q]] += overlap(p, q);
            group[p] = std::uint8_t(std::min_element(sum.begin(), sum.end()) - sum.begin());
            ++count[group[p]];
        }
        const auto largest = std::uint8_t(std::max_element(count.begin(), count.end()) - count.begin());
        for (std::uint32_t p = 0; p < m_near.size(); ++p) m_chosen[p] = group[p] == largest;
        return true;
    }

    /// Lines 4 to 11.
    bool removeOverlap(const Progress& progress)
    {
        Queue queue;
        const auto push = [&](std::uint32_t p) {
            const float sum = overlapWithChosen(p);
            ++m_stamp[p];
            if (sum > 0) queue.push({sum, p, m_stamp[p]});
        };
        for (std::uint32_t p = 0; p < m_near.size(); ++p)
            if (m_chosen[p]) push(p);
        for (std::size_t step = 0; !queue.empty(); ++step) {
            if (step % kStepsPerLook == 0 && progress.cancelled()) return false;
            const Entry top = queue.top();
            queue.pop();
            if (!m_chosen[top.point] || top.stamp != m_stamp[top.point]) continue;
            m_chosen[top.point] = 0;
            for (const std::uint32_t q : m_near[top.point])
                if (m_chosen[q]) push(q);
        }
        return true;
    }

    /// Lines 13 to 17.
    bool fillGaps(const Progress& progress)
    {
        for (std::uint32_t p = 0; p < m_near.size(); ++p) {
            if (p % kStepsPerLook == 0 && progress.cancelled()) return false;
            const auto& near = m_near[p];
            if (!m_chosen[p] && std::none_of(near.begin(), near.end(), [&](auto q) { return m_chosen[q] != 0; }))
                m_chosen[p] = 1;
        }
        return true;
    }

    /// How far a chosen point and those around it are off each other's planes; and, a little, how far apart they
    /// are.
    float deviation(std::uint32_t p, const std::vector<std::uint32_t>& around) const
    {
        if (around.empty()) return std::numeric_limits<float>::max() / 4;
        float sum = 0;
        const Vector &at = m_piece.places[p], &n = m_piece.normals[p];
        for (const std::uint32_t q : around) {
            const Vector &there = m_piece.places[q], &m = m_piece.normals[q];
            float mine = 0, theirs = 0;
            for (std::size_t a = 0; a < 3; ++a) {
                mine += n[a] * (there[a] - at[a]);
                theirs += m[a] * (there[a] - at[a]);
            }
            sum += (std::fabs(mine) + std::fabs(theirs)) / 2 + kApart * distance(p, q);
        }
        return sum / float(around.size());
    }

    /// Lines 19 to 21, down to a quarter of the share: what goes early is worth little.
    bool removeLeastDeviation(WorthOfPoints& worth, const Progress& progress)
    {
        std::vector<std::vector<std::uint32_t>> around(m_near.size());
        std::size_t count = 0;
        Queue queue;  // the least deviation is wanted: values are negative
        const auto push = [&](std::uint32_t p) { queue.push({-deviation(p, around[p]), p, ++m_stamp[p]}); };
        for (std::uint32_t p = 0; p < m_near.size(); ++p) {
            if (p % kStepsPerLook == 0 && progress.cancelled()) return false;
            if (!m_chosen[p]) continue;
            count += p < m_piece.own;
            // Chosen ones have no chosen neighbors: those of their neighbors are around them.
            for (const std::uint32_t x : m_near[p])
                for (const std::uint32_t q : m_near[x])
                    if (m_chosen[q]) around[p].push_back(q);
            tidy(p, around[p]);
        }
        for (std::uint32_t p = 0; p < m_near.size(); ++p)
            if (m_chosen[p]) push(p);
        std::vector<std::uint8_t> there = m_chosen;
        float most = 0;
        const auto least = std::size_t(m_share / 4);
        for (std::size_t step = 0; count > least && !queue.empty(); ++step) {
            if (step % kStepsPerLook == 0 && progress.cancelled()) return false;
            const Entry top = queue.top();
            queue.pop();
            const std::uint32_t p = top.point;
            if (!there[p] || top.stamp != m_stamp[p]) continue;
            there[p] = 0;
            if (p < m_piece.own) {
                most = std::max(-top.value, std::nextafter(most, std::numeric_limits<float>::max()));
                worth[p] = most;
                --count;
            }
            const std::vector<std::uint32_t> others = around[p];
            for (const std::uint32_t q : others) {
                if (!there[q]) continue;
                around[q].insert(around[q].end(), others.begin(), others.end());
                auto& list = around[q];
                list.erase(std::remove_if(list.begin(), list.end(), [&](auto x) { return !there[x]; }), list.end());
                tidy(q, list);
                push(q);
            }
            around[p] = {};
        }
        for (std::uint32_t p = 0; p < m_piece.own; ++p)
            if (there[p]) worth[p] = std::numeric_limits<float>::max();
        return true;
    }
    /// Each once, without the point itself, the nearest ones.
    void tidy(std::uint32_t p, std::vector<std::uint32_t>& list) const
    {
        std::sort(list.begin(), list.end());
        list.erase(std::unique(list.begin(), list.end()), list.end());
        list.erase(std::remove(list.begin(), list.end(), p), list.end());
        if (list.size() <= kMostSurrounding) return;
        std::sort(list.begin(), list.end(), [&](auto a, auto b) {
            const float da = distance(p, a), db = distance(p, b);
            return da != db ? da < db : a < b;
        });
        list.resize(kMostSurrounding);
    }

    /// Lines 22 to 24, up to four times the share: what comes late is worth little. Worth is negative, which is
    /// less than that of all that were chosen.
    bool addLeastOverlap(WorthOfPoints& worth, const Progress& progress)
    {
        Queue queue;  // the least overlap is wanted: values are negative
        const auto push = [&](std::uint32_t p) {
            queue.push({-overlapWithChosen(p) / std::max(m_radius[p], 1e-6f), p, ++m_stamp[p]});
        };
        for (std::uint32_t p = 0; p < m_near.size(); ++p) {
            if (p % kStepsPerLook == 0 && progress.cancelled()) return false;
            if (!m_chosen[p]) push(p);
        }
        float least = -1;
        std::size_t count = 0;
        for (std::size_t step = 0; !queue.empty() && double(count) < 4 * m_share + 1; ++step) {
            if (step % kStepsPerLook == 0 && progress.cancelled()) return false;
            const Entry top = queue.top();
            queue.pop();
            const std::uint32_t p = top.point;
            if (m_chosen[p] || top.stamp != m_stamp[p]) continue;
            m_chosen[p] = 1;
            if (p < m_piece.own) {
                least = std::min(top.value - 1, std::nextafter(least, -std::numeric_limits<float>::max()));
                worth[p] = least;
                ++count;
            }
            for (const std::uint32_t q : m_near[p])
                if (!m_chosen[q]) push(q);
        }
        return true;
    }

    const SurfacePiece& m_piece;
    double m_share;
    std::vector<std::uint8_t> m_chosen;  ///< M of the paper
    std::vector<float> m_radius;
    std::vector<std::vector<std::uint32_t>> m_near;
    std::vector<std::uint32_t> m_stamp;
};

}  // namespace

bool worthByClustering(const SurfacePiece& piece, double share, WorthOfPoints& worth, const Progress& progress)
{
    worth.assign(piece.own, -std::numeric_limits<float>::max());
    return KClustering(piece, share).run(worth, progress);
}

}  // namespace punctum
