// SPDX-License-Identifier: MIT
#pragma once

#include "core/ground/HeightGrid.h"

namespace punctum
{

class Progress;

/// Opening and closing of a grid without holes by octagons of so many cells radius (at least 1), whose sides are
/// those of as many steps of a cross and a square in turn. What lies outside of the grid does not count. Threads:
/// parallel inside. Throw Cancelled.

/// What is narrower than the octagon and stands out upward is cut off.
HeightGrid openedBy(const HeightGrid& grid, int radius, const Progress& progress);
/// What is narrower than the octagon and reaches downward is filled.
HeightGrid closedBy(const HeightGrid& grid, int radius, const Progress& progress);

/// Openings of a grid without holes by octagons of 1, 2, 3 and more cells radius. The opening of an opening by a
/// larger octagon is that of the grid itself, so that each one's lowering goes on from the one before.
class GrowingOpenings
{
public:
    explicit GrowingOpenings(const HeightGrid& grid) : m_low(grid), m_spare(grid) {}
    /// The opening by the next radius; stays until the next call.
    const HeightGrid& next(const Progress& progress);

private:
    int m_radius = 0;
    HeightGrid m_low, m_spare;
};

}  // namespace punctum
