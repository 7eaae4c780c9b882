// SPDX-License-Identifier: MIT
#pragma once

#include "render/scene/ResolveSettings.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

namespace punctum::render
{

struct TargetSize;

// Eye-dome lighting darkens each sample by how far it lies behind its neighbors, so that shapes show without
// normals (C. Boucheny, "Interactive scientific visualization of large datasets", PhD thesis, Grenoble 2009).
// Samples are lit before they are averaged: on the rim of a surface those of the ground behind are dark and those
// of the surface are not. A sample's neighbors are the samples of its own place in the pixels around it.
//
// The depth that makes a sample dark is a share of the depth range in the picture (2nd to 98th percentile of the
// logarithm in perspective, of the depth itself in an orthographic view): a room and a mountain look alike.
//
// Shaders do the same by the same steps: resources/shaders/gl/eyedome.glsl and extent.comp.glsl. Change them
// together.

/// Where no point is: farther than all that has a level, and still a number.
inline constexpr float kNoLevel = 3.0e38f;
/// Values that the range is judged by: at least so many, less than twice of it, where there are as many.
inline constexpr std::size_t kExtentValues = 4096;
inline constexpr float kExtentLow = 0.02f, kExtentHigh = 0.98f;
/// Darkness for a step of the whole depth range; what looks right on surveys, rooms and trees.
inline constexpr float kEyeDomeSteepness = 14.0f;
inline constexpr float kEyeDomeDarkest = 0.15f;
/// Eight neighbors, on a square; those at `reach` px show edges, those at twice that show shapes.
inline constexpr std::array<std::array<int, 2>, 8> kEyeDomeNeighbors{
    {{-1, -1}, {0, -1}, {1, -1}, {-1, 0}, {1, 0}, {-1, 1}, {0, 1}, {1, 1}}};

/// log2 of a positive, normal number, to 1e-6: the same on every processor and device.
inline float log2Of(float value) noexcept
{
    const auto bits = std::bit_cast<std::uint32_t>(value);
    // the mantissa between the root of 1/2 and the root of 2
    const std::int32_t exponent = std::int32_t(bits - 0x3F3504F3u) >> 23;
    const float m = std::bit_cast<float>(bits - (std::uint32_t(exponent) << 23));
    const float t = (m - 1.0f) / (m + 1.0f), s = t * t;
    return float(exponent) + t * (2.885390f + s * (0.9617967f + s * (0.5770780f + s * 0.4121986f)));
}

/// 2 to the power of `value`, which is at most 0, to 4e-6 of it; likewise.
inline float exp2Of(float value) noexcept
{
    const float x = std::max(value, -120.0f);
    const auto whole = std::int32_t(x);
    const float f = x - float(whole);  // -1 to 0
    float p = 0.0000152527f;
    for (const float c :
         {0.0001540353f, 0.0013333558f, 0.0096181291f, 0.0555041087f, 0.2402265070f, 0.6931471806f, 1.0f})
        p = p * f + c;
    return p * std::bit_cast<float>(std::uint32_t(whole + 127) << 23);
}

/// What depths are compared by.
inline float eyeDomeLevel(float depth, bool perspective) noexcept
{
    return perspective ? log2Of(std::max(depth, 1e-6f)) : depth;
}

/// Factor of what lies in front of a sample, summed up: a power of 2 makes it the shade.
inline float eyeDomeScale(float strength, float extent) noexcept
{
    constexpr float kLog2E = 1.442695f;
    return kEyeDomeSteepness * kLog2E * strength / (extent * float(2 * kEyeDomeNeighbors.size()));
}

/// Range of these levels without outliers; 0 when there are none. Looks at kExtentValues of them.
float eyeDomeExtent(std::span<const float> levels);

/// What lighting takes of a sample's color, for all samples of a picture by the processor. In parallel; the result
/// depends on nothing but the arguments.
class EyeDomeShades
{
public:
    /// `cells` as CpuBackend::cells(). Empty where nothing is darkened.
    EyeDomeShades(std::span<const std::uint64_t> cells, const TargetSize& size, const EyeDomeSettings& settings);
    bool empty() const noexcept { return m_levels.empty(); }
    /// Of the samples of a row, in the order of cells: 1 keeps the color, kEyeDomeDarkest is the least.
    void shadesOf(int row, std::vector<float>& out) const;

private:
    std::vector<float> m_levels;
    int m_columns = 0, m_height = 0;  ///< columns of samples
    int m_samples = 1;
    int m_reach = 1;
    float m_extent = 0, m_scale = 0;
};

inline Rgba8 dimmed(Rgba8 c, float shade) noexcept
{
    const auto dim = [shade](std::uint8_t v) { return std::uint8_t(float(v) * shade + 0.5f); };
    return {dim(c.r), dim(c.g), dim(c.b), c.a};
}

}  // namespace punctum::render
