// SPDX-License-Identifier: MIT
#include "render/color/ColorMap.h"

#include "core/cloud/ClassNames.h"
#include "resources.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <vector>

namespace punctum::render
{

namespace
{

Rgba8 parseColor(std::string_view hex)
{
    std::uint32_t rgb = 0;
    std::from_chars(hex.data(), hex.data() + std::min<std::size_t>(hex.size(), 6), rgb, 16);
    return {std::uint8_t(rgb >> 16), std::uint8_t(rgb >> 8), std::uint8_t(rgb), 255};
}

/// Calls f with each line that is neither empty nor a comment.
template <typename F>
void forEachLine(std::string_view text, F&& f)
{
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        const std::string_view line = text.substr(0, end);
        if (!line.empty() && line.front() != '#') f(line);
        text.remove_prefix(std::min(end + 1, text.size()));
    }
}

ColorMap loadMap(const std::string& name)
{
    std::vector<Rgba8> anchors;
    forEachLine(resource("colormaps/" + name + ".txt"), [&](auto line) { anchors.push_back(parseColor(line)); });
    ColorMap map{name, {}};
    for (std::size_t i = 0; i < map.table.size(); ++i) {
        const double at = double(i) / 255.0 * double(anchors.size() - 1);
        const std::size_t k = std::min(std::size_t(at), anchors.size() - 2);
        const double t = at - double(k);
        const auto blend = [t](std::uint8_t a, std::uint8_t b) {
            return std::uint8_t(std::lround(double(a) + t * (double(b) - double(a))));
        };
        const Rgba8 a = anchors[k], b = anchors[k + 1];
        map.table[i] = {blend(a.r, b.r), blend(a.g, b.g), blend(a.b, b.b), 255};
    }
    return map;
}

std::array<ClassStyle, 256> loadClasses()
{
    std::array<ClassStyle, 256> classes;
    for (std::size_t code = 0; code < classes.size(); ++code)
        classes[code] = {"Class " + std::to_string(code), categoryColor(std::uint32_t(code))};
    forEachLine(resource("palettes/asprs.txt"), [&](std::string_view line) {
        unsigned code = 0;
        const auto end = std::from_chars(line.data(), line.data() + line.size(), code).ptr;
        line.remove_prefix(std::size_t(end - line.data()) + 1);
        if (code < classes.size()) classes[code] = {std::string(classNameOf(code)), parseColor(line)};
    });
    return classes;
}

}  // namespace

std::span<const ColorMap> colorMaps()
{
    static const std::array kMaps{loadMap("viridis"), loadMap("turbo"),   loadMap("cividis"), loadMap("grey"),
                                  loadMap("plasma"),  loadMap("inferno"), loadMap("spectral")};
    return kMaps;
}

const ColorMap* findColorMap(std::string_view name)
{
    const auto maps = colorMaps();
    const auto it = std::find_if(maps.begin(), maps.end(), [&](const ColorMap& m) { return m.name == name; });
    return it == maps.end() ? nullptr : &*it;
}

const ColorMap& suitableColorMap(std::string_view attribute)
{
    return *findColorMap(attribute == "Intensity" ? "grey" : "viridis");
}

const ColorMap& chosenColorMap(std::string_view name, std::string_view attribute)
{
    const ColorMap* const map = findColorMap(name);
    return map != nullptr ? *map : suitableColorMap(attribute);
}

const std::array<ClassStyle, 256>& asprsClasses()
{
    static const std::array<ClassStyle, 256> kClasses = loadClasses();
    return kClasses;
}

ColorTable banded(const ColorTable& table, int bands)
{
    if (bands < 2) return table;
    ColorTable steps;
    for (std::size_t k = 0; k < steps.size(); ++k) {
        const std::size_t band = k * std::size_t(bands) / steps.size();
        steps[k] = table[(2 * band + 1) * steps.size() / (2 * std::size_t(bands))];
    }
    return steps;
}

}  // namespace punctum::render
