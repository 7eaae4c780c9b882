// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>

namespace punctum::render
{

/// Of a surface that no light falls on.
inline constexpr float kLeastLight = 38.0f;

inline Rgba8 ownColorOf(std::uint32_t word, const LayerColors& layer, const ResolveSettings& settings) noexcept
{
    switch (layer.kind) {
        case WordKind::Scalar: {
            const float value = std::bit_cast<float>(word);
            if (std::isnan(value)) return settings.noValue;
            const float span = layer.high - layer.low;
            const float t = span > 0.0f ? (value - layer.low) / span : 0.5f;
            return settings.colorMap[std::size_t(std::clamp(t, 0.0f, 1.0f) * 255.0f + 0.5f)];
        }
        case WordKind::Class:
            return settings.palette[word & 255u];
        case WordKind::Category:
            return categoryColor(word);
        case WordKind::Normal: {
            if (word == 0) return settings.noValue;
            const auto part = [word](int shift) { return (float((word >> shift) & 1023u) - 512.0f) / 511.0f; };
            const glm::vec3 n(part(0), part(10), part(20));
            if (settings.normals == NormalLook::Direction) {
                const auto channel = [](float v) {
                    return std::uint8_t(std::clamp(v * 127.5f + 127.5f, 0.0f, 255.0f) + 0.5f);
                };
                return {channel(n.x), channel(n.y), channel(n.z), 255};
            }
            // The side that is turned to the eye is seen.
            const glm::vec3 e = settings.eye, l = settings.light;
            const float side = n.x * e.x + n.y * e.y + n.z * e.z > 0.0f ? 1.0f : -1.0f;
            const float length = std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
            const float lit = side * (n.x * l.x + n.y * l.y + n.z * l.z);
            const float facing = length > 0.0f ? std::max(lit, 0.0f) / length : 0.0f;
            const auto gray = std::uint8_t(std::min(kLeastLight + (255.0f - kLeastLight) * facing, 255.0f) + 0.5f);
            return {gray, gray, gray, 255};
        }
        case WordKind::Color:
            break;
    }
    const auto c = std::bit_cast<Rgba8>(word);
    return {settings.tone[c.r].r, settings.tone[c.g].g, settings.tone[c.b].b, c.a};
}

inline Rgba8 colorOf(std::uint32_t word, const LayerColors& layer, const ResolveSettings& settings) noexcept
{
    if (!layer.marked) return ownColorOf(word, layer, settings);
    const std::uint32_t bit = selectedBit(layer.kind);
    const bool color = layer.kind == WordKind::Color;
    const bool selected = ((word & bit) != 0) != color;
    const Rgba8 own = ownColorOf(color ? word | bit : word & ~bit, layer, settings);
    if (!selected) return own;
    const auto mixed = [](unsigned a, unsigned b) { return std::uint8_t((a + 3 * b) / 4); };
    return {mixed(own.r, kSelectedColor.r), mixed(own.g, kSelectedColor.g), mixed(own.b, kSelectedColor.b), 255};
}

}  // namespace punctum::render
