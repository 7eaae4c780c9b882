// SPDX-License-Identifier: MIT
#pragma once

#include "core/raster/MapCrs.h"
#include "core/raster/Raster.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace punctum
{

/// The beginning of a cloud-optimized GeoTIFF: header, the lines that say how the file is laid out, all directories
/// and the lists of tiles; libtiff and libgeotiff make it in memory, before and after the tiles are written. For
/// GeoTiff.cpp alone. One thread. Throws Error.
class TiffHead
{
public:
    static constexpr std::size_t kTileSide = 512;
    /// Size of a picture in the file, the whole one or a smaller copy.
    struct Level {
        std::size_t columns = 0, rows = 0;
        std::size_t across() const noexcept { return (columns + kTileSide - 1) / kTileSide; }
        std::size_t tiles() const noexcept { return across() * ((rows + kTileSide - 1) / kTileSide); }
    };

    TiffHead(const std::vector<Level>& levels, const RasterFrame& frame, const MapCrs& crs, bool floats,
             const std::string& noData, bool big);
    ~TiffHead();
    TiffHead(const TiffHead&) = delete;
    TiffHead& operator=(const TiffHead&) = delete;

    /// Where the tiles begin.
    std::uint64_t bytes() const noexcept;
    /// Where a tile lies; levels and tiles as they were given, rows first.
    void setTile(std::size_t level, std::size_t tile, std::uint64_t offset, std::uint64_t size) noexcept;
    /// All bytes, once every tile is set.
    const std::vector<std::byte>& finish();

private:
    struct Impl;
    std::unique_ptr<Impl> m_impl;
};

}  // namespace punctum
