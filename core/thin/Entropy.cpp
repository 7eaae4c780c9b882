// SPDX-License-Identifier: MIT
// Entropy-based reduction: Goswami et al. 2013, section 3.3.2, equation 1 and algorithm 2.
#include "core/task/Progress.h"
#include "core/thin/Surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

namespace punctum
{

namespace
{

using Vector = SurfacePiece::Vector;

constexpr std::size_t kMostNeighbors = 6;  ///< the nearest ones, as many as a point of a surface has around it
constexpr std::size_t kMergesPerLook = 256;

/// The points of a piece while they are merged. A merged point stands where the point was that the others were
/// merged into, since points are chosen from the cloud: places do not move, normals are averages.
class EntropyReduction
{
public:
    explicit EntropyReduction(const SurfacePiece& piece)
        : m_piece(piece),
          m_near(piece.near),
          m_normals(piece.normals),
          m_level(piece.points.size()),
          m_weight(piece.points.size(), 1.0f),
          m_into(piece.points.size()),
          m_stamp(piece.points.size())
    {
        for (std::uint32_t k = 0; k < m_into.size(); ++k) m_into[k] = k;
        // Neighbors of one another: to be merged is a matter of both.
        for (std::uint32_t k = 0; k < m_near.size(); ++k)
            for (const std::uint32_t q : piece.near[k])
                if (std::find(piece.near[q].begin(), piece.near[q].end(), k) == piece.near[q].end())
                    m_near[q].push_back(k);
        for (std::uint32_t k = 0; k < m_near.size(); ++k) push(k);  // lines 1 to 6
    }

    /// Until `left` of the piece's own points are left.
    bool run(std::size_t left, WorthOfPoints& worth, const Progress& progress)
    {
        std::size_t count = m_piece.own;
        float most = 0;
        for (std::size_t merges = 0; count > left && !m_queue.empty(); ++merges) {  // line 7
            if (merges % kMergesPerLook == 0 && progress.cancelled()) return false;
            const Entry top = m_queue.top();
            m_queue.pop();
            const std::uint32_t p = top.point;
            if (m_into[p] != p || top.stamp != m_stamp[p]) continue;  // line 9
            clean(p);
            if (m_near[p].empty()) continue;  // it is the last one around
            if (const float now = entropy(p); now > top.entropy * 1.000001f) {
                push(p);
                continue;
            }
            merge(p, top.entropy, most, count, left, worth);
        }
        return true;
    }

private:
    struct Entry {
        float entropy;
        std::uint32_t point, stamp;
        /// The least one is on top; of equal ones the first point.
        bool operator<(const Entry& other) const
        {
            return entropy != other.entropy ? entropy > other.entropy : point > other.point;
        }
    };

    std::uint32_t find(std::uint32_t p)
    {
        while (m_into[p] != p) p = m_into[p] = m_into[m_into[p]];
        return p;
    }
    /// Neighbors that were merged are those that they were merged into; each once.
    void clean(std::uint32_t p)
    {
        auto& near = m_near[p];
        for (std::uint32_t& q : near) q = find(q);
        std::sort(near.begin(), near.end());
        near.erase(std::unique(near.begin(), near.end()), near.end());
        near.erase(std::remove(near.begin(), near.end(), p), near.end());
        if (near.size() <= kMostNeighbors) return;
        std::sort(near.begin(), near.end(), [&](auto a, auto b) { return nearer(p, a, b); });
        near.resize(kMostNeighbors);
    }
    bool nearer(std::uint32_t p, std::uint32_t a, std::uint32_t b) const
    {
        const float da = squared(p, a), db = squared(p, b);
        return da != db ? da < db : a < b;
    }
    float squared(std::uint32_t a, std::uint32_t b) const
    {
        const Vector &p = m_piece.places[a], &q = m_piece.places[b];
        return (p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]) + (p[2] - q[2]) * (p[2] - q[2]);
    }
    /// Equation 1, with the higher level of the two: else a point that was never merged would take in, at little
    /// cost, those that were merged often, and holes would grow.
    float entropy(std::uint32_t p) const
    {
        float sum = 0;
        for (const std::uint32_t q : m_near[p])
            sum += float(1 + std::max(m_level[p], m_level[q])) / (2 - bend(m_normals[p], m_normals[q]));
        return sum;
    }
    void push(std::uint32_t p) { m_queue.push({entropy(p), p, ++m_stamp[p]}); }

    /// Lines 10 to 17.
    void merge(std::uint32_t p, float entropyOf, float& most, std::size_t& count, std::size_t left,
               WorthOfPoints& worth)
    {
        std::vector<std::uint32_t> gone = m_near[p], around;
        std::sort(gone.begin(), gone.end(), [&](auto a, auto b) { return nearer(p, a, b); });
        std::size_t merged = 0;
        for (const std::uint32_t q : gone) {
            if (count <= left) break;  // exactly so many are to be left
            m_into[q] = p;
            around.insert(around.end(), m_near[q].begin(), m_near[q].end());
            addNormal(p, q);
            m_level[p] = std::max(m_level[p], m_level[q]);
            ++merged;
            if (q >= m_piece.own) continue;
            most = std::max(entropyOf, std::nextafter(most, std::numeric_limits<float>::max()));
            worth[q] = most;
            --count;
        }
        ++m_level[p];
        auto& near = m_near[p];
        near.assign(gone.begin() + std::ptrdiff_t(merged), gone.end());
        near.insert(near.end(), around.begin(), around.end());
        clean(p);
        push(p);
        // Whoever had one of the merged for a neighbor has another entropy now.
        for (std::uint32_t& q : around) q = find(q);
        std::sort(around.begin(), around.end());
        around.erase(std::unique(around.begin(), around.end()), around.end());
        for (const std::uint32_t q : around) {
            if (q == p) continue;
            m_near[q].push_back(p);
            clean(q);
            push(q);
        }
    }
    void addNormal(std::uint32_t p, std::uint32_t q)
    {
        Vector& n = m_normals[p];
        const Vector& other = m_normals[q];
        const float side = n[0] * other[0] + n[1] * other[1] + n[2] * other[2] < 0 ? -1.0f : 1.0f;
        float length = 0;
        for (std::size_t a = 0; a < 3; ++a) {
            n[a] = n[a] * m_weight[p] + side * m_weight[q] * other[a];
            length += n[a] * n[a];
        }
        m_weight[p] += m_weight[q];
        length = std::sqrt(length);
        if (length > 0)
            for (float& component : n) component /= length;
    }

    const SurfacePiece& m_piece;
    std::vector<std::vector<std::uint32_t>> m_near;
    std::vector<Vector> m_normals;
    std::vector<std::uint32_t> m_level;
    std::vector<float> m_weight;
    std::vector<std::uint32_t> m_into, m_stamp;
    std::priority_queue<Entry> m_queue;
};

}  // namespace

bool worthByEntropy(const SurfacePiece& piece, double share, WorthOfPoints& worth, const Progress& progress)
{
    worth.assign(piece.own, std::numeric_limits<float>::max());
    return EntropyReduction(piece).run(std::size_t(share / 4), worth, progress);
}

}  // namespace punctum
