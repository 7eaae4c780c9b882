// SPDX-License-Identifier: MIT
#pragma once

#include "render/color/Rgba8.h"

#include <array>
#include <span>
#include <string>
#include <string_view>

namespace punctum::render
{

/// 256 colors from the lowest to the highest value.
using ColorTable = std::array<Rgba8, 256>;

struct ColorMap {
    std::string name;  ///< "viridis"
    ColorTable table;
};

/// All color maps, from resources/colormaps: viridis, turbo, cividis, grey first.
std::span<const ColorMap> colorMaps();
/// Null when there is none of that name.
const ColorMap* findColorMap(std::string_view name);

/// The map that suits an attribute when the user chose none: grey for Intensity, as everybody expects it, else
/// viridis.
const ColorMap& suitableColorMap(std::string_view attribute);
/// The map of that name; the suitable one when the name is empty or unknown.
const ColorMap& chosenColorMap(std::string_view name, std::string_view attribute);

/// The map in so many equal steps, each with the color of its middle; less than 2: the map itself.
ColorTable banded(const ColorTable& table, int bands);

/// A class of the ASPRS standard (LAS 1.4 R15, table 17).
struct ClassStyle {
    std::string name;  ///< "Ground"; "Class 40" for those without a name
    Rgba8 color;
};

/// Name and default color (resources/palettes/asprs.txt) of the 256 class codes.
const std::array<ClassStyle, 256>& asprsClasses();

/// A color for an id: neighbors in value get unlike colors, the same id always the same. Shaders repeat this
/// integer arithmetic: hue steps by the golden ratio, three rings of lightness. 0, which mostly means none (of no
/// tree, in no cluster, flag not set), is gray.
constexpr Rgba8 categoryColor(std::uint32_t id) noexcept
{
    if (id == 0) return {112, 116, 122, 255};
    // Hue in 1/1536 turns: six ramps of 256, from a multiplication hash (2^32 / golden ratio).
    const std::uint32_t hue = ((id * 2654435769u) >> 16) * 1536u >> 16;
    const std::uint32_t ramp = hue & 255u;
    constexpr std::uint32_t kTop[3] = {235, 205, 250}, kBottom[3] = {70, 40, 130};
    const std::uint32_t top = kTop[id % 3u], bottom = kBottom[id % 3u];
    const auto up = std::uint8_t(bottom + (top - bottom) * ramp / 255u);
    const auto down = std::uint8_t(top - (top - bottom) * ramp / 255u);
    const auto hi = std::uint8_t(top), lo = std::uint8_t(bottom);
    switch (hue >> 8) {
        case 0:
            return {hi, up, lo, 255};
        case 1:
            return {down, hi, lo, 255};
        case 2:
            return {lo, hi, up, 255};
        case 3:
            return {lo, down, hi, 255};
        case 4:
            return {up, lo, hi, 255};
        default:
            return {hi, lo, down, 255};
    }
}

}  // namespace punctum::render
