// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"

#include <memory>
#include <string>
#include <vector>

namespace punctum
{

class Progress;

/// Which points a map is made of; for this folder alone.

/// Those for which all conditions hold; empty conditions count for nothing. Null: all points. The first one is the
/// user's: throws Error where it holds for no point; ExpressionError, Cancelled.
std::shared_ptr<const PointSet> pointsWhere(const PointCloud& cloud, const std::vector<std::string>& conditions,
                                            Progress& progress);
/// "not Classification in (7, 18)"; empty where the cloud has no classes.
std::string noNoise(const PointCloud& cloud);
/// "ReturnNumber <= 1"; empty where the cloud has no returns.
std::string firstReturns(const PointCloud& cloud);
/// Throws Error when no map can be made of the cloud's coordinates.
void checkMapped(const PointCloud& cloud);

}  // namespace punctum
