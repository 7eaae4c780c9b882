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
    float slope = 0.135f;     ///< what stands out more than this over a window's radius is no ground
    float window = 20;        ///< radius of the largest opening: half the width of buildings
    float threshold = 0.45f;  ///< how far ground may be from the surface where it is flat
    float steepness = 1;      ///< by how much more, times the slope

    // -- what need not be changed
    float meter = 1;          ///< the unit of length is so many of it a meter
    float pitReach = 5;       ///< low outliers: pits not wider than twice this
    float pitDepth = 2;       ///< ... deeper than this,
    float pitArea = 30;       ///< ... and not larger than this (square)
    float trendReach = 8;     ///< the trend that the second pass looks at heights above: means over such squares
    float trendShare = 0.8f;  ///< so much of the trend is taken off: where the first pass was wrong it misleads
    float trendSlope = 1;     ///< in the second pass the tolerance grows by so much a slope of the trend
    float slopeShare = 1.1f;  ///< the slope of the second pass, of `slope`
    float step = 0.03f;       ///< ... which begins with this
    float tolReach = 3;       ///< the slope for the tolerance is blurred by so much
    float cliff = 2;          ///< tolerance on cliffs: so many times the square of what the slope is beyond 1
    float roofRadius = 60;    ///< large roofs are searched by openings of this radius
    float roofHeight = 2;     ///< ... that find what is so much higher,
    float roofArea = 50;      ///< ... larger than this,
    float roofDrop = 1.5f;    ///< ... and ends with such a drop within two meters
    float roofEdge = 0.6f;    ///< ... along this share of its outline
};

/// The bare surface without holes, and how far from it a point may be to be ground.
struct BareSurface {
    HeightGrid heights, tolerance;
};

/// Finds it below lowest points of cells (`lowest`; NaN where there are none). All empty: all NaN.
///
/// The progressive morphological filter of Zhang et al. 2003 with the linear window and the springs of Pingel et
/// al. 2013 (SMRF), and beyond it: (1) low outliers are small deep pits of the surface that an opening left, so
/// that clumps are found and courtyards are not; (2) a second pass over heights above the trend of the first one's
/// surface, with a tolerance that grows with its slope: on slopes an opening by flat windows takes convex ground
/// for objects and leaves low objects; (3) roofs larger than the window go by their outline, which drops along most
/// of it, as a hill's does not; (4) the tolerance grows faster than the slope beyond 1, where a height is as
/// uncertain as its place. Parallel inside; the same on any number of threads. Throws Cancelled.
BareSurface bareSurface(HeightGrid lowest, const BareSurfaceSettings& settings, const Progress& progress);

/// How many cells away a height may matter: windows of a larger grid overlap by so much.
int reachInCells(const BareSurfaceSettings& settings);

}  // namespace punctum
