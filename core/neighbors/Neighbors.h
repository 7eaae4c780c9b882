// SPDX-License-Identifier: MIT
#pragma once

#include "core/neighbors/KdOrder.h"

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>

namespace punctum
{

/// The surroundings of one point. Lengths in KdOrder::lengths().
struct Neighborhood {
    std::uint32_t point = 0;
    std::span<const std::uint32_t> points;          ///< indices of the neighbors; itself is among them
    std::span<const std::array<float, 3>> offsets;  ///< of the neighbors from the point
    std::span<const float> squared;                 ///< their distances, squared
};

/// Called from worker threads, several at once, once for each point.
using NeighborVisitor = std::function<void(const Neighborhood&)>;

/// The exact k nearest neighbors of every point, itself among them and first, nearest first (fewer when the cloud
/// has not so many). `stage` names the work to the user. Throws Cancelled.
///
/// The cloud is searched tile by tile, in parallel: each tile's points and a margin around them go into a kd-tree
/// of PCL (FLANN), in floats from the tile's own middle. A point whose k-th neighbor lies further than the margin
/// reaches is searched again in the whole order, so that nothing depends on the tiles. Neighbors whose distances
/// differ by less than floats can tell (a hundred-thousandth, where points lie evenly) may stand for one another.
void forEachNearest(const KdOrder& order, std::size_t k, const std::string& stage, Progress& progress,
                    const NeighborVisitor& visit);

/// The same with all neighbors not further than `radius`, in no order.
void forEachWithin(const KdOrder& order, double radius, const std::string& stage, Progress& progress,
                   const NeighborVisitor& visit);

}  // namespace punctum
