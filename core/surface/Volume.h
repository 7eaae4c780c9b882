// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointSet.h"
#include "core/surface/Polygon.h"
#include "core/surface/SurfaceTiles.h"
#include "core/surface/VolumeBase.h"

#include <bitset>
#include <cstddef>
#include <span>
#include <vector>

namespace punctum
{

/// What lies between a surface and what it is compared with, in units of true length.
struct Volume {
    double cut = 0;          ///< of the surface above the base: what would have to be taken away
    double fill = 0;         ///< below it: what would have to be brought
    double area = 0;         ///< where both are
    double lacking = 0;      ///< area of what was asked for where one of them is not
    double height = 0;       ///< mean height of the base in `world`
    double edge = 0;         ///< length of the edge that a base was made of
    double edgeLacking = 0;  ///< and of its parts that have no surface
    std::size_t points = 0;  ///< points of the surface in the area
    /// Of the height of one such point about the surface of its neighbors (standard deviation, from the median of
    /// the amounts, so that a few steps do not count): noise of the points, and roughness of the ground.
    double residual = 0;
    /// Standard deviation of net(): each point stands for its share of the area with an error of its own, so
    /// residual * area / sqrt(points), of both surfaces together where there are two. A base made of the edge's
    /// heights is as good as the points along it: as many as fit into its length, or one for the lowest. Errors
    /// that many points share (a shift of a flight, vegetation taken for ground) are not in it.
    double deviation = 0;

    double net() const noexcept { return cut - fill; }
};

/// What a surface is compared with, and where.
struct VolumeQuestion {
    VolumeBase base = VolumeBase::Height;
    double height = 0;                         ///< of Height, in `world`
    const PointCloud* otherCloud = nullptr;    ///< of Surface: this cloud's, in the same coordinate system ...
    const SurfaceTiles* otherTiles = nullptr;  ///< ... of these
    std::vector<Ring> within;                  ///< an area in `world`, holes too; empty: everywhere
};

/// The volume, from heights at the middles of a lattice about three times as fine as the points are in each tile;
/// of cells on the area's edge the part inside counts. In parallel, the same on any number of threads. Throws
/// Cancelled, and Error (the area is none; no surface there; a base of the edge without an area).
Volume volumeOf(const PointCloud& cloud, const SurfaceTiles& tiles, const VolumeQuestion& question,
                Progress& progress);

/// The points that a surface within an area is made of: those of some classes (null: of all) that are not `hidden`
/// (null: none is) nor deleted, in the area's rectangle and as far about it as the surface reaches, so that it is
/// that of all such points. Empty `within`: all. Parallel; takes cloud.mutex() shared for some 20 ms at a time.
/// Throws Error (there are no classes), and Cancelled.
PointSet pointsForVolume(const PointCloud& cloud, std::span<const Ring> within, const std::bitset<256>* classes,
                         const PointSet* hidden, Progress& progress);
/// Whether at least three of the points are in the area.
bool anySurfaceIn(const PointCloud& cloud, std::span<const Ring> within, const PointSet& points);

/// The convex hull of points (world X and Y); fewer than three corners where there is none.
Ring outlineOf(const PointCloud& cloud, const PointSet& points);

}  // namespace punctum
