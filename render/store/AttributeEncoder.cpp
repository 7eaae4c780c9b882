// SPDX-License-Identifier: MIT
#include "render/store/AttributeEncoder.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <vector>

namespace punctum::render
{

namespace
{

constexpr std::size_t kBlock = 1024;
constexpr std::uint32_t kBlack = 0xFF000000u, kNoColor = 0xFF808080u;  ///< the latter as ResolveSettings::noValue

WordKind wordKindOf(const Attribute& a) noexcept
{
    switch (a.kind) {
        case AttributeKind::Class:
            return WordKind::Class;
        case AttributeKind::Category:
            return a.integral() ? WordKind::Category : WordKind::Scalar;
        case AttributeKind::Color:
            return WordKind::Color;
        case AttributeKind::Vector:
            return WordKind::Normal;
        case AttributeKind::Scalar:
        case AttributeKind::Opaque:
            break;
    }
    return WordKind::Scalar;
}

/// A component of a direction, -1..1, as WordKind::Normal has it; 0 for no number.
std::uint32_t tenBits(float v) noexcept
{
    return std::isnan(v) ? 0u : std::uint32_t(std::clamp(v, -1.0f, 1.0f) * 511.0f + 512.5f);
}

}  // namespace

int colorShiftOf(std::vector<std::uint32_t>& largest) noexcept
{
    std::erase(largest, 0u);
    if (largest.empty()) return 0;
    std::sort(largest.begin(), largest.end());
    // Of few points one may be brighter, too.
    const std::size_t above = largest.size() < 8 ? 0 : std::max<std::size_t>(1, largest.size() / 100);
    const std::uint32_t bright = largest[largest.size() - 1 - above];
    for (const int shift : {0, 2, 4})
        if (bright >> shift <= 255) return shift;
    return 8;
}

AttributeEncoder::AttributeEncoder(Attribute attribute, double bias, int colorShift)
    : m_attribute(std::move(attribute)),
      m_kind(wordKindOf(m_attribute)),
      m_bias(bias),
      m_colorShift(colorShift),
      m_lacking(m_kind == WordKind::Color && !m_attribute.columns[0]->absent().empty())
{
}

std::size_t AttributeEncoder::encode(std::span<const std::uint32_t> indices, std::uint32_t* out) const
{
    return encodeParts(
        indices.size(), [&](std::size_t at, std::size_t n) { return indices.subspan(at, n); }, out);
}

std::size_t AttributeEncoder::encode(PointRange range, std::uint32_t* out) const
{
    return encodeParts(
        std::size_t(range.size()),
        [&](std::size_t at, std::size_t n) {
            return PointRange{range.first + at, range.first + at + n};
        },
        out);
}

namespace
{

PointIndex pointAt(std::span<const std::uint32_t> indices, std::size_t k)
{
    return indices[k];
}
PointIndex pointAt(PointRange range, std::size_t k)
{
    return range.first + k;
}

/// Words of colors, whose channels are shifted right and cut to 255. Returns how many were cut.
template <std::size_t N>
std::size_t packColors(const std::uint32_t (&channels)[3][N], int shift, std::size_t count, std::uint32_t* words)
{
    std::uint32_t seen = 0;
    for (std::size_t k = 0; k < count; ++k) {
        const std::uint32_t r = channels[0][k] >> shift, g = channels[1][k] >> shift, b = channels[2][k] >> shift;
        seen |= r | g | b;
        words[k] = 0xFF000000u | b << 16 | g << 8 | r;
    }
    if (seen <= 255) return 0;
    std::size_t over = 0;
    for (std::size_t k = 0; k < count; ++k) {
        const auto cut = [&](int c) { return std::min(channels[c][k] >> shift, 255u); };
        words[k] = 0xFF000000u | cut(2) << 16 | cut(1) << 8 | cut(0);
        over += ((channels[0][k] | channels[1][k] | channels[2][k]) >> shift) > 255 ? 1 : 0;
    }
    return over;
}

}  // namespace

template <typename Points>
void AttributeEncoder::markSelected(const Points& points, std::size_t count, std::uint32_t* words) const
{
    const std::uint32_t bit = selectedBit(m_kind);
    const bool inverse = m_kind == WordKind::Color;
    for (std::size_t k = 0; k < count; ++k) {
        const bool set = m_selection->contains(pointAt(points, k)) != inverse;
        words[k] = set ? words[k] | bit : words[k] & ~bit;
    }
}

/// Points of files without colors are not black.
template <typename Points>
void AttributeEncoder::markWithoutColor(const Points& points, std::size_t count, std::uint32_t* words) const
{
    for (std::size_t k = 0; k < count; ++k)
        if (const PointIndex i = pointAt(points, k);
            words[k] == kBlack && m_attribute.lacks(i, 0) && m_attribute.lacks(i, 1) && m_attribute.lacks(i, 2))
            words[k] = kNoColor;
}

/// `part(at, n)`: which points the n from `at` on are.
template <typename Part>
std::size_t AttributeEncoder::encodeParts(std::size_t count, const Part& part, std::uint32_t* out) const
{
    static_assert(sizeof(float) == sizeof(std::uint32_t));
    float values[kBlock];
    std::uint32_t channels[3][kBlock];
    std::size_t cut = 0;
    for (std::size_t at = 0; at < count; at += kBlock) {
        const std::size_t n = std::min(kBlock, count - at);
        const auto points = part(at, n);
        std::uint32_t* words = out + at;
        if (m_kind == WordKind::Scalar) {
            m_attribute.gather(points, m_bias, values);
            std::memcpy(words, values, n * sizeof(float));
        } else if (m_kind == WordKind::Normal) {
            m_attribute.gather(points, 0.0, values, 0);
            for (std::size_t k = 0; k < n; ++k) words[k] = tenBits(values[k]);
            for (std::uint32_t c = 1; c < 3; ++c) {
                m_attribute.gather(points, 0.0, values, c);
                for (std::size_t k = 0; k < n; ++k) {
                    const std::uint32_t bits = tenBits(values[k]);
                    words[k] = words[k] == 0 || bits == 0 ? 0 : words[k] | bits << (10 * c);
                }
            }
        } else if (m_kind != WordKind::Color) {
            m_attribute.gatherBits(points, words);
        } else {
            m_attribute.gatherBits(points, channels[0], 0);
            m_attribute.gatherBits(points, channels[1], 1);
            m_attribute.gatherBits(points, channels[2], 2);
            cut += packColors(channels, m_colorShift, n, words);
            if (m_lacking) markWithoutColor(points, n, words);
        }
        if (m_selection) markSelected(points, n, words);
    }
    return cut;
}

}  // namespace punctum::render
