// SPDX-License-Identifier: MIT
#include "core/raster/VectorFiles.h"
#include "core/task/Progress.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>

namespace punctum
{

namespace
{

/// A group of DXF: a code and a value, a line each.
void addDxfGroup(std::string& text, int code, std::string_view value)
{
    text += std::to_string(code) + "\n" + std::string(value) + "\n";
}

void addDxfGroup(std::string& text, int code, double value, int decimals)
{
    std::array<char, 400> digits;
    const auto end =
        std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::fixed, decimals).ptr;
    addDxfGroup(text, code, {digits.data(), end});
}

void addDxfLayer(std::string& text, std::string_view name, int color)
{
    addDxfGroup(text, 0, "LAYER");
    addDxfGroup(text, 2, name);
    addDxfGroup(text, 70, "0");
    addDxfGroup(text, 62, std::to_string(color));
    addDxfGroup(text, 6, "CONTINUOUS");
}

void addDxfPolyline(std::string& text, std::string_view layer, const std::vector<glm::dvec2>& points, double height,
                    bool closed, int decimals)
{
    addDxfGroup(text, 0, "POLYLINE");
    addDxfGroup(text, 8, layer);
    addDxfGroup(text, 66, "1");
    addDxfGroup(text, 10, 0.0, 1);
    addDxfGroup(text, 20, 0.0, 1);
    addDxfGroup(text, 30, height, 6);
    addDxfGroup(text, 70, closed ? "1" : "0");
    for (const glm::dvec2& p : points) {
        addDxfGroup(text, 0, "VERTEX");
        addDxfGroup(text, 8, layer);
        addDxfGroup(text, 10, p.x, decimals);
        addDxfGroup(text, 20, p.y, decimals);
        addDxfGroup(text, 30, height, 6);
    }
    addDxfGroup(text, 0, "SEQEND");
    addDxfGroup(text, 8, layer);
}

}  // namespace

std::string dxfText(const VectorMap& map, const VectorOptions& options, Progress& progress)
{
    glm::dvec2 low(0.0), high(0.0);
    bool any = false;
    const auto include = [&](const std::vector<glm::dvec2>& points) {
        for (const glm::dvec2& p : points) {
            low = any ? glm::dvec2(std::min(low.x, p.x), std::min(low.y, p.y)) : p;
            high = any ? glm::dvec2(std::max(high.x, p.x), std::max(high.y, p.y)) : p;
            any = true;
        }
    };
    for (const ContourLine& line : map.lines) include(line.points);
    for (const MapArea& area : map.areas)
        for (const auto& ring : area.rings) include(ring);
    for (const MapTable::Row& row : map.table.rows) include({glm::dvec2(row.place)});
    // degrees need digits that meters do not
    const bool small = std::max(std::max(high.x, high.y), -std::min(low.x, low.y)) <= 360.0;
    const int decimals = options.decimals + (small ? 5 : 0);

    std::string text;
    addDxfGroup(text, 0, "SECTION");
    addDxfGroup(text, 2, "HEADER");
    addDxfGroup(text, 9, "$ACADVER");
    addDxfGroup(text, 1, "AC1009");
    addDxfGroup(text, 9, "$EXTMIN");
    addDxfGroup(text, 10, low.x, decimals);
    addDxfGroup(text, 20, low.y, decimals);
    addDxfGroup(text, 9, "$EXTMAX");
    addDxfGroup(text, 10, high.x, decimals);
    addDxfGroup(text, 20, high.y, decimals);
    addDxfGroup(text, 0, "ENDSEC");
    addDxfGroup(text, 0, "SECTION");
    addDxfGroup(text, 2, "TABLES");
    addDxfGroup(text, 0, "TABLE");
    addDxfGroup(text, 2, "LTYPE");
    addDxfGroup(text, 70, "1");
    addDxfGroup(text, 0, "LTYPE");
    addDxfGroup(text, 2, "CONTINUOUS");
    addDxfGroup(text, 70, "0");
    addDxfGroup(text, 3, "Solid line");
    addDxfGroup(text, 72, "65");
    addDxfGroup(text, 73, "0");
    addDxfGroup(text, 40, 0.0, 1);
    addDxfGroup(text, 0, "ENDTAB");
    addDxfGroup(text, 0, "TABLE");
    addDxfGroup(text, 2, "LAYER");
    addDxfGroup(text, 70, map.table.layer.empty() ? "3" : "4");
    addDxfLayer(text, "CONTOUR", 34);
    addDxfLayer(text, "CONTOUR_INDEX", 32);
    addDxfLayer(text, "OUTLINE", 1);
    if (!map.table.layer.empty()) addDxfLayer(text, map.table.layer, 3);
    addDxfGroup(text, 0, "ENDTAB");
    addDxfGroup(text, 0, "ENDSEC");
    addDxfGroup(text, 0, "SECTION");
    addDxfGroup(text, 2, "ENTITIES");
    progress.begin("Writing DXF", map.lines.size() + map.areas.size() + map.table.rows.size());
    for (const ContourLine& line : map.lines) {
        progress.check();
        progress.add(1);
        if (line.points.size() >= 2)
            addDxfPolyline(text, line.index ? "CONTOUR_INDEX" : "CONTOUR", line.points, line.height, line.closed,
                           decimals);
    }
    for (const MapArea& area : map.areas) {
        progress.check();
        progress.add(1);
        for (const auto& ring : area.rings) addDxfPolyline(text, "OUTLINE", ring, 0.0, true, decimals);
    }
    for (const MapTable::Row& row : map.table.rows) {
        progress.check();
        progress.add(1);
        addDxfGroup(text, 0, "POINT");
        addDxfGroup(text, 8, map.table.layer);
        addDxfGroup(text, 10, row.place.x, decimals);
        addDxfGroup(text, 20, row.place.y, decimals);
        addDxfGroup(text, 30, row.place.z, 6);
    }
    addDxfGroup(text, 0, "ENDSEC");
    addDxfGroup(text, 0, "EOF");
    return text;
}

}  // namespace punctum
