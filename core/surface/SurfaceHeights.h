// SPDX-License-Identifier: MIT
#pragma once

#include "core/surface/SurfaceTiles.h"

#include <functional>

namespace punctum
{

/// Called for some points that lie over one tile, with their exact heights above its surface, in units of true
/// length; NaN where there is no surface. By several threads at once, for different points.
using HeightsAbove = std::function<void(std::span<const std::uint32_t> points, std::span<const float> heights)>;

/// Heights above the surface of the points of a set, tile by tile. 4 bytes for each point of it. Takes no lock.
/// Throws Cancelled.
void forHeightsAbove(const SurfaceTiles& tiles, const PointCloud& cloud, const PointSet& points, Progress& progress,
                     const HeightsAbove& f);

/// The points of `among` whose height above the surface is from `low` to `high` (units of true length; each may be
/// infinite). In parallel. Throws Cancelled.
PointSet pointsBetween(const SurfaceTiles& tiles, const PointCloud& cloud, const PointSet& among, double low,
                       double high, Progress& progress);

}  // namespace punctum
