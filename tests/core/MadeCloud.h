// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"

#include <memory>
#include <random>
#include <string>

#if defined(__SANITIZE_THREAD__)
#include <tbb/global_control.h>
#endif

namespace punctum
{

#if defined(__SANITIZE_THREAD__)
/// TBB as the system ships it is not built with thread sanitizer, which then takes everything that one of its
/// threads wrote and another reads for a race: thousands of reports, all suppressed, each slow. Loops of TBB run in
/// the thread that calls them here; the threads that the tests start themselves are still watched.
inline const tbb::global_control kOneThread(tbb::global_control::max_allowed_parallelism, 1);
#endif

/// Whether this is optimized, and no sanitizer's: then there are as many points as a real tile has, and promises on
/// time are checked, with much room, as other work may run beside.
#if defined(__OPTIMIZE__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
inline constexpr bool kFastBuild = true;
#else
inline constexpr bool kFastBuild = false;
#endif

/// The C++ type of a column -> its ScalarType.
template <typename T>
constexpr ScalarType scalarTypeOf()
{
    if constexpr (std::is_same_v<T, std::uint8_t>) return ScalarType::U8;
    if constexpr (std::is_same_v<T, std::int8_t>) return ScalarType::I8;
    if constexpr (std::is_same_v<T, std::uint16_t>) return ScalarType::U16;
    if constexpr (std::is_same_v<T, std::int16_t>) return ScalarType::I16;
    if constexpr (std::is_same_v<T, std::uint32_t>) return ScalarType::U32;
    if constexpr (std::is_same_v<T, std::int32_t>) return ScalarType::I32;
    if constexpr (std::is_same_v<T, std::uint64_t>) return ScalarType::U64;
    if constexpr (std::is_same_v<T, std::int64_t>) return ScalarType::I64;
    if constexpr (std::is_same_v<T, float>) return ScalarType::F32;
    if constexpr (std::is_same_v<T, double>) return ScalarType::F64;
}

/// Adds a column and the attribute that shows all of it; the values are to be filled in.
template <typename T>
std::span<T> addScalar(PointCloud& cloud, const std::string& name, AttributeKind kind = AttributeKind::Scalar)
{
    Attribute a;
    a.name = name;
    a.kind = kind;
    a.columns[0] = cloud.addColumn(std::make_shared<Column>(name, scalarTypeOf<T>(), cloud.size()));
    cloud.addAttribute(a);
    return a.columns[0]->values<T>();
}

/// Adds an attribute that shows bits of the column that `byte` shows.
inline void addBits(PointCloud& cloud, const std::string& name, const std::string& column, std::uint8_t shift,
                    std::uint8_t width, AttributeKind kind = AttributeKind::Category)
{
    for (const auto& c : cloud.columns()) {
        if (c->name() != column) continue;
        Attribute a;
        a.name = name;
        a.kind = kind;
        a.columns[0] = c;
        a.bitShift = shift;
        a.bitWidth = width;
        cloud.addAttribute(a);
        return;
    }
}

/// A cloud with coordinates (all 0) and classes: a whole byte, or as point formats 0 to 5 have them.
inline std::shared_ptr<PointCloud> makeFrame(PointIndex points, CoordinateScale coordinates = {},
                                             bool narrowClasses = false)
{
    auto cloud = std::make_shared<PointCloud>(points, coordinates);
    const char* const axes[3] = {"X", "Y", "Z"};
    for (int axis = 0; axis < 3; ++axis) {
        Attribute a;
        a.name = axes[axis];
        a.standard = true;
        a.scaled = true;
        a.scale = coordinates.scale[axis];
        a.offset = coordinates.offset[axis];
        a.columns[0] = cloud->addColumn(std::make_shared<Column>(a.name, ScalarType::I32, points));
        cloud->addAttribute(a);
    }
    if (narrowClasses) {
        cloud->addColumn(std::make_shared<Column>("ClassFlags", ScalarType::U8, points));
        addBits(*cloud, "Classification", "ClassFlags", 0, 5, AttributeKind::Class);
        addBits(*cloud, "Synthetic", "ClassFlags", 5, 1);
        addBits(*cloud, "Withheld", "ClassFlags", 7, 1);
    } else {
        addScalar<std::uint8_t>(*cloud, "Classification", AttributeKind::Class);
    }
    return cloud;
}

/// The unit of length of all its axes is the meter.
inline void setMeters(PointCloud& cloud)
{
    CoordinateUnits units;
    units.kind = CoordinateUnits::Kind::Lengths;
    units.horizontal = units.vertical = "m";
    units.horizontalSize = units.verticalSize = 1;
    cloud.setUnits(units);
}

/// Raw coordinates of one axis, to be filled.
inline std::span<std::int32_t> rawAxis(PointCloud& cloud, std::size_t axis)
{
    return cloud.columns()[axis]->values<std::int32_t>();
}

/// Every byte of every column, and what is deleted, to compare states of a cloud.
inline std::vector<std::vector<std::byte>> snapshot(const PointCloud& cloud)
{
    std::vector<std::vector<std::byte>> bytes;
    for (const auto& column : cloud.columns())
        bytes.emplace_back(column->data(), column->data() + column->size() * column->elementBytes());
    if (const auto& deleted = cloud.deleted()) {
        const auto words = std::as_bytes(deleted->words());
        bytes.emplace_back(words.begin(), words.end());
    }
    return bytes;
}

inline std::vector<std::string> attributeNames(const PointCloud& cloud)
{
    std::vector<std::string> names;
    for (const Attribute& a : cloud.attributes()) names.push_back(a.name);
    return names;
}

}  // namespace punctum
