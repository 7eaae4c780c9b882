// SPDX-License-Identifier: MIT
#pragma once

#include "core/raster/MapCrs.h"
#include "core/surface/Polygon.h"

#include <filesystem>
#include <string>
#include <vector>

namespace punctum
{

/// An area of a file: its rings, holes too, and what it is called there.
struct NamedArea {
    std::string name;
    std::vector<Ring> rings;
};

/// The polygons of a GeoJSON file, in the coordinates of a cloud with this system; a MultiPolygon is one area. Each
/// is called by its property "name", or the id of its feature, or its number from 1. The file's system is what its
/// member "crs" says; without one it is longitude and latitude, as RFC 7946 has it, where all numbers can be such
/// and the cloud is not in degrees itself, else the cloud's. Throws Error: it cannot be read, is no GeoJSON, has no
/// polygons, or cannot be converted.
std::vector<NamedArea> readAreas(const std::filesystem::path& path, const MapCrs& crs);

}  // namespace punctum
