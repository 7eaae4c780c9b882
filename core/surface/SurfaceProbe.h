// SPDX-License-Identifier: MIT
#pragma once

#include "core/surface/SurfaceTiles.h"

#include <cstdint>
#include <optional>

namespace punctum
{

/// Asks a surface for heights of places near each other: the net of the last place's tile is kept. A value for one
/// thread; borrows the tiles.
class SurfaceProbe
{
public:
    explicit SurfaceProbe(const SurfaceTiles& tiles) : m_tiles(&tiles) {}

    /// Height (raw) of a place (raw); none where there is no surface.
    std::optional<double> at(double x, double y)
    {
        const auto tile = m_tiles->tileAt(x, y);
        if (!tile) return std::nullopt;
        if (*tile != m_tile) {
            m_net = m_tiles->net(*tile);
            m_tile = *tile;
            m_near = 0;
        }
        return m_net.height(x, y, m_near);
    }

private:
    const SurfaceTiles* m_tiles;
    std::size_t m_tile = SIZE_MAX;
    SurfaceNet m_net;
    std::uint32_t m_near = 0;
};

}  // namespace punctum
