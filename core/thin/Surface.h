// SPDX-License-Identifier: MIT
#pragma once

#include "core/neighbors/KdOrder.h"

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace punctum
{

class Progress;

/// A piece of a cloud for work on its surface: points of a node of the order, and a margin of others around them,
/// with the plane of each. Points are numbered from 0 here, own ones first.
///
/// Normals have no side: what two of them differ by is the smaller of their two angles.
struct SurfacePiece {
    using Vector = std::array<float, 3>;

    /// `neighbors`: how many nearest points a plane is fitted to, the point among them. False when cancelled.
    bool read(const KdOrder& order, std::size_t node, std::size_t neighbors, double marginSpacings,
              const Progress& progress);

    std::size_t own = 0;                           ///< the first ones
    std::vector<std::uint32_t> points;             ///< indices in the cloud
    std::vector<Vector> places;                    ///< from a place of the piece's own, in units of length
    std::vector<Vector> normals;                   ///< (0, 0, 0) where there is no plane
    std::vector<float> areas;                      ///< of the surface that a point stands for
    std::vector<std::vector<std::uint32_t>> near;  ///< a point's nearest ones, as far as they are in the piece
};

/// 1 - |cos| of the angle between two normals, 0 where one of them is none.
float bend(const SurfacePiece::Vector& a, const SurfacePiece::Vector& b) noexcept;
/// The normal of the plane of least squares; (0, 0, 0) where there is none.
SurfacePiece::Vector planeNormal(std::span<const std::array<float, 3>> places) noexcept;

/// What a piece of a cloud is thinned by: how much each of its own points is worth to the surface. Points of less
/// worth go before others, whatever piece they are in. `share`: how many points the piece would keep if all kept
/// alike; no point of a quarter of it may be worth less than any other, and beyond four times as many worth need
/// not be exact.
using WorthOfPoints = std::vector<float>;

/// Entropy-based reduction and k-clustering of Goswami et al. 2013; false when cancelled.
bool worthByEntropy(const SurfacePiece& piece, double share, WorthOfPoints& worth, const Progress& progress);
bool worthByClustering(const SurfacePiece& piece, double share, WorthOfPoints& worth, const Progress& progress);

/// Normal deviation clustering of a piece.
class DeviationClusters
{
public:
    /// The cells of the grid that the piece begins with, some half of `share` of them.
    DeviationClusters(const SurfacePiece& piece, double share);
    std::size_t clusters() const noexcept { return m_clusters.size(); }
    /// Splits the cluster of the largest error, and tells this error, or less where an earlier one was less; a
    /// negative number when every cluster is one point.
    float split();
    /// The point of each cluster that stands for it.
    std::vector<std::uint32_t> representatives() const;

private:
    struct Cluster {
        std::uint32_t first = 0, last = 0;  ///< in m_members
        float error = 0;
    };
    void measure(Cluster& cluster) const;
    void push(std::uint32_t cluster);
    SurfacePiece::Vector middleOf(const Cluster& cluster) const;

    const SurfacePiece& m_piece;
    std::vector<std::uint32_t> m_members;
    std::vector<Cluster> m_clusters;
    std::vector<std::pair<float, std::uint32_t>> m_queue;  ///< a heap; of equal errors the last cluster first
    float m_least = INFINITY;
};

}  // namespace punctum
