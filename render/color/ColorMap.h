// SPDX-License-Identifier: MIT
#pragma once

#include "render/resolve/Image.h"

#include <array>
#include <span>
#include <string>
#include <string_view>

namespace punctum::render {

/// 256 colours from the lowest to the highest value.
using ColorTable = std::array<Rgba8, 256>;

struct ColorMap {
    std::string name;   ///< "viridis"
    ColorTable table;
};

/// All colour maps, from resources/colormaps: grey, viridis, turbo, cividis first.
std::span<const ColorMap> colorMaps();
/// Null when there is none of that name.
const ColorMap* findColorMap(std::string_view name);

/// A class of the ASPRS standard (LAS 1.4 R15, table 17).
struct ClassStyle {
    std::string name;   ///< "Ground"; "Class 40" for those without a name
    Rgba8 color;
};

/// Name and default colour of the 256 class codes, from resources/palettes/asprs.txt.
const std::array<ClassStyle, 256>& asprsClasses();

/// A colour for an id: neighbours in value get unlike colours, the same id always the same.
Rgba8 categoryColor(std::uint32_t id) noexcept;

}  // namespace punctum::render
