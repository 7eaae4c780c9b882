// SPDX-License-Identifier: MIT
#pragma once

#include "core/above/CellGrid.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace punctum
{

/// Roofs seen from above.
struct RoofAreas {
    std::vector<std::uint8_t> inside;  ///< of each cell: a roof, holes closed
    std::size_t count = 0;             ///< how many areas there are
};

/// Areas of cells that touch each other, of at least `least` cells, in which a square of `width` cells a side has
/// room. Holes of a cell are closed. Throws Cancelled.
RoofAreas findRoofAreas(const CellGrid& grid, std::vector<std::uint8_t> roofs, std::size_t least,
                        std::int32_t width, Progress& progress);

}  // namespace punctum
