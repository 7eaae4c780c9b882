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

/// The exact k nearest neighbors of every point (of `of`, where given), nearest first, those equally near by index;
/// itself is among them, and first where it is alone in its place. Fewer when the order has not so many. `stage`
/// names the work to the user. Throws Cancelled.
///
/// Points are searched leaf by leaf, in parallel: the leaves near a leaf are found once for all its points.
/// Candidates are told by floats, eight at once where the processor can, in differences of the raw integers; where
/// floats cannot tell them apart, distances are computed exactly.
void forEachNearest(const KdOrder& order, std::size_t k, const std::string& stage, Progress& progress,
                    const NeighborVisitor& visit, const PointSet* of = nullptr);

/// The same with all neighbors not further than `radius`, in no order.
void forEachWithin(const KdOrder& order, double radius, const std::string& stage, Progress& progress,
                   const NeighborVisitor& visit, const PointSet* of = nullptr);

/// Tells how many points are not further than `radius` from each point, itself counted; as soon as there are
/// `enough`, the rest need not be counted.
void forEachCount(const KdOrder& order, double radius, std::size_t enough, const std::string& stage,
                  Progress& progress, const std::function<void(std::uint32_t point, std::size_t count)>& visit,
                  const PointSet* of = nullptr);

}  // namespace punctum
