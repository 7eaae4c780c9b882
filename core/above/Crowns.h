// SPDX-License-Identifier: MIT
#pragma once

#include "core/above/CellGrid.h"

#include <cstdint>
#include <vector>

namespace punctum
{

/// What tells one crown from the next. Lengths in units of length.
struct CrownOptions {
    double smoothing = 0;     ///< standard deviation of the blur
    double window = 0;        ///< least distance of a top from a higher place
    double windowGrowth = 0;  ///< added to it, for each unit of the top's height
    double leastShare = 0;    ///< of a top's height: what is lower is not of its crown
    double widest = 0;        ///< farthest that a crown reaches from its top
    double leastHeight = 0;
};

inline constexpr std::uint32_t kNoCrown = UINT32_MAX;

/// Cells of each crown, in a surface of heights above the ground (one float a cell; NaN: nothing there).
struct Crowns {
    std::vector<std::uint32_t> crownOf;  ///< of each cell
    std::vector<std::size_t> tops;       ///< cell of each crown's top, by rows
};

/// Tops are the places of a blurred surface that are the highest in a window that grows with their height (Popescu
/// and Wynne 2004); the crowns are what climbs to them by the steepest way (watershed), as far as they are high and
/// near enough (Dalponte and Coomes 2016). Every cell is decided by what is around it: the same on any number of
/// threads. Throws Cancelled.
Crowns findCrowns(const CellGrid& grid, const std::vector<float>& surface, const CrownOptions& options,
                  Progress& progress);

}  // namespace punctum
