// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <type_traits>

namespace punctum
{

/// raw * scale + offset as the decimals mean it: a scale of 0.01 is a hundredth, and not the double next to it.
///
/// In units of the last decimal that scale or offset has, both are whole numbers, and so is every value: it is
/// computed exactly, and rounded once, to the double that its decimals are read as. What has no such unit within
/// the 53 bits of a double (a third, a scale that passed through a float) is computed as doubles are. Any thread.
///
///     DecimalScale(0.01, 0.0)(84914820) == 849148.2    // where 84914820 * 0.01 is 849148.2000000001
class DecimalScale
{
public:
    DecimalScale() = default;
    DecimalScale(double scale, double offset) noexcept;

    /// The value of a stored number.
    template <typename T>
    double operator()(T raw) const noexcept
    {
        const double number = double(raw);
        if constexpr (std::is_integral_v<T>) {
            // 32 bits: known beforehand, so that loops become vectors; 64 bits are looked at one by one
            if constexpr (sizeof(T) <= 4) {
                if (m_exact32) return (number * m_factor + m_base) / m_unit;
            } else if (m_exact) {
                const double product = number * m_factor, sum = product + m_base;
                if (std::abs(product) <= kWhole && std::abs(sum) <= kWhole) return sum / m_unit;
            }
        }
        return number * m_scale + m_offset;
    }

    /// The stored number of a value; whole where the value is one of those that stored integers have. What is
    /// within a millionth of a step counts as that step, since scales that have no decimals leave a rest.
    double raw(double value) const noexcept;

    /// Decimals that tell all values apart; -1: no number of decimals does, and values are written as doubles are.
    int decimals() const noexcept { return m_decimals; }

private:
    static constexpr double kWhole = 0x1p53;  ///< up to here doubles hold every whole number

    double m_scale = 1.0, m_offset = 0.0;
    double m_factor = 1.0, m_base = 0.0, m_unit = 1.0;  ///< value = (raw * factor + base) / unit, all whole numbers
    bool m_exact = true, m_exact32 = true;
    int m_decimals = 0;
};

}  // namespace punctum
