// SPDX-License-Identifier: MIT
#pragma once

#include "core/raster/Raster.h"

#include <glm/vec3.hpp>

#include <cstddef>

namespace punctum
{

class Progress;

/// Shape of a surface of heights, cell by cell, by the slopes that Horn takes of the eight cells around (B. K. P.
/// Horn, "Hill shading and the reflectance map", 1981). A neighbor that has no height is put opposite to the one
/// across, so that the edge has values; cells without a height have none.
///
/// `stretch`: TrueLengths::stretch of the cloud, so that degrees and heights in another unit are true slopes. All
/// in parallel; they throw Cancelled.

/// Degrees from level, 0 to 90.
Raster slopeOf(const Raster& heights, const glm::dvec3& stretch, Progress& progress);
/// Where it goes downhill: degrees from north, clockwise, 0 to 360; none where it is level.
Raster aspectOf(const Raster& heights, const glm::dvec3& stretch, Progress& progress);

/// Where the light comes from.
struct Sun {
    double azimuth = 315.0;     ///< degrees from north, clockwise
    double altitude = 45.0;     ///< degrees above the horizon
    double exaggeration = 1.0;  ///< of the heights
};
/// Brightness 1 (in the shade) to 255.
Raster hillshadeOf(const Raster& heights, const Sun& sun, const glm::dvec3& stretch, Progress& progress);

/// Gives cells without a value one, where there is one within `reach` cells both ways along at least two of the
/// four directions across: means of what the eight directions meet, nearer ones counting more (1 / distance^2).
/// What is open to the outside stays open. Not in place, so that the result does not depend on the order.
Raster holesFilled(const Raster& raster, std::size_t reach, Progress& progress);

/// Means of a cell (4 parts), its neighbors (2 parts) and those across corners (1 part), where there are values, so
/// many times: what contours are smoothed by.
Raster smoothed(const Raster& raster, int times, Progress& progress);

/// Cells that are lower than the median of the eight around by more than `depth` get that median: the holes that
/// single rays leave in crowns (after the idea of Ben-Arie et al. 2009).
Raster pitsFilled(const Raster& raster, double depth, Progress& progress);

}  // namespace punctum
