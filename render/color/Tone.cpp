// SPDX-License-Identifier: MIT
#include "render/color/Tone.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace punctum::render
{

ColorTable toneTable(const ColorTone& tone) noexcept
{
    // The slope of the line through the middle: 0 for no contrast at all, 1 as it is, steep towards 1.
    const double slope = std::tan((std::clamp(tone.contrast, -1.0, 0.99) + 1.0) * std::numbers::pi / 4);
    const double exponent = 1.0 / std::clamp(tone.gamma, 0.1, 10.0);
    ColorTable table;
    for (std::size_t k = 0; k < table.size(); ++k) {
        const double bent = std::pow(double(k) / 255.0, exponent);
        const double value = (bent - 0.5) * slope + 0.5 + std::clamp(tone.brightness, -1.0, 1.0);
        const auto level = std::uint8_t(std::lround(std::clamp(value, 0.0, 1.0) * 255.0));
        table[k] = {level, level, level, 255};
    }
    return table;
}

}  // namespace punctum::render
