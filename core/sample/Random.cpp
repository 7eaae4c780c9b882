// SPDX-License-Identifier: MIT
#include "core/sample/Random.h"

namespace punctum::sample
{

namespace
{

constexpr double fade(double t) noexcept
{
    return t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
}

/// One round of mixing is enough for a direction, and this is the hottest hash there is.
constexpr std::uint32_t corner(std::uint64_t seed, std::int64_t x, std::int64_t y) noexcept
{
    std::uint64_t h = seed ^ (std::uint64_t(x) * 0x9E3779B97F4A7C15u) ^ (std::uint64_t(y) * 0xC2B2AE3D27D4EB4Fu);
    h = (h ^ (h >> 29)) * 0xBF58476D1CE4E5B9u;
    return std::uint32_t(h >> 40);
}

constexpr double gradient(std::uint32_t h, double dx, double dy) noexcept
{
    constexpr double kX[8] = {1, -1, 1, -1, 1.4142, -1.4142, 0, 0};
    constexpr double kY[8] = {1, 1, -1, -1, 0, 0, 1.4142, -1.4142};
    return kX[h & 7] * dx + kY[h & 7] * dy;
}

}  // namespace

double noise(std::uint64_t seed, double x, double y) noexcept
{
    const std::int64_t ix = floorOf(x), iy = floorOf(y);
    const double dx = x - double(ix), dy = y - double(iy);
    const double u = fade(dx), v = fade(dy);
    const double a =
        lerp(gradient(corner(seed, ix, iy), dx, dy), gradient(corner(seed, ix + 1, iy), dx - 1, dy), u);
    const double b = lerp(gradient(corner(seed, ix, iy + 1), dx, dy - 1),
                          gradient(corner(seed, ix + 1, iy + 1), dx - 1, dy - 1), u);
    return lerp(a, b, v);
}

double noise(std::uint64_t seed, double x) noexcept
{
    const std::int64_t i = floorOf(x);
    return lerp(unit(hash(seed, i)) * 2.0 - 1.0, unit(hash(seed, i + 1)) * 2.0 - 1.0, fade(x - double(i)));
}

}  // namespace punctum::sample
