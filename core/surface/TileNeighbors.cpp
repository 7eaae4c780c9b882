// SPDX-License-Identifier: MIT
#include "core/surface/TileNeighbors.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace punctum
{

TileNeighbors::TileNeighbors(const SurfaceTiles& tiles)
{
    std::vector<std::vector<std::uint32_t>> touching(tiles.size());
    tbb::parallel_for(std::size_t(0), tiles.size(), [&](std::size_t tile) {
        std::vector<std::uint32_t>& own = touching[tile];
        tiles.forTilesIn(tiles.box(tile), [&](std::size_t other) {
            if (other != tile) own.push_back(std::uint32_t(other));
        });
        std::sort(own.begin(), own.end());
    });
    m_first.push_back(0);
    for (const std::vector<std::uint32_t>& own : touching) {
        m_neighbors.insert(m_neighbors.end(), own.begin(), own.end());
        m_first.push_back(m_neighbors.size());
    }
}

}  // namespace punctum
