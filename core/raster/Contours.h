// SPDX-License-Identifier: MIT
#pragma once

#include "core/raster/MapLines.h"
#include "core/raster/Raster.h"

#include <cstddef>
#include <vector>

namespace punctum
{

class Progress;

/// How contours are drawn.
struct ContourOptions {
    double step = 1.0;      ///< units of height between them
    double base = 0.0;      ///< one of their heights
    int indexEvery = 5;     ///< each so manieth is an index contour, counted from `base`; 0: none
    double simplify = 0.1;  ///< cells that a line may be off for having fewer points; 0: all points
    double shortest = 0.0;  ///< length in cells below which closed lines are left out
};

/// Lines of equal height through the middles of a raster's cells: marching squares, saddles split by the mean of
/// their corners, joined to lines as long as they go. Of a surface without jumps such lines never cross; where
/// simplifying would make two of them cross or touch, both keep all their points. In the order of heights; the same
/// on any number of threads. Throws Cancelled, and Error when there would be too many.
std::vector<ContourLine> contoursOf(const Raster& heights, const ContourOptions& options, Progress& progress);

/// The lines of one level alone, not simplified: what outlines are made of.
std::vector<ContourLine> levelLines(const Raster& raster, float level, Progress& progress);

/// A line with fewer points, none of which is further than `tolerance` from the old line (Douglas and Peucker
/// 1973); a closed one keeps three at least.
std::vector<glm::dvec2> simplified(const std::vector<glm::dvec2>& points, bool closed, double tolerance);

}  // namespace punctum
