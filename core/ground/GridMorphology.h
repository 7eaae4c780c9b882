// SPDX-License-Identifier: MIT
#pragma once

#include "core/ground/HeightGrid.h"

namespace punctum
{

class Progress;

/// Opening and closing of a grid without holes by octagons of so many cells radius, as steps of a cross and a
/// square in turn: some nanoseconds a cell and step, whatever the radius. What lies outside of the grid does not
/// count. Threads: parallel inside. Throw Cancelled.

/// What is narrower than the octagon and stands out upward is cut off.
HeightGrid openedBy(const HeightGrid& grid, int radius, const Progress& progress);
/// What is narrower than the octagon and reaches downward is filled.
HeightGrid closedBy(const HeightGrid& grid, int radius, const Progress& progress);

}  // namespace punctum
