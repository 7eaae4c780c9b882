// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"

#include <memory>

namespace punctum
{

class Progress;

/// A cloud of these points alone, but for deleted ones, in their order, with all their values; its source is like
/// that of the whole, so that header and records are written along with it. Parallel; takes cloud.mutex() shared.
/// Memory: what the points take. Throws Error (memory) and Cancelled.
std::shared_ptr<PointCloud> extracted(const PointCloud& cloud, const PointSet& points, Progress& progress);

}  // namespace punctum
