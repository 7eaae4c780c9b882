// SPDX-License-Identifier: MIT
#include "render/store/AttributeEncoder.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

namespace punctum::render
{

namespace
{

constexpr std::size_t kBlock = 1024;

WordKind wordKindOf(const Attribute& a) noexcept
{
    switch (a.kind) {
        case AttributeKind::Class:
            return WordKind::Class;
        case AttributeKind::Category:
            return a.integral() ? WordKind::Category : WordKind::Scalar;
        case AttributeKind::Color:
        case AttributeKind::Vector:
            return WordKind::Color;
        case AttributeKind::Scalar:
        case AttributeKind::Opaque:
            break;
    }
    return WordKind::Scalar;
}

/// A component of a direction, -1..1, as a colour channel.
std::uint32_t channelOf(float v) noexcept
{
    return std::isnan(v) ? 128u : std::uint32_t(std::clamp(v * 127.5f + 127.5f, 0.0f, 255.0f) + 0.5f);
}

}  // namespace

AttributeEncoder::AttributeEncoder(Attribute attribute, double bias, int colorShift)
    : m_attribute(std::move(attribute)), m_kind(wordKindOf(m_attribute)), m_bias(bias), m_colorShift(colorShift)
{
}

bool AttributeEncoder::encode(std::span<const std::uint32_t> indices, std::uint32_t* out) const
{
    if (m_kind == WordKind::Scalar) {
        static_assert(sizeof(float) == sizeof(std::uint32_t));
        float values[kBlock];
        for (std::size_t at = 0; at < indices.size(); at += kBlock) {
            const auto part = indices.subspan(at, std::min(kBlock, indices.size() - at));
            m_attribute.gather(part, m_bias, values);
            for (std::size_t k = 0; k < part.size(); ++k) out[at + k] = std::bit_cast<std::uint32_t>(values[k]);
        }
        return true;
    }
    if (m_kind != WordKind::Color) {
        m_attribute.gatherBits(indices, out);
        return true;
    }
    std::uint32_t highest = 0;
    std::uint32_t channel[kBlock];
    float component[kBlock];
    for (std::size_t at = 0; at < indices.size(); at += kBlock) {
        const auto part = indices.subspan(at, std::min(kBlock, indices.size() - at));
        std::fill_n(out + at, part.size(), 0xFF000000u);
        for (std::uint32_t c = 0; c < 3; ++c) {
            if (m_attribute.kind == AttributeKind::Vector) {
                m_attribute.gather(part, 0.0, component, c);
                for (std::size_t k = 0; k < part.size(); ++k) out[at + k] |= channelOf(component[k]) << (8 * c);
            } else {
                m_attribute.gatherBits(part, channel, c);
                for (std::size_t k = 0; k < part.size(); ++k) {
                    const std::uint32_t v = channel[k] >> m_colorShift;
                    highest = std::max(highest, v);
                    out[at + k] |= std::min(v, 255u) << (8 * c);
                }
            }
        }
    }
    return highest <= 255;
}

}  // namespace punctum::render
