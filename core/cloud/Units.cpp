// SPDX-License-Identifier: MIT
#include "core/cloud/Units.h"

#include "core/cloud/PointCloud.h"
#include "core/task/LockedLoop.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <shared_mutex>

namespace punctum
{

namespace
{

constexpr double kFoot = 0.3048;                 ///< meters of an international foot
constexpr double kSurveyFoot = 1200.0 / 3937.0;  ///< meters of a U.S. survey foot
constexpr double kDegree = std::numbers::pi / 180.0;

}  // namespace

CoordinateUnits CoordinateUnits::degreesAndMeters()
{
    return {Kind::Degrees, "deg", "m", kDegree, 1.0, false};
}

std::string lengthName(double meters, std::string_view name)
{
    // The two feet differ by two millionths; files state them with as few as six digits.
    constexpr double kSame = 1e-7;
    const auto is = [&](double size) { return std::abs(meters / size - 1.0) < kSame; };
    if (is(1.0)) return "m";
    if (std::abs(meters / kFoot - 1.0) < 5e-6)
        return std::abs(meters - kFoot) < std::abs(meters - kSurveyFoot) ? "ft" : "ftUS";
    if (is(1000.0)) return "km";
    if (is(0.01)) return "cm";
    if (is(0.001)) return "mm";
    return std::string(name);
}

TrueLengths trueLengths(const CoordinateUnits& units, const WorldBounds& bounds)
{
    using Kind = CoordinateUnits::Kind;
    TrueLengths lengths;
    if (units.kind != Kind::Degrees) {
        lengths.unit = units.horizontal;
        lengths.meters = units.horizontalSize;
        if (units.horizontalSize > 0.0 && units.verticalSize > 0.0)
            lengths.stretch.z = units.verticalSize / units.horizontalSize;
        return lengths;
    }
    lengths.unit = "m";
    lengths.meters = 1.0;
    if (bounds.empty()) return lengths;
    // Radii of curvature of the ellipsoid along the meridian and across it (any textbook of geodesy).
    constexpr double kEquator = 6378137.0, kEccentricity2 = 0.00669437999014, kPole = 89.0 * kDegree;
    const double angle = units.horizontalSize;
    const double latitude = std::clamp((bounds.min.y + bounds.max.y) / 2 * angle, -kPole, kPole);
    const double sine = std::sin(latitude), root = std::sqrt(1.0 - kEccentricity2 * sine * sine);
    const double across = kEquator / root, along = kEquator * (1.0 - kEccentricity2) / (root * root * root);
    lengths.stretch = {across * std::cos(latitude) * angle, along * angle,
                       units.verticalSize > 0.0 ? units.verticalSize : 1.0};
    return lengths;
}

TrueLengths trueLengths(const PointCloud& cloud, const WorldBounds& bounds)
{
    return trueLengths(cloud.units(), bounds);
}

TrueLengths trueLengths(const PointCloud& cloud)
{
    if (cloud.units().kind != CoordinateUnits::Kind::Degrees) return trueLengths(cloud.units(), {});
    const std::shared_lock lock(cloud.mutex());
    const RawBounds bounds = runLocked(lock, [&] { return cloud.computeBounds(); });
    return trueLengths(cloud.units(), cloud.coordinates().toWorld(bounds));
}

}  // namespace punctum
