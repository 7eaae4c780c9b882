// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>

namespace punctum::render {

inline Rgba8 colorOf(std::uint32_t word, const LayerColors& layer, const ResolveSettings& settings) noexcept
{
    switch (layer.kind) {
    case WordKind::Scalar: {
        const float value = std::bit_cast<float>(word);
        if (std::isnan(value)) return settings.noValue;
        const float span = layer.high - layer.low;
        const float t = span > 0.0f ? (value - layer.low) / span : 0.5f;
        return settings.colorMap[std::size_t(std::clamp(t, 0.0f, 1.0f) * 255.0f + 0.5f)];
    }
    case WordKind::Class: return settings.palette[word & 255u];
    case WordKind::Category: return categoryColor(word);
    case WordKind::Color: break;
    }
    return std::bit_cast<Rgba8>(word);
}

}  // namespace punctum::render
