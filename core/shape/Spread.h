// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <span>

namespace punctum
{

/// How points lie about their mean: the eigenvalues and eigenvectors of their covariance.
struct Spread {
    using Vector = std::array<double, 3>;
    Vector mean{};
    Vector values{};  ///< variances along the axes, rising; none is negative
    Vector least{};   ///< unit vector along which they spread least: the normal of the plane of least squares; zero
                      ///< where none is singled out (fewer than three points, or all on a line)

    /// The greatest one, and the shares of all: l1 >= l2 >= l3.
    double l1() const noexcept { return values[2]; }
    double l2() const noexcept { return values[1]; }
    double l3() const noexcept { return values[0]; }
    double sum() const noexcept { return values[0] + values[1] + values[2]; }
};

/// Sums over points: how many, their coordinates, and products of these.
struct SpreadSums {
    double count = 0;
    std::array<double, 3> sum{};
    std::array<double, 6> products{};  ///< xx, xy, xz, yy, yz, zz

    void add(double x, double y, double z) noexcept
    {
        count += 1;
        sum[0] += x;
        sum[1] += y;
        sum[2] += z;
        products[0] += x * x;
        products[1] += x * y;
        products[2] += x * z;
        products[3] += y * y;
        products[4] += y * z;
        products[5] += z * z;
    }
    /// The same of points whose coordinates are in other units along each axis.
    SpreadSums scaled(const std::array<double, 3>& units) const noexcept;
};

/// In closed form (Smith 1961: the roots of the characteristic polynomial by an angle), in double. Values are good
/// to some 1e-14 of the greatest.
Spread spreadOfSums(const SpreadSums& sums) noexcept;
Spread spreadOf(std::span<const std::array<float, 3>> points) noexcept;

}  // namespace punctum
