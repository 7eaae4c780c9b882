// SPDX-License-Identifier: MIT
#include "core/shape/PointPlanes.h"

#include "core/neighbors/Neighbors.h"
#include "core/shape/Spread.h"
#include "core/task/Progress.h"

#include <algorithm>
#include <cmath>

namespace punctum
{

namespace
{

constexpr double kPlaneSteps = 8191;  ///< of the two numbers that tell a direction
constexpr double kDeviationLevels = 62;
constexpr double kMostRough = 0.06;  ///< of the variance across the plane: what is rougher fills space
constexpr double kLeastWide = 0.05;  ///< second variance by the first: wires and scan lines have any plane

/// The neighbors nearer than the last one of a list that is full: which of several as far it has goes by indices.
std::size_t nearerThanLast(const KdOrder& order, const Neighborhood& n, std::size_t full)
{
    std::size_t count = n.points.size();
    if (count < full) return count;
    const double furthest = order.squaredDistance(n.point, n.points.back());
    while (count > 0 && order.squaredDistance(n.point, n.points[count - 1]) >= furthest) --count;
    return count;
}

}  // namespace

PackedPlane::PackedPlane(const std::array<double, 3>& normal, double deviation)
{
    // The upper half of an octahedron, seen from above and turned by half a right angle, is a square.
    const double turn = normal[2] < 0 ? -1 : 1;
    const double sum = std::fabs(normal[0]) + std::fabs(normal[1]) + std::fabs(normal[2]);
    if (!(sum > 0)) return;
    const double x = turn * normal[0] / sum, y = turn * normal[1] / sum;
    const auto stepOf = [](double value) {
        return std::uint32_t(std::lround((std::clamp(value, -1.0, 1.0) + 1) / 2 * kPlaneSteps));
    };
    const auto level = std::uint32_t(1 + std::lround(kDeviationLevels * std::clamp(deviation, 0.0, 1.0)));
    m_bits = stepOf(x + y) << 19 | stepOf(x - y) << 6 | level;
}

std::array<double, 3> PackedPlane::normal() const noexcept
{
    const double u = double(m_bits >> 19) / kPlaneSteps * 2 - 1;
    const double v = double(m_bits >> 6 & 8191u) / kPlaneSteps * 2 - 1;
    const double x = (u + v) / 2, y = (u - v) / 2, z = 1 - std::fabs(x) - std::fabs(y);
    const double length = std::sqrt(x * x + y * y + z * z);
    return {x / length, y / length, z / length};
}

std::vector<std::uint32_t> planesOfPoints(const KdOrder& order, std::size_t points, const PlaneOptions& options,
                                          Progress& progress)
{
    std::vector<std::uint32_t> planes(points);
    std::array<double, 3> steps{};
    for (std::size_t a = 0; a < 3; ++a) steps[a] = order.scale()[a] > 0 ? 1 / order.scale()[a] : 0;
    const std::size_t asked = options.neighbors + 1;
    forEachNearest(order, asked, "Fitting planes to points", progress, [&](const Neighborhood& n) {
        SpreadSums sums;  // of whole numbers: the same in any order
        for (const auto& o : n.offsets.first(nearerThanLast(order, n, asked)))
            sums.add(std::nearbyint(double(o[0]) * steps[0]), std::nearbyint(double(o[1]) * steps[1]),
                     std::nearbyint(double(o[2]) * steps[2]));
        if (sums.count < 3) return;
        const Spread spread = spreadOfSums(sums.scaled(order.scale()));
        const double deviation = std::sqrt(spread.l3());
        if (spread.least == Spread::Vector{} || deviation > options.tolerance ||
            spread.l3() > kMostRough * spread.sum() || spread.l2() < kLeastWide * spread.l1())
            return;
        planes[n.point] = PackedPlane(spread.least, deviation / options.tolerance).bits();
    });
    return planes;
}

}  // namespace punctum
