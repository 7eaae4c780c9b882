// SPDX-License-Identifier: MIT
#include "core/measure/Measurement.h"

#include "core/cloud/ValueText.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace punctum
{

namespace
{

constexpr int kMoreDecimals = 3;  ///< of lengths than of steps
constexpr int kAngleDecimals = 6;
constexpr std::array<std::string_view, 7> kNames{"point", "distance", "height", "angle", "area", "box", "volume"};

double degrees(double radians)
{
    return radians * 180.0 / std::numbers::pi;
}

double horizontal(const glm::dvec3& v)
{
    return std::hypot(v.x, v.y);
}

/// Twice the area of the polygon, as a vector across it.
glm::dvec3 doubleArea(const std::vector<glm::dvec3>& corners)
{
    glm::dvec3 sum(0.0);
    for (std::size_t k = 1; k + 1 < corners.size(); ++k)
        sum += glm::cross(corners[k] - corners[0], corners[k + 1] - corners[0]);
    return sum;
}

std::string quoted(const std::string& text)
{
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string result = "\"";
    for (const char c : text) result += c == '"' ? std::string("\"\"") : std::string(1, c);
    return result + '"';
}

}  // namespace

std::string_view nameOf(MeasureKind kind) noexcept
{
    return kNames[std::size_t(kind)];
}

std::optional<MeasureKind> measureKindOf(std::string_view name) noexcept
{
    const auto found = std::find(kNames.begin(), kNames.end(), name);
    if (found == kNames.end()) return {};
    return MeasureKind(found - kNames.begin());
}

std::size_t pointsOf(MeasureKind kind) noexcept
{
    switch (kind) {
        case MeasureKind::Point:
            return 1;
        case MeasureKind::Angle:
            return 3;
        case MeasureKind::Area:
        case MeasureKind::Volume:
            return 0;
        case MeasureKind::Distance:
        case MeasureKind::Height:
        case MeasureKind::Box:
            break;
    }
    return 2;
}

std::vector<Quantity> quantitiesOf(MeasureKind kind, const std::vector<MeasuredPoint>& points,
                                   const glm::dvec3& stretch)
{
    using Unit = Quantity::Unit;
    const std::size_t needed = pointsOf(kind);
    if (points.size() < (needed == 0 ? 3 : needed)) return {};
    std::vector<glm::dvec3> at;  // from the first point on: keeps the digits
    at.reserve(points.size());
    for (const MeasuredPoint& p : points) at.push_back((p.world - points.front().world) * stretch);
    switch (kind) {
        case MeasureKind::Point: {
            const glm::dvec3& w = points.front().world;
            return {{"X", w.x, Unit::None}, {"Y", w.y, Unit::None}, {"Z", w.z, Unit::None}};
        }
        case MeasureKind::Distance:
            return {{"Distance", glm::length(at[1])},
                    {"Horizontal", horizontal(at[1])},
                    {"dx", at[1].x},
                    {"dy", at[1].y},
                    {"dz", at[1].z}};
        case MeasureKind::Height:
            return {{"Height", at[1].z},
                    {"Horizontal", horizontal(at[1])},
                    {"Slope", degrees(std::atan2(at[1].z, horizontal(at[1]))), Unit::Degrees}};
        case MeasureKind::Angle: {
            const glm::dvec3 a = at[0] - at[1], b = at[2] - at[1];
            const double flat =
                std::abs(std::remainder(std::atan2(a.y, a.x) - std::atan2(b.y, b.x), 2 * std::numbers::pi));
            return {{"Angle", degrees(std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b))), Unit::Degrees},
                    {"Horizontal angle", degrees(flat), Unit::Degrees},
                    {"First side", glm::length(a)},
                    {"Second side", glm::length(b)}};
        }
        case MeasureKind::Area: {
            const glm::dvec3 area = doubleArea(at) * 0.5;
            double around = 0.0;
            for (std::size_t k = 0; k < at.size(); ++k) around += glm::distance(at[k], at[(k + 1) % at.size()]);
            return {{"Area", glm::length(area), Unit::Area},
                    {"Horizontal area", std::abs(area.z), Unit::Area},
                    {"Perimeter", around}};
        }
        case MeasureKind::Box: {
            const glm::dvec3 size = glm::abs(at[1]);
            return {{"Volume", size.x * size.y * size.z, Unit::Volume},
                    {"dx", size.x},
                    {"dy", size.y},
                    {"dz", size.z},
                    {"Base", size.x * size.y, Unit::Area}};
        }
        case MeasureKind::Volume: {
            double around = 0.0;
            for (std::size_t k = 0; k < at.size(); ++k) around += horizontal(at[(k + 1) % at.size()] - at[k]);
            return {{"Area", std::abs(doubleArea(at).z) * 0.5, Unit::Area}, {"Perimeter", around}};
        }
    }
    return {};
}

std::string unitText(Quantity::Unit unit, const std::string& length)
{
    switch (unit) {
        case Quantity::Unit::Degrees:
            return "°";
        case Quantity::Unit::Length:
            return length;
        case Quantity::Unit::Area:
            return length.empty() ? "" : length + "²";
        case Quantity::Unit::Volume:
            return length.empty() ? "" : length + "³";
        case Quantity::Unit::None:
            break;
    }
    return {};
}

int lengthDecimals(const CoordinateScale& coordinates, const glm::dvec3& stretch)
{
    double step = 1.0;  // the finest
    for (int axis = 0; axis < 3; ++axis) {
        const double length = std::abs(coordinates.scale[axis] * stretch[axis]);
        if (length > 0 && std::isfinite(length)) step = std::min(step, length);
    }
    return int(std::ceil(-std::log10(step) - 1e-9)) + kMoreDecimals;
}

std::string toCsv(const std::vector<Measurement>& measurements)
{
    std::string csv = "number,kind,file,name,value,unit\r\n";
    for (std::size_t k = 0; k < measurements.size(); ++k) {
        const Measurement& m = measurements[k];
        const std::string start =
            std::to_string(k + 1) + ',' + std::string(nameOf(m.kind)) + ',' + quoted(m.file) + ',';
        const auto line = [&](const std::string& name, const std::string& value, const std::string& unit) {
            csv += start + quoted(name) + ',' + value + ',' + unit + "\r\n";
        };
        if (m.kind != MeasureKind::Point)
            for (const Quantity& q : m.quantities)
                line(q.name, roundedText(q.value, q.unit == Quantity::Unit::Degrees ? kAngleDecimals : m.decimals),
                     unitText(q.unit, m.length));
        for (const auto& [name, value] : m.facts) line(name, quoted(value), "");
        for (std::size_t p = 0; p < m.points.size(); ++p) {
            const std::string name = "Point " + std::to_string(p + 1) + ' ';
            line(name + "index", std::to_string(m.points[p].index), "");
            for (int axis = 0; axis < 3; ++axis)
                line(name + "XYZ"[axis], coordinateText(m.coordinates, axis, m.points[p].world[axis]), "");
        }
    }
    return csv;
}

}  // namespace punctum
