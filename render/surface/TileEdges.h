// SPDX-License-Identifier: MIT
#pragma once

#include "core/surface/Surface.h"

#include <cstddef>
#include <span>

namespace punctum::render
{

/// Heights along the edges of tiles that are drawn by cells of different sizes, so that the surface has no cracks
/// there: a tile with finer cells keeps to the straight lines between the nodes of a coarser neighbor.
///
/// A height is a function of the place alone, whichever tile asks: of the tiles that meet there and have no node
/// there, the one with the largest cells decides, and the nodes between which the place lies are asked the same
/// way. Each time cells are larger, so that this ends. Borrows both; any thread.
class TileEdges
{
public:
    /// `cells`: of each tile, the side of the cells that it is drawn by, raw; 0: it is not drawn.
    TileEdges(const SurfaceView& view, std::span<const double> cells) : m_view(view), m_cells(cells) {}

    /// Whether a neighbor is drawn by larger cells than the tile: if not, its own nodes are right.
    bool hasCoarserNeighbor(std::size_t tile) const noexcept;
    /// Raw height at a node of the tile on its edge, NaN where there is no surface.
    double height(std::size_t tile, double x, double y) const noexcept;

private:
    double ownHeight(std::size_t tile, double x, double y) const noexcept;
    bool isNode(std::size_t tile, double x, double y) const noexcept;

    const SurfaceView& m_view;
    std::span<const double> m_cells;
};

}  // namespace punctum::render
