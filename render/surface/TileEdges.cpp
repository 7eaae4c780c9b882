// SPDX-License-Identifier: MIT
#include "render/surface/TileEdges.h"

#include <algorithm>
#include <cmath>

namespace punctum::render
{

bool TileEdges::hasCoarserNeighbor(std::size_t tile) const noexcept
{
    const auto neighbors = m_view.neighbors->of(tile);
    return std::any_of(neighbors.begin(), neighbors.end(),
                       [&](std::uint32_t other) { return m_cells[other] > m_cells[tile]; });
}

/// Sides are powers of two of raw steps, so that all of this is exact.
bool TileEdges::isNode(std::size_t tile, double x, double y) const noexcept
{
    const RawRect& box = m_view.tiles[tile]->box;
    return std::fmod(x - box.minX, m_cells[tile]) == 0 && std::fmod(y - box.minY, m_cells[tile]) == 0;
}

double TileEdges::ownHeight(std::size_t tile, double x, double y) const noexcept
{
    const SurfaceTile& own = *m_view.tiles[tile];
    const double cell = (own.box.maxX - own.box.minX) / SurfaceTile::kCells;
    const int i = int((x - own.box.minX) / cell), j = int((y - own.box.minY) / cell);
    return own.base + double(own.height(i, j));
}

double TileEdges::height(std::size_t tile, double x, double y) const noexcept
{
    std::size_t coarsest = tile;
    for (const std::uint32_t other : m_view.neighbors->of(tile))
        if (m_cells[other] > m_cells[coarsest] && m_view.tiles[other]->box.holds(x, y) && !isNode(other, x, y))
            coarsest = other;
    if (coarsest == tile) return ownHeight(tile, x, y);
    const RawRect& box = m_view.tiles[coarsest]->box;
    const double cell = m_cells[coarsest];
    const double alongX = std::fmod(x - box.minX, cell), alongY = std::fmod(y - box.minY, cell);
    // on an edge of the box one of them is 0
    const double before = alongX != 0 ? height(coarsest, x - alongX, y) : height(coarsest, x, y - alongY);
    const double after =
        alongX != 0 ? height(coarsest, x - alongX + cell, y) : height(coarsest, x, y - alongY + cell);
    const double share = (alongX != 0 ? alongX : alongY) / cell;
    const double between = before * (1 - share) + after * share;
    return std::isnan(between) ? ownHeight(tile, x, y) : between;
}

}  // namespace punctum::render
