// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"

#include <memory>

namespace punctum
{

class Progress;

/// Which points of a cloud are kept when it is thinned. Each takes `leftOut`, points that are none (null: all are
/// some), gives the same on any number of threads, and throws Cancelled.

/// Which point of a cell is kept. What is as good goes by the places of the points, then by their order.
enum class CellChoice {
    Middle,   ///< nearest to the middle of the cell
    Lowest,   ///< noise, of the classes 7 and 18, only where there is nothing else
    Highest,  ///< likewise
    Random,   ///< by a number made of the place
    First,    ///< in the order of the survey
};

/// One point of each cell (WorldGrid) of this size that has points. Which place is kept depends on the points of
/// the cell alone (but for `First`), not on how a survey is cut into files.
std::shared_ptr<PointSet> chooseByGrid(const PointCloud& cloud, double cell, CellChoice choice,
                                       const PointSet* leftOut, Progress& progress);

/// Poisson disk sampling by throwing darts at the points themselves (Cook 1986): points are taken in a random
/// order, and each is kept where no kept one is nearer than `radius`. So of the kept ones no two are nearer, and
/// every other point has a kept one nearer than that.
///
/// The order is by tiles of 16 radii a side, those of even places along all axes first, then seven other groups, so
/// that tiles of a group do not touch each other and are done in parallel (Wei 2008, Parallel Poisson Disk
/// Sampling, does so with cells); in a tile by a number made of the place of the point, so that the places that are
/// kept do not depend on how a survey is cut into files.
std::shared_ptr<PointSet> chooseByDistance(const PointCloud& cloud, double radius, const PointSet* leftOut,
                                           Progress& progress);

/// Exactly `count` points (all when there are fewer), at random but evenly: points are put into a row in which
/// near ones follow each other, the row is cut into `count` pieces as long as each other, and one of each is taken.
std::shared_ptr<PointSet> chooseByNumber(const PointCloud& cloud, PointIndex count, const PointSet* leftOut,
                                         Progress& progress);

}  // namespace punctum
