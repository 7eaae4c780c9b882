// SPDX-License-Identifier: MIT
#pragma once

#include "core/raster/MapCrs.h"
#include "core/raster/Raster.h"

#include <filesystem>

namespace punctum
{

class Progress;

/// How a raster becomes a file.
struct GeoTiffOptions {
    enum class Sample {
        Float,  ///< 32 bits; cells without a value are -9999
        Byte    ///< whole numbers 1 to 255; 0: no value
    };
    Sample sample = Sample::Float;
    /// What a cell of a smaller copy is: the mean of the four cells that have a value, or the one of the north-west
    /// that has one, for codes and the like.
    enum class Overview { Mean, Nearest } overview = Overview::Mean;
    enum class Big { Auto, Yes } big = Big::Auto;  ///< BigTIFF: when the file may need 4 GB; always
};

/// Writes a cloud-optimized GeoTIFF (OGC 21-026, GeoTIFF 1.1): tiles of 512 x 512, deflate with predictor, halved
/// copies down to one tile, all directories before the data, smallest copies first in the file; PixelIsArea, the
/// north-western corner as tie point; the coordinate system by EPSG's codes, or in words where it has none. Whole
/// or not at all (las::AtomicFile); tiles are packed in parallel. Gives the bytes of the file. Throws Error,
/// Cancelled.
std::uint64_t writeGeoTiff(const std::filesystem::path& path, const Raster& raster, const MapCrs& crs,
                           const GeoTiffOptions& options, Progress& progress);

}  // namespace punctum
