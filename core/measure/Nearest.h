// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <vector>

namespace punctum
{

class Progress;

struct NearPoint {
    PointIndex index = 0;
    double distance = 0.0;  ///< in units of length
};

/// The `count` points nearest to `point`, itself left out, nearest first (of equally near ones those of lower
/// index), by a look at the points of those stretches of the file whose boxes are near enough, in parallel: there
/// is no index to build. `stretch`: as for quantitiesOf. Takes cloud.mutex() shared. Throws Cancelled.
std::vector<NearPoint> nearestTo(const PointCloud& cloud, PointIndex point, std::size_t count,
                                 const glm::dvec3& stretch, Progress& progress);

}  // namespace punctum
