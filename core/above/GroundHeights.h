// SPDX-License-Identifier: MIT
#pragma once

#include "core/above/GroundTree.h"
#include "core/process/Values.h"

#include <cstddef>
#include <functional>
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

/// The height of each point for a step that needs them: those of the attribute HeightAboveGround where every point
/// has one, else measured, from the triangulated ground. Deleted points: NaN. Throws as groundOf() does.
std::vector<float> heightsAboveGround(const PointCloud& cloud, const ClassSet& ground, const std::string& name,
                                      Progress& progress);

}  // namespace punctum
