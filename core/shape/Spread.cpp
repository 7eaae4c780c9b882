// SPDX-License-Identifier: MIT
#include "core/shape/Spread.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace punctum
{

namespace
{

constexpr double kOnALine = 1e-9;  ///< share of the second spread in the first, below which points are on a line

using Vector = Spread::Vector;

Vector crossOf(const Vector& a, const Vector& b)
{
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

double dotOf(const Vector& a, const Vector& b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

}  // namespace

SpreadSums SpreadSums::scaled(const std::array<double, 3>& units) const noexcept
{
    const auto& [ux, uy, uz] = units;
    const auto& p = products;
    return {count,
            {sum[0] * ux, sum[1] * uy, sum[2] * uz},
            {p[0] * ux * ux, p[1] * ux * uy, p[2] * ux * uz, p[3] * uy * uy, p[4] * uy * uz, p[5] * uz * uz}};
}

Spread spreadOf(std::span<const std::array<float, 3>> points) noexcept
{
    SpreadSums sums;
    for (const auto& p : points) sums.add(double(p[0]), double(p[1]), double(p[2]));
    return spreadOfSums(sums);
}

Spread spreadOfSums(const SpreadSums& sums) noexcept
{
    Spread spread;
    if (!(sums.count > 0)) return spread;
    const auto& [x, y, z] = sums.sum;
    const auto& [xx, xy, xz, yy, yz, zz] = sums.products;
    const double n = 1.0 / sums.count;
    spread.mean = {x * n, y * n, z * n};
    const auto& m = spread.mean;
    // of a symmetric matrix: the diagonal, and what is beside it
    const Vector d = {xx * n - m[0] * m[0], yy * n - m[1] * m[1], zz * n - m[2] * m[2]};
    const double a = xy * n - m[0] * m[1], b = xz * n - m[0] * m[2], c = yz * n - m[1] * m[2];
    const double middle = (d[0] + d[1] + d[2]) / 3;
    if (!(middle > 0)) return spread;
    const Vector e = {d[0] - middle, d[1] - middle, d[2] - middle};
    const double off = a * a + b * b + c * c;
    const double p = std::sqrt((dotOf(e, e) + 2 * off) / 6);
    if (!(p > 1e-15 * middle)) {  // the same all around
        spread.values = {middle, middle, middle};
        return spread;
    }
    const double determinant = e[0] * (e[1] * e[2] - c * c) - a * (a * e[2] - c * b) + b * (a * c - e[1] * b);
    const double angle = std::acos(std::clamp(determinant / (2 * p * p * p), -1.0, 1.0)) / 3;
    // The cosines of the angle, which is 60 degrees at most, and of a third of a turn more.
    const double cosine = std::cos(angle), sine = std::sqrt((1 - cosine) * (1 + cosine));
    const double most = middle + 2 * p * cosine, least = middle - p * (cosine + std::numbers::sqrt3 * sine);
    spread.values = {std::max(0.0, least), std::max(0.0, 3 * middle - most - least), std::max(0.0, most)};
    if (sums.count < 3 || spread.values[1] <= kOnALine * spread.values[2]) return spread;
    // Rows of the matrix less the eigenvalue are at right angles to its vector; the longest product is the best
    // told.
    const std::array<Vector, 3> rows = {Vector{d[0] - least, a, b}, Vector{a, d[1] - least, c},
                                        Vector{b, c, d[2] - least}};
    Vector best{};
    double longest = 0;
    for (const Vector& v : {crossOf(rows[0], rows[1]), crossOf(rows[0], rows[2]), crossOf(rows[1], rows[2])}) {
        const double length = dotOf(v, v);
        if (length > longest) {
            longest = length;
            best = v;
        }
    }
    const double length = std::sqrt(longest);
    // Where the two least are the same there is no normal.
    if (!(length > 1e-12 * spread.values[2] * spread.values[2])) return spread;
    spread.least = {best[0] / length, best[1] / length, best[2] / length};
    return spread;
}

}  // namespace punctum
