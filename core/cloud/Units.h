// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec3.hpp>

#include <string>
#include <string_view>

namespace punctum
{

class PointCloud;
struct WorldBounds;

/// What one step of a cloud's `world` coordinates is, as its coordinate system says (las::readCrs()).
struct CoordinateUnits {
    enum class Kind {
        Unknown,  ///< no coordinate system is stated, or none that can be understood
        Lengths,  ///< X, Y and Z are lengths, Z points up
        Degrees,  ///< X is a longitude and Y a latitude, in degrees or another angle; Z is a length and points up
        Geocentric,  ///< X, Y and Z are lengths from the middle of the earth: no axis points up
    };
    Kind kind = Kind::Unknown;
    std::string horizontal;       ///< of X and Y: "m", "ft", "ftUS", "deg", or a name in full; empty when unknown
    std::string vertical;         ///< of Z, likewise
    double horizontalSize = 0.0;  ///< meters of one such unit, of angles radians; 0 when unknown
    double verticalSize = 0.0;    ///< meters of one unit of Z; 0 when unknown
    bool guessed = false;         ///< nothing is stated: the numbers look like degrees

    /// Longitude and latitude in degrees, heights in meters.
    static CoordinateUnits degreesAndMeters();

    friend bool operator==(const CoordinateUnits&, const CoordinateUnits&) = default;
};

/// Short name of a unit of length of so many meters: "m", "ft", "ftUS"; `name` where there is no short one.
std::string lengthName(double meters, std::string_view name);

/// How lengths are measured in a cloud whose axes may have different units.
///
/// Example, the distance of two points in `lengths.unit`:
///     const TrueLengths lengths = trueLengths(cloud);
///     const double distance = glm::length((b - a) * lengths.stretch);
/// Raw integers are stretched by `lengths.stretch * cloud.coordinates().scale`.
struct TrueLengths {
    glm::dvec3 stretch{1.0};  ///< units of length that one unit of `world` is along X, Y and Z
    std::string unit;     ///< the unit of length: that of X and Y, "m" where these are angles; empty when unknown
    double meters = 0.0;  ///< of one unit of length; 0 when unknown

    friend bool operator==(const TrueLengths&, const TrueLengths&) = default;
};

/// Angles become meters on the WGS 84 ellipsoid at the latitude of the middle of `bounds` (world; nothing is
/// stretched when they are empty); heights in another unit of length than X and Y become that one; otherwise
/// nothing is stretched.
TrueLengths trueLengths(const CoordinateUnits& units, const WorldBounds& bounds);
/// The same of a cloud, at the middle of `bounds`. Any thread; needs no lock.
TrueLengths trueLengths(const PointCloud& cloud, const WorldBounds& bounds);
/// The same at the middle of all points, which are looked at where the cloud's units are angles (a pass over X and
/// Y, in parallel). The cloud's mutex() must not be held alone by another thread.
TrueLengths trueLengths(const PointCloud& cloud);

}  // namespace punctum
