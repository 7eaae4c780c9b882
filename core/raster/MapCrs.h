// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Units.h"

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace punctum
{

class PointCloud;

/// The coordinate system of a map, as files of maps name it.
struct MapCrs {
    bool geographic = false;       ///< X and Y are angles
    std::uint16_t horizontal = 0;  ///< EPSG's code of the system of X and Y; 0: it has none, or is not known
    std::uint16_t vertical = 0;    ///< of the heights, likewise
    std::uint16_t unit = 0;        ///< EPSG's code of the unit of X and Y; 0: unknown
    std::uint16_t verticalUnit = 0;
    std::string name;  ///< for people; empty when no system is known
    std::string wkt;   ///< in ESRI's words, for a system without a code; else empty
    std::string text;  ///< as SourceFile::crs
    CoordinateUnits units;
    /// A GeoTIFF key, with its number, real number or text.
    struct Key {
        std::uint16_t id = 0;
        std::variant<std::uint16_t, double, std::string> value;
    };
    /// Of a file whose GeoTIFF keys define a system of their own: all keys, as they are.
    std::vector<Key> keys;

    bool known() const noexcept { return horizontal != 0 || !wkt.empty() || !keys.empty(); }
};

/// Of a cloud, from its file's WKT or GeoTIFF keys; never throws for what a file holds. Needs no lock.
MapCrs mapCrs(const PointCloud& cloud);

}  // namespace punctum
