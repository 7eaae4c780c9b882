// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

/// Random numbers and noise that are the same on every machine: integers, and of the floating-point operations only
/// those that IEEE 754 defines to the last bit (no sin, exp or pow, and no contraction to fused operations).
namespace punctum::sample
{

/// Finalizer of splitmix64 (Steele, Lea, Flood: Fast Splittable Pseudorandom Number Generators, 2014).
constexpr std::uint64_t mix(std::uint64_t x) noexcept
{
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
    return x ^ (x >> 31);
}

constexpr std::uint64_t hash(std::uint64_t seed, std::int64_t a, std::int64_t b = 0, std::int64_t c = 0) noexcept
{
    std::uint64_t h = mix(seed + 0x9E3779B97F4A7C15u * (std::uint64_t(a) + 1));
    h = mix(h + 0xD1B54A32D192ED03u * (std::uint64_t(b) + 1));
    return mix(h + 0x8CB92BA72F3D8DD7u * (std::uint64_t(c) + 1));
}

/// 0 up to but not including 1.
constexpr double unit(std::uint64_t h) noexcept
{
    return double(h >> 11) * 0x1p-53;
}

/// A stream of random numbers (splitmix64).
class Random
{
public:
    explicit constexpr Random(std::uint64_t seed) noexcept : m_state(seed) {}
    constexpr std::uint64_t next() noexcept { return mix(m_state += 0x9E3779B97F4A7C15u); }
    constexpr double unit() noexcept { return sample::unit(next()); }
    constexpr double between(double lo, double hi) noexcept { return lo + (hi - lo) * unit(); }
    constexpr bool chance(double p) noexcept { return unit() < p; }
    /// Mean 0, deviation 1, never beyond 3.5: the sum of four uniform numbers, near enough to normal.
    constexpr double bell() noexcept
    {
        const std::uint64_t h = next();
        const auto part = [h](unsigned k) { return double((h >> (16 * k)) & 0xFFFF); };
        return ((part(0) + part(1) + part(2) + part(3)) / 65536.0 - 2.0) * 1.7320508;
    }

private:
    std::uint64_t m_state;
};

/// floor() as an integer; std::floor is a call where the processor's baseline has no rounding instruction.
constexpr std::int64_t floorOf(double v) noexcept
{
    const auto i = std::int64_t(v);
    return i - (v < double(i) ? 1 : 0);
}
/// What is left of v above floor(v).
constexpr double fractionOf(double v) noexcept
{
    return v - double(floorOf(v));
}

/// 0 below 0, 1 above 1, smooth between.
constexpr double smooth(double t) noexcept
{
    t = t < 0.0 ? 0.0 : t > 1.0 ? 1.0 : t;
    return t * t * (3.0 - 2.0 * t);
}

constexpr double lerp(double a, double b, double t) noexcept
{
    return a + (b - a) * t;
}

/// Gradient noise (Perlin: Improving Noise, 2002) with eight directions; about -1 to 1, features of size 1.
double noise(std::uint64_t seed, double x, double y) noexcept;
/// Smooth values along a line, -1 to 1.
double noise(std::uint64_t seed, double x) noexcept;

}  // namespace punctum::sample
