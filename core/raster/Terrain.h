// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"
#include "core/raster/Raster.h"

namespace punctum
{

class Progress;

/// Heights of the surface that points make, in the middles of cells: of the plane of the triangle there, in the one
/// Delaunay triangulation of all points (of those in one place the lowest), by true lengths. Triangles whose circle
/// is wider than `bridge` (units of length: TrueLengths) are none: across larger voids, and outside of the points,
/// there is no surface.
///
/// The triangulation is made piece by piece, in parallel: a triangle with a circle no wider than `bridge` is one of
/// the whole when it is one of all points within that distance. So the result is the same on any number of threads,
/// however the points are ordered or cut into files; beyond the raster it takes 4 bytes a point, and some 100 bytes
/// for each point of a piece. Heights are `world`. Throws Cancelled, Error.
Raster surfaceHeights(const PointCloud& cloud, const PointSet& points, const RasterFrame& frame, double bridge,
                      Progress& progress);

}  // namespace punctum
