// SPDX-License-Identifier: MIT
#pragma once

#include "core/ground/HeightGrid.h"

namespace punctum
{

class Progress;

/// Gives empty cells heights: springs to their four neighbors hold them (Pingel et al. 2013, section 2.1). Solved
/// from coarse to fine, some rounds on each scale, so that a hole of any size is smooth. A grid without any height
/// stays as it is. Parallel inside; the same on any number of threads. Throws Cancelled.
void fillHoles(HeightGrid& grid, const Progress& progress);

/// The steepness of each cell, from its neighbors: height over length. `cell`: its side.
HeightGrid slopesOf(const HeightGrid& grid, float cell);

/// Three means over squares that reach so many cells to each side: nearly a Gaussian blur.
void blurGrid(HeightGrid& grid, int reach, const Progress& progress);

}  // namespace punctum
