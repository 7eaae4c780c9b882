// SPDX-License-Identifier: MIT
#pragma once

#include "core/surface/SurfaceTiles.h"

#include <cstdint>
#include <span>
#include <vector>

namespace punctum
{

/// Which tiles of a surface touch each tile, at an edge or a corner. Immutable; tiles keep their boxes whatever
/// changes in them.
class TileNeighbors
{
public:
    /// In parallel.
    explicit TileNeighbors(const SurfaceTiles& tiles);

    /// In rising order, without the tile itself.
    std::span<const std::uint32_t> of(std::size_t tile) const noexcept
    {
        return std::span(m_neighbors).subspan(m_first[tile], m_first[tile + 1] - m_first[tile]);
    }

private:
    std::vector<std::uint32_t> m_neighbors;  ///< those of all tiles, one after the other
    std::vector<std::size_t> m_first;        ///< where each tile's begin
};

}  // namespace punctum
