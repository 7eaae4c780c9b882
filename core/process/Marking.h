// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"
#include "core/edit/Command.h"
#include "core/process/StepParameter.h"

#include <memory>
#include <string>
#include <vector>

namespace punctum
{

class Progress;

/// What a step does with the points that it found, as its key `do=` says: it gives them a class, sets their
/// Withheld flag or deletes them. Used by steps that people want in each of these ways.

/// The parameter `do`; `choices`: of class, withheld, delete and what the step itself knows.
StepParameter doParameter(std::vector<std::string> choices, std::string preset, std::string help);
/// The parameter `class`; without a preset it is needed for do=class alone.
StepParameter doClassParameter(std::string preset, std::string help);

/// The command that does it; null when all points are marked so already, or there are none. Deleted points are left
/// alone. Throws Error (no classes, no flags, a class that is not given) and Cancelled.
std::unique_ptr<Command> markPoints(const std::string& name, const PointCloud& cloud,
                                    std::shared_ptr<PointSet> points, const StepValues& values, Progress& progress);

/// The points that are no points for a step: deleted ones; with `noise`, also those of the classes 7 and 18. Null:
/// none is. Throws Cancelled.
std::shared_ptr<const PointSet> pointsLeftOut(const PointCloud& cloud, bool noise, Progress& progress);
/// The points that a step does not look at which looks at those of `within` alone: the others, and deleted ones.
/// Null: it looks at all.
std::shared_ptr<const PointSet> pointsOutside(const PointCloud& cloud, const PointSet* within);

}  // namespace punctum
