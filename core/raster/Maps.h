// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"
#include "core/raster/GeoTiff.h"
#include "core/raster/MapLines.h"
#include "core/raster/Rasterize.h"
#include "core/raster/Relief.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace punctum
{

class Progress;

/// What a map tells.
enum class MapKind {
    Attribute,  ///< any attribute, by a statistic
    Dtm,        ///< heights of the ground
    Dsm,        ///< heights of what is seen from above
    Chm,        ///< heights above ground of what is seen from above
    Density,    ///< points a square unit of length
    Hillshade,
    Slope,
    Aspect
};
/// "dtm", "hillshade"; nothing for other words, which name attributes.
std::optional<MapKind> parseMapKind(std::string_view word);
std::string_view nameOf(MapKind kind) noexcept;

/// A map to be made of a cloud. Lengths are in units of X and Y where nothing else is said.
struct MapRequest {
    MapKind kind = MapKind::Dtm;
    std::string attribute = "Z";  ///< of MapKind::Attribute: the attribute
    Statistic statistic{};        ///< of MapKind::Attribute
    double cell = 0;              ///< 0: fits the data (mapCell())
    std::string where;            ///< condition; empty: all points
    std::string ground = "2";     ///< classes of the ground, as steps name them
    bool noise = false;           ///< classes 7 and 18 count, too; else they do not, but for Attribute and Density
    std::optional<int> fill;      ///< cells that DSM and CHM fill holes across; not given: 3
    double bridge = 0;            ///< widest void the ground is drawn across; 0: 100 cells
    double pits = 0;              ///< CHM: pits deeper than that are filled; 0: none
    bool reliefOfDsm = false;     ///< Hillshade, Slope, Aspect: of the DSM
    Sun sun{};
};

/// A map, and how it is best written.
struct MapOutcome {
    Raster raster;
    GeoTiffOptions options;
    std::string finding;  ///< a sentence: what the map was made of; may be empty
};

/// A size of cells that fits: 2.5 times the spacing of the points, one digit, in units of X and Y; 1 where there is
/// none. Throws Cancelled.
double mapCell(const PointCloud& cloud, Progress& progress);

/// Makes a map. Deleted points are left out. Takes cloud.mutex() shared for some ms at a time. Throws Cancelled,
/// and Error where it cannot be made.
MapOutcome makeMap(const PointCloud& cloud, const MapRequest& request, Progress& progress);

/// Outlines of points.
struct OutlineRequest {
    std::string where;     ///< condition; empty: all points
    double cell = 0;       ///< 0: fits the data
    double close = 0;      ///< gaps narrower than that are closed; 0: 3 cells
    double simplify = 0;   ///< the outline may be so far off; 0: one cell
    double leastArea = 0;  ///< smaller areas, and holes, are left out, square units of X and Y; 0: 16 cells
    bool convex = false;   ///< one convex hull
};
/// The areas that points cover, largest first: cells that hold points, gaps closed, drawn around (marching
/// squares), with holes. Throws Cancelled, Error.
std::vector<MapArea> outlinesOf(const PointCloud& cloud, const OutlineRequest& request, Progress& progress);

}  // namespace punctum
