// SPDX-License-Identifier: MIT
#include "render/resolve/Background.h"

#include <algorithm>
#include <cstdint>

namespace punctum::render
{

Rgba8 backgroundOf(int row, int height, const ResolveSettings& settings) noexcept
{
    row += settings.rows.first;
    const int last = std::max(1, (settings.rows.count > 0 ? settings.rows.count : height) - 1);
    const auto blend = [&](std::uint8_t top, std::uint8_t bottom) {
        return std::uint8_t((top * (last - row) + bottom * row + last / 2) / last);
    };
    const Rgba8 t = settings.backgroundTop, b = settings.backgroundBottom;
    return {blend(t.r, b.r), blend(t.g, b.g), blend(t.b, b.b), blend(t.a, b.a)};
}

}  // namespace punctum::render
