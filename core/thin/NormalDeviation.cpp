// SPDX-License-Identifier: MIT
// Normal deviation clustering: Goswami et al. 2013, section 3.3.1.
#include "core/thin/Surface.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace punctum
{

namespace
{

using Vector = SurfacePiece::Vector;

constexpr float kFlat =
    0.05f;  ///< radians: what a cluster counts as bent at least, so that large ones are split, too
constexpr double kCells = 0.5;  ///< of the points that are to be kept
constexpr int kGridTries = 12;

float squaredBetween(const Vector& a, const Vector& b)
{
    const float x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return x * x + y * y + z * z;
}

/// The cell of each point in a grid of K cells along the longest side of the piece, in one number.
std::vector<std::uint64_t> gridCells(const SurfacePiece& piece, const Vector& low, float side)
{
    std::vector<std::uint64_t> cells(piece.own);
    for (std::size_t k = 0; k < piece.own; ++k)
        for (std::size_t a = 0; a < 3; ++a)
            cells[k] =
                cells[k] << 20 | std::uint64_t(std::clamp((piece.places[k][a] - low[a]) / side, 0.0f, 1048575.0f));
    return cells;
}

std::size_t distinct(std::vector<std::uint64_t> cells)
{
    std::sort(cells.begin(), cells.end());
    return std::size_t(std::unique(cells.begin(), cells.end()) - cells.begin());
}

}  // namespace

DeviationClusters::DeviationClusters(const SurfacePiece& piece, double share) : m_piece(piece), m_members(piece.own)
{
    std::iota(m_members.begin(), m_members.end(), 0u);
    if (piece.own == 0) return;
    Vector low = piece.places[0], high = low;
    for (std::size_t k = 0; k < piece.own; ++k)
        for (std::size_t a = 0; a < 3; ++a) {
            low[a] = std::min(low[a], piece.places[k][a]);
            high[a] = std::max(high[a], piece.places[k][a]);
        }
    const float longest = std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2], 1e-6f});
    // The finest grid, of K from 1 on, that has no more cells with points than are wanted.
    const double wanted = std::max(1.0, kCells * share);
    float coarse = longest * 1.001f, fine = coarse / 4096;
    for (int k = 0; k < kGridTries; ++k) {
        const float between = std::sqrt(coarse * fine);
        (double(distinct(gridCells(piece, low, between))) <= wanted ? coarse : fine) = between;
    }
    const std::vector<std::uint64_t> cells = gridCells(piece, low, coarse);
    std::stable_sort(m_members.begin(), m_members.end(), [&](auto a, auto b) { return cells[a] < cells[b]; });
    for (std::uint32_t k = 0; k < piece.own; ++k) {
        if (k == 0 || cells[m_members[k]] != cells[m_members[k - 1]]) m_clusters.push_back({k, k, 0});
        m_clusters.back().last = k + 1;
    }
    for (std::uint32_t c = 0; c < m_clusters.size(); ++c) {
        measure(m_clusters[c]);
        push(c);
    }
}

Vector DeviationClusters::middleOf(const Cluster& cluster) const
{
    std::array<double, 3> sum{};
    for (std::uint32_t k = cluster.first; k < cluster.last; ++k)
        for (std::size_t a = 0; a < 3; ++a) sum[a] += double(m_piece.places[m_members[k]][a]);
    const double n = double(cluster.last - cluster.first);
    return {float(sum[0] / n), float(sum[1] / n), float(sum[2] / n)};
}

/// The error of a cluster is a length: its radius times the largest angle between a normal and the one of its first
/// point (the paper orders by the angle; times the radius it says how far off its plane a cluster is).
void DeviationClusters::measure(Cluster& cluster) const
{
    const Vector middle = middleOf(cluster);
    float radius = 0, most = 0;
    for (std::uint32_t k = cluster.first; k < cluster.last; ++k) {
        radius = std::max(radius, squaredBetween(m_piece.places[m_members[k]], middle));
        most = std::max(most, bend(m_piece.normals[m_members[k]], m_piece.normals[m_members[cluster.first]]));
    }
    cluster.error = std::sqrt(radius) * (std::acos(std::max(0.0f, 1 - most)) + kFlat);
}

void DeviationClusters::push(std::uint32_t cluster)
{
    if (m_clusters[cluster].last - m_clusters[cluster].first < 2) return;
    m_queue.emplace_back(m_clusters[cluster].error, cluster);
    std::push_heap(m_queue.begin(), m_queue.end());
}

float DeviationClusters::split()
{
    if (m_queue.empty()) return -1;
    std::pop_heap(m_queue.begin(), m_queue.end());
    const std::uint32_t c = m_queue.back().second;
    m_queue.pop_back();
    Cluster& cluster = m_clusters[c];
    m_least = std::min(m_least, cluster.error);
    // Two members that differ most, from the first one on: by their normals as far as these differ, and by place.
    const auto first = m_members.begin() + cluster.first, last = m_members.begin() + cluster.last;
    const Vector middle = middleOf(cluster);
    float radius = 1e-30f, most = 1e-6f;
    for (auto m = first; m != last; ++m) {
        radius = std::max(radius, squaredBetween(m_piece.places[*m], middle));
        most = std::max(most, bend(m_piece.normals[*m], m_piece.normals[*first]));
    }
    // Normals count in full where they differ by some degrees or more.
    const float weight = std::min(1.0f, most / 0.02f) / most;
    const auto differ = [&](std::uint32_t a, std::uint32_t b) {
        return squaredBetween(m_piece.places[a], m_piece.places[b]) / radius +
               weight * bend(m_piece.normals[a], m_piece.normals[b]);
    };
    const auto furthest = [&](std::uint32_t from) {
        auto best = first;
        float far = -1;
        for (auto m = first; m != last; ++m)
            if (const float d = differ(from, *m); d > far) {
                far = d;
                best = m;
            }
        return *best;
    };
    const std::uint32_t a = furthest(*first), b = furthest(a);
    auto middleMember =
        std::stable_partition(first, last, [&](std::uint32_t m) { return differ(m, a) <= differ(m, b); });
    // All in one place with one normal: any half will do.
    if (middleMember == last || middleMember == first) middleMember = first + (last - first) / 2;
    const auto cut = std::uint32_t(middleMember - m_members.begin());
    m_clusters.push_back({cut, cluster.last, 0});  // ends the reference
    m_clusters[c].last = cut;
    for (const std::uint32_t part : {c, std::uint32_t(m_clusters.size() - 1)}) {
        measure(m_clusters[part]);
        push(part);
    }
    return m_least;
}

std::vector<std::uint32_t> DeviationClusters::representatives() const
{
    std::vector<std::uint32_t> chosen;
    for (const Cluster& cluster : m_clusters) {
        const Vector middle = middleOf(cluster);
        std::uint32_t best = m_members[cluster.first];
        for (std::uint32_t k = cluster.first; k < cluster.last; ++k)
            if (squaredBetween(m_piece.places[m_members[k]], middle) < squaredBetween(m_piece.places[best], middle))
                best = m_members[k];
        chosen.push_back(m_piece.points[best]);
    }
    return chosen;
}

}  // namespace punctum
