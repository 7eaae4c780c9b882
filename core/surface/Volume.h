// SPDX-License-Identifier: MIT
#pragma once

#include "core/surface/SurfaceTiles.h"

#include <glm/vec2.hpp>

#include <optional>
#include <vector>

namespace punctum
{

/// What lies between a surface and what it is compared with, in units of true length.
struct Volume {
    double cut = 0;          ///< of the surface above the base: what would have to be taken away
    double fill = 0;         ///< below it: what would have to be brought
    double area = 0;         ///< where both are
    double lacking = 0;      ///< area of what was asked for where one of them is not
    std::size_t points = 0;  ///< ground points of the surface in the area
    /// Of the height of one ground point about the surface of its neighbors (standard deviation, from the median of
    /// the amounts, so that a few steps do not count): noise of the points, and roughness of the ground.
    double residual = 0;
    /// Standard deviation of net(): each point stands for its share of the area with an error of its own, so
    /// residual * area / sqrt(points), of both surfaces together where there are two. Errors that many points
    /// share (a shift of a flight, vegetation taken for ground) are not in it.
    double deviation = 0;

    double net() const noexcept { return cut - fill; }
};

/// What a surface is compared with, and where.
struct VolumeQuestion {
    double base = 0;                           ///< a height in `world`
    const PointCloud* otherCloud = nullptr;    ///< or another surface, in the same coordinate system ...
    const SurfaceTiles* otherTiles = nullptr;  ///< ... of these
    std::vector<glm::dvec2> within;            ///< a polygon in `world`; empty: everywhere
};

/// The volume, from heights at the middles of a lattice about three times as fine as the ground points are in each
/// tile. In parallel, the same on any number of threads. Throws Cancelled, and Error (the area is none).
Volume volumeOf(const PointCloud& cloud, const SurfaceTiles& tiles, const VolumeQuestion& question,
                Progress& progress);

/// The convex hull of points (world X and Y), as VolumeQuestion::within; fewer than three corners where there is
/// none.
std::vector<glm::dvec2> outlineOf(const PointCloud& cloud, const PointSet& points);

}  // namespace punctum
