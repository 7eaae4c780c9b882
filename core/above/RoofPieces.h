// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointRanks.h"
#include "core/neighbors/KdOrder.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace punctum
{

/// What points of one flat piece have in common. Lengths in units of length.
struct RoofOptions {
    std::size_t neighbors = 0;  ///< that a point's plane is fitted to
    double roughness = 0;       ///< the most by which they leave it, as a standard deviation
    double steepest = 0;        ///< slope of a roof, in radians
    double bend = 0;            ///< between the normals of neighbors in one piece, in radians
};

inline constexpr std::uint32_t kNoPiece = UINT32_MAX;

/// Regions of points that are smooth and flat nearly everywhere (smoothness constraint: Rabbani et al. 2006).
/// Points are told by their ranks in the set that was looked at, so that others take no memory.
struct RoofPieces {
    std::vector<std::uint32_t> pieceOf;  ///< of each point: the least rank of the piece's points
    std::vector<std::uint8_t> level;     ///< of each point: whether its plane is nearly level
};

/// Of the points in the order, which are those that are ranked. Two neighbors are of one piece where their planes
/// agree; so the pieces are the same on any number of threads. Throws Cancelled.
RoofPieces findRoofPieces(const KdOrder& order, const PointRanks& ranks, const RoofOptions& options,
                          Progress& progress);

}  // namespace punctum
