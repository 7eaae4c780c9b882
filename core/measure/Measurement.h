// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace punctum
{

/// What can be measured between points of a cloud.
enum class MeasureKind {
    Point,     ///< one point, with all it holds
    Distance,  ///< between two
    Height,    ///< how much the second is above the first
    Angle,     ///< at the second of three
    Area,      ///< of a polygon of three and more
    Box,       ///< along the axes, between two opposite corners
    Volume,    ///< between a surface and a base, within a polygon of three and more (core/surface/Volume.h)
};

/// "distance", and back.
std::string_view nameOf(MeasureKind kind) noexcept;
std::optional<MeasureKind> measureKindOf(std::string_view name) noexcept;
/// Points that complete it; 0: any number of three and more.
std::size_t pointsOf(MeasureKind kind) noexcept;

/// A point of a cloud, and where it is (world, CRS units).
struct MeasuredPoint {
    PointIndex index = 0;
    glm::dvec3 world{0.0};
};

struct Quantity {
    enum class Unit { None, Length, Area, Volume, Degrees };
    std::string name;  ///< "Distance", "dx"
    double value = 0.0;
    Unit unit = Unit::Length;
};

/// The first is what was asked for ("Distance"), the others go with it ("Horizontal", "dx", "dy", "dz"). `stretch`:
/// how many units of length a world unit is along each axis (1, but for degrees, and for feet beside meters). Empty
/// while there are too few points; a Point has its coordinates alone, in world units, and a Volume what is known of
/// its polygon without the surface.
std::vector<Quantity> quantitiesOf(MeasureKind kind, const std::vector<MeasuredPoint>& points,
                                   const glm::dvec3& stretch);

/// "m²" of "m"; empty for an unknown unit of length, but for angles.
std::string unitText(Quantity::Unit unit, const std::string& length);

/// Decimals of lengths between points of such a cloud: some more than its steps have. `stretch` as above.
int lengthDecimals(const CoordinateScale& coordinates, const glm::dvec3& stretch);

/// A measurement with what it is told by.
struct Measurement {
    MeasureKind kind = MeasureKind::Distance;
    std::string file;               ///< name of the cloud's file
    std::string length;             ///< unit of length: "m"
    int decimals = 6;               ///< that its quantities are told with: lengthDecimals()
    CoordinateScale coordinates{};  ///< of the cloud: decimals of the points
    std::vector<MeasuredPoint> points;
    std::vector<Quantity> quantities;
    std::vector<std::pair<std::string, std::string>> facts{};  ///< what else is to be told, with its name
};

/// As CSV after RFC 4180, in UTF-8: number, kind, file, name, value, unit; a line for each quantity and fact, and
/// for index, X, Y and Z of each point. Coordinates are exact, and quantities have the decimals that make sense;
/// both with a point.
std::string toCsv(const std::vector<Measurement>& measurements);

}  // namespace punctum
