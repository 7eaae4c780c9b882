// SPDX-License-Identifier: MIT
#pragma once

#include "render/color/ColorMap.h"

namespace punctum::render
{

/// How bright the colors of a file are shown: of all three channels alike. A value; no thread rules.
struct ColorTone {
    double brightness = 0.0;  ///< -1 to 1: is added, of the whole range
    double contrast = 0.0;    ///< -1 to 1: 0 as it is, -1 a plain gray, 1 black and white
    double gamma = 1.0;       ///< 0.1 to 10: above 1 what is dark becomes brighter, black and white stay
    friend bool operator==(const ColorTone&, const ColorTone&) = default;
};

/// What each of the 256 values of a channel becomes: gamma first, then contrast about the middle, then brightness.
/// In all three channels of a color the same.
ColorTable toneTable(const ColorTone& tone) noexcept;

}  // namespace punctum::render
