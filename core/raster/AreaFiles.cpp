// SPDX-License-Identifier: MIT
#include "core/raster/AreaFiles.h"

#include "core/Error.h"
#include "core/las/CrsChange.h"

#include <glm/vec3.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <optional>

namespace punctum
{

namespace
{

using Json = nlohmann::json;

constexpr std::uintmax_t kMostAreaBytes = std::uintmax_t(1) << 28;

const Json* part(const Json& object, const char* name)
{
    if (!object.is_object()) return nullptr;
    const auto found = object.find(name);
    return found == object.end() ? nullptr : &*found;
}

std::string textOf(const Json* value)
{
    return value != nullptr && value->is_string() ? value->get<std::string>() : std::string();
}

/// Of numbers and texts.
std::string nameOf(const Json* value)
{
    if (value == nullptr || !(value->is_string() || value->is_number())) return {};
    return value->is_string() ? value->get<std::string>() : value->dump();
}

/// Null where it is no list of places.
std::optional<Ring> ringOf(const Json& places)
{
    if (!places.is_array()) return std::nullopt;
    Ring ring;
    for (const Json& place : places) {
        if (!place.is_array() || place.size() < 2 || !place[0].is_number() || !place[1].is_number())
            return std::nullopt;
        const glm::dvec2 p(place[0].get<double>(), place[1].get<double>());
        if (!std::isfinite(p.x) || !std::isfinite(p.y)) return std::nullopt;
        ring.push_back(p);
    }
    if (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();  // GeoJSON has the first place again
    return ring;
}

class AreaReader
{
public:
    explicit AreaReader(const std::filesystem::path& path) : m_path(path) {}

    std::vector<NamedArea> areas;

    void addObject(const Json& object)
    {
        const std::string type = textOf(part(object, "type"));
        if (type == "FeatureCollection") {
            const Json* const features = part(object, "features");
            if (features == nullptr || !features->is_array())
                throw Error(m_path, "This is no GeoJSON: its collection has no features.");
            for (const Json& feature : *features) addFeature(feature);
        } else if (type == "Feature") {
            addFeature(object);
        } else {
            addGeometry(object, {});
        }
    }

private:
    void addFeature(const Json& feature)
    {
        const Json* const properties = part(feature, "properties");
        std::string name = properties != nullptr ? nameOf(part(*properties, "name")) : std::string();
        if (name.empty()) name = nameOf(part(feature, "id"));
        if (const Json* const geometry = part(feature, "geometry")) addGeometry(*geometry, name);
    }

    /// Lines and places are left out.
    void addGeometry(const Json& geometry, const std::string& name)
    {
        const std::string type = textOf(part(geometry, "type"));
        const Json* const coordinates = part(geometry, "coordinates");
        if ((type != "Polygon" && type != "MultiPolygon") || coordinates == nullptr) return;
        NamedArea area{name, {}};
        if (type == "Polygon") {
            addRings(*coordinates, area);
        } else {
            if (!coordinates->is_array()) fail();
            for (const Json& polygon : *coordinates) addRings(polygon, area);
        }
        if (area.rings.empty()) return;
        if (name.empty()) area.name = std::to_string(areas.size() + 1);
        areas.push_back(std::move(area));
    }

    void addRings(const Json& rings, NamedArea& area) const
    {
        if (!rings.is_array()) fail();
        for (const Json& places : rings) {
            std::optional<Ring> ring = ringOf(places);
            if (!ring) fail();
            if (ring->size() >= 3) area.rings.push_back(std::move(*ring));
        }
    }

    [[noreturn]] void fail() const
    {
        throw Error(m_path, "A polygon of this file has corners that are no places.");
    }

    const std::filesystem::path& m_path;
};

/// "EPSG:25832" of "urn:ogc:def:crs:EPSG::25832" and the like; empty where nothing is stated.
std::string statedCrs(const Json& whole)
{
    const Json* const crs = part(whole, "crs");
    const Json* const properties = crs != nullptr ? part(*crs, "properties") : nullptr;
    std::string name = properties != nullptr ? textOf(part(*properties, "name")) : std::string();
    if (name.empty()) return {};
    if (name.ends_with("CRS84")) return "EPSG:4326";
    const std::size_t begin = name.find_last_not_of("0123456789") + 1;
    if (name.find("EPSG") == std::string::npos || begin == name.size()) return name;
    return "EPSG:" + name.substr(begin);
}

bool couldBeDegrees(const std::vector<NamedArea>& areas)
{
    return std::all_of(areas.begin(), areas.end(), [](const NamedArea& area) {
        return std::all_of(area.rings.begin(), area.rings.end(), [](const Ring& ring) {
            return std::all_of(ring.begin(), ring.end(),
                               [](const glm::dvec2& p) { return std::abs(p.x) <= 180 && std::abs(p.y) <= 90; });
        });
    });
}

void convertAreas(std::vector<NamedArea>& areas, const std::string& from, const MapCrs& crs,
                  const std::filesystem::path& path)
{
    const auto change = las::CrsChange::between(from, crs.text);
    if (!change)
        throw Error(path, "The polygons are in another coordinate system (" + las::crsName(from) +
                              "), from which no way leads to that of the points.");
    for (NamedArea& area : areas)
        for (Ring& ring : area.rings) {
            std::vector<glm::dvec3> places;
            places.reserve(ring.size());
            for (const glm::dvec2& p : ring) places.emplace_back(p, 0.0);
            (*change)(places);
            for (std::size_t k = 0; k < ring.size(); ++k) {
                if (!std::isfinite(places[k].x) || !std::isfinite(places[k].y))
                    throw Error(path, "Some corners have no place in the coordinate system of the points.");
                ring[k] = glm::dvec2(places[k]);
            }
        }
}

}  // namespace

std::vector<NamedArea> readAreas(const std::filesystem::path& path, const MapCrs& crs)
{
    std::error_code error;
    const std::uintmax_t bytes = std::filesystem::file_size(path, error);
    if (error) throw Error(path, "The file cannot be read: " + error.message() + ".");
    if (bytes > kMostAreaBytes) throw Error(path, "This file is too large for polygons.");
    std::ifstream file(path, std::ios::binary);
    const Json whole = Json::parse(file, nullptr, false);
    if (file.bad() || !file.is_open()) throw Error(path, "The file cannot be read.");
    if (!whole.is_object()) throw Error(path, "This is no GeoJSON.");
    AreaReader reader(path);
    reader.addObject(whole);
    if (reader.areas.empty()) throw Error(path, "This file has no polygons.");
    std::string from = statedCrs(whole);
    if (from.empty() && !crs.text.empty() && !crs.geographic && couldBeDegrees(reader.areas)) from = "EPSG:4326";
    const bool same = from.empty() || (crs.horizontal != 0 && from == "EPSG:" + std::to_string(crs.horizontal));
    if (!same && !crs.text.empty()) convertAreas(reader.areas, from, crs, path);
    return std::move(reader.areas);
}

}  // namespace punctum
