// SPDX-License-Identifier: MIT
#pragma once

#include "core/raster/MapCrs.h"
#include "core/raster/MapLines.h"

#include <filesystem>
#include <vector>

namespace punctum
{

class Progress;

/// How lines and areas become a file.
struct VectorOptions {
    bool wgs84 = false;  ///< GeoJSON: in longitude and latitude, as RFC 7946 has it; else in the cloud's system
    int decimals = 3;    ///< of coordinates; in degrees four more
};

/// Lines, areas and places of a map, to be written as one file.
struct VectorMap {
    std::vector<ContourLine> lines;
    std::vector<MapArea> areas;
    MapTable table;
};

/// Whether the name of a file ends in .geojson, .json or .dxf, in any case.
bool isVectorName(const std::filesystem::path& path);
/// The same, or in .csv, which takes tables alone.
bool isTableName(const std::filesystem::path& path);

/// Writes GeoJSON (.geojson, .json), DXF (.dxf) or the table as CSV (.csv), by the ending; whole or not at all
/// (las::AtomicFile). Throws Error, Cancelled.
void writeVectors(const std::filesystem::path& path, const VectorMap& map, const MapCrs& crs,
                  const VectorOptions& options, Progress& progress);

/// GeoJSON. Contours are LineStrings with "elevation" and "index"; areas Polygons with "area"; places Points with
/// the columns of the table, whose values are null where there are none. In the cloud's
/// system the file says which by the member "crs" of GeoJSON 2008, which most programs still read, where the system
/// has a code of EPSG; with wgs84 it is as RFC 7946 asks. Throws Error where PROJ knows no way there.
std::string geoJsonText(const VectorMap& map, const MapCrs& crs, const VectorOptions& options, Progress& progress);

/// DXF as AutoCAD R12 reads it: polylines at their heights on the layers CONTOUR and CONTOUR_INDEX, closed ones of
/// areas on the layer OUTLINE, points on that of the table.
std::string dxfText(const VectorMap& map, const VectorOptions& options, Progress& progress);

/// CSV (RFC 4180): a line with the names, the first column, x and y, then the others; numbers with a point, nothing
/// where there is no value.
std::string csvText(const MapTable& table, const MapCrs& crs, const VectorOptions& options, Progress& progress);

}  // namespace punctum
