// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"
#include "core/cloud/PointSet.h"

#include <cmath>
#include <cstdint>
#include <memory>

namespace punctum::test
{

/// Deterministic 64-bit hash of a number.
inline std::uint64_t hash(std::uint64_t x)
{
    x = (x ^ (x >> 31)) * 0x9E3779B97F4A7C15u;
    x = (x ^ (x >> 29)) * 0xBF58476D1CE4E5B9u;
    return x ^ (x >> 32);
}

/// A hilly 200 m x 200 m patch with walls, in file order along scan lines; X, Y, Z, Intensity, Classification (2 on
/// the ground, 6 on walls), GpsTime, and RGB of `colorMax` at most. World = raw * scale + offset.
inline std::shared_ptr<PointCloud> makeCloud(PointIndex points,
                                             CoordinateScale coordinates = {glm::dvec3(0.001), glm::dvec3(0.0)},
                                             std::uint16_t colorMax = 65535)
{
    auto cloud = std::make_shared<PointCloud>(points, coordinates);
    const auto add = [&](const char* name, ScalarType type, AttributeKind kind) {
        auto column = cloud->addColumn(std::make_shared<Column>(name, type, points));
        Attribute a;
        a.name = name;
        a.kind = kind;
        a.columns[0] = column;
        a.standard = true;
        if (type == ScalarType::I32) {
            const int axis = name[0] - 'X';
            a.scaled = true;
            a.scale = coordinates.scale[axis];
            a.offset = coordinates.offset[axis];
        }
        cloud->addAttribute(a);
        return column;
    };
    const auto x = add("X", ScalarType::I32, AttributeKind::Scalar)->values<std::int32_t>();
    const auto y = add("Y", ScalarType::I32, AttributeKind::Scalar)->values<std::int32_t>();
    const auto z = add("Z", ScalarType::I32, AttributeKind::Scalar)->values<std::int32_t>();
    const auto intensity = add("Intensity", ScalarType::U16, AttributeKind::Scalar)->values<std::uint16_t>();
    const auto classes = add("Classification", ScalarType::U8, AttributeKind::Class)->values<std::uint8_t>();
    const auto time = add("GpsTime", ScalarType::F64, AttributeKind::Scalar)->values<double>();
    const auto red = add("Red", ScalarType::U16, AttributeKind::Scalar)->values<std::uint16_t>();
    const auto green = add("Green", ScalarType::U16, AttributeKind::Scalar)->values<std::uint16_t>();
    const auto blue = add("Blue", ScalarType::U16, AttributeKind::Scalar)->values<std::uint16_t>();
    const auto lines = PointIndex(std::max(1.0, std::sqrt(double(points))));
    for (PointIndex i = 0; i < points; ++i) {
        const double u = double(i % lines) / double(lines) * 200.0;
        const double v = double(i / lines) / double(lines) * 200.0;
        const std::uint64_t h = hash(i);
        const double jitter = double(h & 1023) / 1023.0 * 0.2;
        double height = 8 * std::sin(u * 0.05) + 5 * std::cos(v * 0.09) + jitter;
        const bool wall = std::fmod(u, 50.0) < 4 && std::fmod(v, 50.0) < 30;
        if (wall) height += double((h >> 10) & 1023) / 1023.0 * 12.0;
        x[i] = std::int32_t((u + jitter) * 1000);
        y[i] = std::int32_t((v + jitter) * 1000);
        z[i] = std::int32_t(height * 1000);
        intensity[i] = std::uint16_t((h >> 20) % 3000);
        classes[i] = wall ? 6 : 2;
        time[i] = 300'000'000.0 + double(i) * 1e-5;
        red[i] = std::uint16_t(u / 200.0 * colorMax);
        green[i] = std::uint16_t(v / 200.0 * colorMax);
        blue[i] = std::uint16_t((h >> 33) % (std::uint64_t(colorMax) + 1));
    }
    addComposite(*cloud, "RGB", AttributeKind::Color, {"Red", "Green", "Blue"});
    return cloud;
}

/// Gives all points of one class another one; returns which.
inline std::shared_ptr<PointSet> reclassify(const PointCloud& cloud, std::uint8_t from, std::uint8_t to)
{
    const auto classes = cloud.findAttribute("Classification")->columns[0]->values<std::uint8_t>();
    auto points = std::make_shared<PointSet>(cloud.size());
    for (PointIndex i = 0; i < cloud.size(); ++i)
        if (classes[i] == from) {
            classes[i] = to;
            points->insert(i);
        }
    return points;
}

}  // namespace punctum::test
