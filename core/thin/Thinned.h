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

/// What steps that thin share: what becomes of the points that are not kept, and what is told of those that are.

/// do= and class=.
std::vector<StepParameter> thinnedParameters();
/// The command that deletes or marks the points that are neither kept nor left out, or that writes the attribute
/// Kept (1, or 0 for them); null when all points are kept. Throws Error and Cancelled.
std::unique_ptr<Command> thinTo(const std::string& name, const PointCloud& cloud, const PointSet& kept,
                                const PointSet* leftOut, const StepValues& values, Progress& progress);

}  // namespace punctum
