// SPDX-License-Identifier: MIT
#include "core/above/RoofAreas.h"

namespace punctum
{

namespace
{

/// Cells of which all (`all`), or any, in a square about them are marked; what has no block is as if it were not.
std::vector<std::uint8_t> cellsBySquare(const CellGrid& grid, const std::vector<std::uint8_t>& marked,
                                        std::int32_t from, std::int32_t to, bool all, Progress& progress)
{
    std::vector<std::uint8_t> result(marked.size(), 0);
    grid.forCells(progress, [&](std::size_t cell) {
        bool found = all;
        for (std::int32_t dy = from; dy <= to && found == all; ++dy)
            for (std::int32_t dx = from; dx <= to && found == all; ++dx) {
                const std::size_t other = grid.beside(cell, dx, dy);
                found = other != CellGrid::kNone && marked[other] != 0;
            }
        result[cell] = std::uint8_t(found);
    });
    return result;
}

}  // namespace

RoofAreas findRoofAreas(const CellGrid& grid, std::vector<std::uint8_t> roofs, std::size_t least,
                        std::int32_t width, Progress& progress)
{
    progress.begin("Finding roofs", grid.cells());
    const auto wider = cellsBySquare(grid, roofs, -1, 1, false, progress);
    roofs = cellsBySquare(grid, wider, -1, 1, true, progress);
    const auto roomy = cellsBySquare(grid, roofs, 0, width - 1, true, progress);

    RoofAreas areas;
    areas.inside.assign(grid.cells(), 0);
    std::vector<std::uint8_t> seen(grid.cells(), 0);
    std::vector<std::size_t> area;
    for (std::size_t cell = 0; cell < grid.cells(); ++cell) {
        if (cell % CellGrid::kBlock == 0) {
            progress.check();
            progress.add(CellGrid::kBlock);
        }
        if (roofs[cell] == 0 || seen[cell] != 0) continue;
        area.assign(1, cell);
        seen[cell] = 1;
        bool wide = false;
        for (std::size_t next = 0; next < area.size(); ++next) {
            if (next % CellGrid::kBlock == 0) progress.check();
            wide = wide || roomy[area[next]] != 0;
            for (std::int32_t dy = -1; dy <= 1; ++dy)
                for (std::int32_t dx = -1; dx <= 1; ++dx) {
                    const std::size_t other = grid.beside(area[next], dx, dy);
                    if (other == CellGrid::kNone || roofs[other] == 0 || seen[other] != 0) continue;
                    seen[other] = 1;
                    area.push_back(other);
                }
        }
        if (!wide || area.size() < least) continue;
        ++areas.count;
        for (const std::size_t own : area) areas.inside[own] = 1;
    }
    return areas;
}

}  // namespace punctum
