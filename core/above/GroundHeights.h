// SPDX-License-Identifier: MIT
#pragma once

#include "core/above/GroundTree.h"
#include "core/process/Values.h"

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace punctum
{

inline constexpr const char* kHeightName = "HeightAboveGround";

/// What stands for the ground between its points.
enum class GroundModel {
    Triangulated,  ///< the Delaunay triangulation of its points; beyond its rim the nearest point
    Nearest,       ///< the mean of the nearest points' heights, by the inverse of their distances
};
inline constexpr std::size_t kGroundNeighbors = 3;  ///< of GroundModel::Nearest

/// The parameter `ground`, the classes that are ground: of all steps that need heights.
StepParameter groundParameter(std::string help);

/// The ground of a cloud. Throws Cancelled, and Error where there is none, named as a need of the step `name`.
GroundTree groundOf(const PointCloud& cloud, const ClassSet& classes, const std::string& name, Progress& progress);

/// Called from worker threads, several at once, once for each point: the height is in units of length.
using HeightVisitor = std::function<void(PointIndex point, double height)>;

/// The heights above the ground of the points of `within` (null: all) that are not deleted. `k`: of
/// GroundModel::Nearest. Points of the ground have height 0 where no other is in the same place. The same on any
/// number of threads, and however the points are dealt out to files. Throws Cancelled.
void measureHeights(const PointCloud& cloud, const GroundTree& ground, GroundModel surface, std::size_t k,
                    const PointSet* within, Progress& progress, const HeightVisitor& visit);

/// Whether the attribute HeightAboveGround is there, every point has one, and they are heights above these points
/// of the ground, not above those of before an edit. Points of the ground must have height 0, as it was not theirs
/// before; points of height 0 that are not of the ground, as those that were, must have it still: both are measured
/// anew, and may differ by 5 cm. Where no point is of the ground there is nothing to compare with, and heights
/// count as they are. Throws Cancelled.
bool hasHeightsAbove(const PointCloud& cloud, const ClassSet& ground, Progress& progress);

/// The height of each point for a step that needs them.
struct PointHeights {
    std::vector<float> values;  ///< units of length; deleted points may have any, and NaN
    std::string finding;        ///< a sentence, where the attribute's were not taken though it is there; else empty
};
/// Those of the attribute HeightAboveGround as far as hasHeightsAbove(), else measured, from the triangulated
/// ground. Throws as groundOf() does.
PointHeights heightsAboveGround(const PointCloud& cloud, const ClassSet& ground, const std::string& name,
                                Progress& progress);

/// Which points are high, for a step that need not know how high.
struct HighPoints {
    std::vector<PointSet> atLeast;  ///< one set for each of the heights asked for; deleted points may be in them
    std::string finding;            ///< as PointHeights has it
};
/// The points of at least these heights by what heightsAboveGround() finds, which is not kept: a bit of each point
/// for each height instead of its 4 bytes. `least`: units of length. Throws as groundOf() does.
HighPoints highPoints(const PointCloud& cloud, const ClassSet& ground, std::span<const double> least,
                      const std::string& name, Progress& progress);

}  // namespace punctum
