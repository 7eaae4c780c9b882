// SPDX-License-Identifier: MIT
#pragma once

#include "core/ground/HeightGrid.h"

namespace punctum
{

class Progress;

/// How the bare surface is found. Lengths in one unit; the presets are meters, and were chosen over the eight
/// samples of the ISPRS filter test together (docs/dev/ground.md).
struct BareSurfaceSettings {
    float cell = 1;
    float slope = 0.15f;      ///< what stands out more than this over a window's radius is no ground
    float window = 18;        ///< radius of the largest opening: half the width of buildings
    float threshold = 0.45f;  ///< how far ground may be from the surface where it is flat
    float steepness = 1;      ///< by how much more, times the slope

    // -- what need not be changed
    float meter = 1;           ///< the unit of length is so many of it a meter
    float pitReach = 5;        ///< low outliers: pits not wider than twice this
    float pitDepth = 2;        ///< ... deeper than this,
    float pitArea = 30;        ///< ... and not larger than this (square)
    float trendReach = 8;      ///< later passes look at heights above the trend: means over such squares
    float trendShare = 0.8f;   ///< so much of the trend is taken off: where the pass before was wrong it misleads
    float trendSlope = 0.6f;   ///< the tolerance of later passes grows by so much a slope of the trend,
    float edgeShare = 0.2f;    ///< ... and by this share of how far the surface is from its trend: at edges
    float toleranceReach = 3;  ///< ... both of them blurred by so much
    float step = 0.03f;        ///< ... and begins with this
    float bumpReach = 3;       ///< bumps stand out of means over such squares
    float bumpHeight = 0.15f;  ///< ... by this
    float bumpRoughness = 4;   ///< ... and so many times what the surface differs from them around
    float cliff = 2;           ///< tolerance on cliffs: so many times the square of what the slope is beyond 1
    float roofRadius = 60;     ///< large roofs are searched by openings of this radius
    float roofHeight = 2;      ///< ... that find what is so much higher,
    float roofArea = 50;       ///< ... larger than this,
    float roofDrop = 1.5f;     ///< ... and ends with such a drop within two meters
    float roofEdge = 0.6f;     ///< ... along this share of its outline; where objects adjoin,
    float roofBeyond = 40;     ///< ... the ground that is not farther than this beyond them is looked at
};

/// The bare surface without holes, and how far from it a point may be to be ground.
struct BareSurface {
    HeightGrid heights, tolerance;
};

/// Finds it below lowest points of cells (`lowest`; NaN where there are none). All empty: all NaN.
///
/// The progressive morphological filter of Zhang et al. 2003 with the linear window and the springs of Pingel et
/// al. 2013 (SMRF), whose one set of parameters are the presets, and beyond it: (1) low outliers are small deep
/// pits of the surface that an opening left, so that clumps are found and courtyards are not; (2) two more passes
/// over heights above the trend of the surface that the pass before left, with a tolerance that grows with its
/// slope and at its edges: on slopes an opening by flat windows takes convex ground for objects and leaves low
/// objects; (3) roofs larger than the window go by their outline, which drops along most of it, as a hill's does
/// not; (4) then bumps go that stand out of a surface which is smooth around them, such as bushes: what remains
/// must agree with what is around it, as in the densifying of Axelsson 2000; (5) the tolerance grows faster than
/// the slope beyond 1, where a height is as uncertain as its place. Parallel inside; the same on any number of
/// threads. Throws Cancelled.
BareSurface bareSurface(HeightGrid lowest, const BareSurfaceSettings& settings, const Progress& progress);

/// How many cells away a height may matter: windows of a larger grid overlap by so much.
int reachInCells(const BareSurfaceSettings& settings);

}  // namespace punctum
