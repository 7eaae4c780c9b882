// SPDX-License-Identifier: MIT
#include "core/cloud/DecimalScale.h"

#include <array>

namespace punctum
{

namespace
{

/// Powers of ten that are exact in a double.
constexpr auto kPowers = [] {
    std::array<double, 23> powers{};
    double power = 1.0;
    for (double& p : powers) {
        p = power;
        power *= 10.0;
    }
    return powers;
}();

/// A scale of 16 digits is no decimal one but what a division gave, a 127th say: its products have more digits than
/// doubles tell apart.
constexpr double kLongScale = 1e15;

}  // namespace

DecimalScale::DecimalScale(double scale, double offset) noexcept
    : m_scale(scale), m_offset(offset), m_exact(false), m_exact32(false), m_decimals(-1)
{
    if (!std::isfinite(scale) || !std::isfinite(offset)) return;
    for (std::size_t k = 0; k < kPowers.size(); ++k) {
        const double unit = kPowers[k];
        const double factor = std::nearbyint(scale * unit), base = std::nearbyint(offset * unit);
        if (std::abs(factor) > kWhole || std::abs(base) > kWhole) return;
        // A division of whole numbers is rounded once: equal means that these decimals are read as this double.
        if (factor / unit != scale || base / unit != offset) continue;
        m_factor = factor;
        m_base = base + 0.0;  // no negative zero
        m_unit = unit;
        m_exact = true;
        m_exact32 = std::abs(factor) <= 0x1p20 && std::abs(factor) * 0x1p32 + std::abs(base) <= kWhole;
        if (std::abs(factor) < kLongScale) m_decimals = int(k);
        return;
    }
}

double DecimalScale::raw(double value) const noexcept
{
    constexpr double kStepShare = 1e-6;
    const double raw = (value - m_offset) / m_scale;
    const double nearest = std::round(raw);
    if (std::abs(raw - nearest) <= kStepShare) return nearest;
    // With many digits before the point the step itself is smaller than what a double tells apart.
    if (std::abs(nearest) <= kWhole && (*this)(static_cast<long long>(nearest)) == value) return nearest;
    return raw;
}

}  // namespace punctum
