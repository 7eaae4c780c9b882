// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <vector>

namespace punctum
{

class Progress;

/// Points of a sample that pointSpacing() looks at: some ten milliseconds on two cores.
inline constexpr std::size_t kSpacingSamples = 4096;

/// Typical distance between neighboring points of a cloud that covers surfaces: as if they lay at random on one
/// surface, of which the distances in a random subset tell. 0 when the subset has too few points, or when all of
/// them lie in one place.
///
/// `sample`: such a subset, up to kSpacingSamples; any frame, in the unit of the result. `points`: of the cloud it
/// is taken from.
double pointSpacing(const std::vector<glm::vec3>& sample, PointIndex points);
/// The same of a cloud's points but for deleted ones, in units of length; `stretch`: TrueLengths::stretch. Takes
/// cloud.mutex() shared. Throws Cancelled.
double pointSpacing(const PointCloud& cloud, const glm::dvec3& stretch, Progress& progress);

/// The number of one digit, 1, 2 or 5 times a power of ten, nearest to a positive length: what a field is preset
/// to.
double roundLength(double length) noexcept;

}  // namespace punctum
