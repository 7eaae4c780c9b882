// SPDX-License-Identifier: MIT
#include "core/Error.h"
#include "core/las/CrsChange.h"
#include "core/raster/VectorFiles.h"
#include "core/task/Progress.h"

#include <glm/vec3.hpp>

#include <array>
#include <charconv>
#include <cmath>
#include <memory>

namespace punctum
{

namespace
{

/// OGC:CRS84: longitude, latitude.
constexpr const char* kWgs84 = "EPSG:4326";

void addJsonNumber(std::string& text, double value, int decimals)
{
    std::array<char, 400> digits;
    const auto end =
        std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::fixed, decimals).ptr;
    std::string number(digits.data(), end);
    if (number.find('.') != std::string::npos) {
        number.erase(number.find_last_not_of('0') + 1);
        if (number.back() == '.') number.pop_back();
    }
    text += number == "-0" ? "0" : number;
}

/// Puts places into the text.
class PlaceWriter
{
public:
    PlaceWriter(const MapCrs& crs, const VectorOptions& options)
        : m_decimals(options.decimals + (options.wgs84 || crs.geographic ? 4 : 0))
    {
        if (!options.wgs84) return;
        m_change = las::CrsChange::between(crs.text, kWgs84);
        if (!m_change)
            throw Error("The points have no coordinate system from which longitude and latitude can be found.");
    }

    /// "[[x,y],...]"; `closed`: the first one again.
    void line(std::string& text, const std::vector<glm::dvec2>& points, bool closed)
    {
        convert(points);
        if (closed && !m_places.empty()) m_places.push_back(m_places[0]);
        text += '[';
        for (std::size_t k = 0; k < m_places.size(); ++k) {
            text += k == 0 ? "" : ",";
            add(text, m_places[k]);
        }
        text += ']';
    }
    /// "[x,y]"
    void place(std::string& text, const glm::dvec2& point)
    {
        convert({point});
        add(text, m_places[0]);
    }

private:
    void convert(const std::vector<glm::dvec2>& points)
    {
        m_places.clear();
        for (const glm::dvec2& p : points) m_places.emplace_back(p, 0.0);
        if (m_change) (*m_change)(m_places);
    }
    void add(std::string& text, const glm::dvec3& place) const
    {
        if (std::isnan(place.x))
            throw Error("Some places have no longitude and latitude in their coordinate system.");
        text += '[';
        addJsonNumber(text, place.x, m_decimals);
        text += ',';
        addJsonNumber(text, place.y, m_decimals);
        text += ']';
    }

    std::unique_ptr<las::CrsChange> m_change;
    int m_decimals;
    std::vector<glm::dvec3> m_places;
};

}  // namespace

std::string geoJsonText(const VectorMap& map, const MapCrs& crs, const VectorOptions& options, Progress& progress)
{
    PlaceWriter places(crs, options);
    std::string text = "{\"type\":\"FeatureCollection\",\n";
    if (!options.wgs84 && crs.horizontal != 0)
        text += "\"crs\":{\"type\":\"name\",\"properties\":{\"name\":\"urn:ogc:def:crs:EPSG::" +
                std::to_string(crs.horizontal) + "\"}},\n";
    text += "\"features\":[\n";
    progress.begin("Writing GeoJSON", map.lines.size() + map.areas.size() + map.table.rows.size());
    bool first = true;
    const auto begin = [&](const char* type) {
        progress.check();
        progress.add(1);
        text += first ? "" : ",\n";
        first = false;
        text += std::string("{\"type\":\"Feature\",\"geometry\":{\"type\":\"") + type + "\",\"coordinates\":";
    };
    for (const ContourLine& line : map.lines) {
        if (line.points.size() < 2) continue;
        begin("LineString");
        places.line(text, line.points, line.closed);
        text += "},\"properties\":{\"elevation\":";
        addJsonNumber(text, line.height, 6);
        text += line.index ? ",\"index\":true}}" : ",\"index\":false}}";
    }
    for (const MapArea& area : map.areas) {
        begin("Polygon");
        text += '[';
        for (std::size_t k = 0; k < area.rings.size(); ++k) {
            text += k == 0 ? "" : ",";
            places.line(text, area.rings[k], true);
        }
        text += "]},\"properties\":{\"area\":";
        addJsonNumber(text, area.area, crs.geographic ? 12 : 3);
        text += "}}";
    }
    for (const MapTable::Row& row : map.table.rows) {
        begin("Point");
        places.place(text, glm::dvec2(row.place));
        text += "},\"properties\":{";
        for (std::size_t k = 0; k < row.values.size(); ++k) {
            text += (k == 0 ? "\"" : ",\"") + map.table.columns[k].name + "\":";
            if (std::isnan(row.values[k]))
                text += "null";
            else
                addJsonNumber(text, row.values[k], map.table.columns[k].decimals);
        }
        text += "}}";
    }
    return text + "\n]}\n";
}

}  // namespace punctum
