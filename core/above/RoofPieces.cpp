// SPDX-License-Identifier: MIT
#include "core/above/RoofPieces.h"

#include "core/neighbors/Neighbors.h"
#include "core/task/Progress.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numbers>
#include <optional>

namespace punctum
{

namespace
{

constexpr std::size_t kJoined = 8;           ///< nearest points that a point may be joined to, itself among them
constexpr double kPackedUnit = 32'000;       ///< of a normal's components
constexpr double kLevelSlope = 0.12;         ///< radians: what may be a deck
constexpr std::size_t kRootPiece = 1 << 16;  ///< points between two looks at the cancel flag

/// A unit vector that points up, in 4 bytes; no plane: kNoPlane.
struct PackedNormal {
    std::int16_t x = INT16_MIN, y = INT16_MIN;
};

struct FittedPlane {
    std::array<double, 3> normal{};
    double deviation = 0;  ///< standard deviation across the plane
    double flatness = 0;   ///< share of the variance that lies across it
    double breadth = 0;    ///< the second largest variance, as a share of the largest
};

/// Least squares; eigenvalues in closed form (Smith 1961).
std::optional<FittedPlane> fittedPlane(const Neighborhood& n)
{
    const auto count = double(n.offsets.size());
    if (n.offsets.size() < 4) return {};
    std::array<double, 3> mean{};
    for (const auto& o : n.offsets)
        for (std::size_t a = 0; a < 3; ++a) mean[a] += double(o[a]) / count;
    double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
    for (const auto& o : n.offsets) {
        const double x = double(o[0]) - mean[0], y = double(o[1]) - mean[1], z = double(o[2]) - mean[2];
        xx += x * x;
        xy += x * y;
        xz += x * z;
        yy += y * y;
        yz += y * z;
        zz += z * z;
    }
    const double third = (xx + yy + zz) / 3;
    if (!(third > 0)) return {};
    const double off = xy * xy + xz * xz + yz * yz;
    const double p = std::sqrt(
        ((xx - third) * (xx - third) + (yy - third) * (yy - third) + (zz - third) * (zz - third) + 2 * off) / 6);
    if (!(p > 0)) return {};
    const double a = (xx - third) / p, b = (yy - third) / p, c = (zz - third) / p, d = xy / p, e = xz / p,
                 f = yz / p;
    const double r = std::clamp((a * (b * c - f * f) - d * (d * c - f * e) + e * (d * f - b * e)) / 2, -1.0, 1.0);
    const double angle = std::acos(r) / 3;
    const double most = third + 2 * p * std::cos(angle);
    const double least = third + 2 * p * std::cos(angle + 2 * std::numbers::pi / 3);
    const double middle = 3 * third - most - least;
    // The eigenvector of the least one is across two rows of what is left: the longest of three products.
    const std::array<std::array<double, 3>, 3> rows{
        {{xx - least, xy, xz}, {xy, yy - least, yz}, {xz, yz, zz - least}}};
    std::array<double, 3> normal{};
    double longest = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const auto &u = rows[k], &v = rows[(k + 1) % 3];
        const std::array<double, 3> across{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
                                           u[0] * v[1] - u[1] * v[0]};
        const double length = across[0] * across[0] + across[1] * across[1] + across[2] * across[2];
        if (length <= longest) continue;
        longest = length;
        normal = across;
    }
    if (!(longest > 0)) return {};
    const double turn = (normal[2] < 0 ? -1 : 1) / std::sqrt(longest);
    FittedPlane plane;
    for (std::size_t k = 0; k < 3; ++k) plane.normal[k] = normal[k] * turn;
    plane.deviation = std::sqrt(std::max(0.0, least) / count);
    plane.flatness = std::max(0.0, least) / (3 * third);
    plane.breadth = middle / most;
    return plane;
}

/// The piece's first point, by way of others'; halves the way for those who come later.
std::uint32_t rootOfPiece(std::vector<std::uint32_t>& parents, std::uint32_t point) noexcept
{
    for (;;) {
        std::atomic_ref<std::uint32_t> own(parents[point]);
        std::uint32_t parent = own.load(std::memory_order_relaxed);
        if (parent == point) return point;
        const std::uint32_t next = std::atomic_ref(parents[parent]).load(std::memory_order_relaxed);
        if (next == parent) return parent;
        own.compare_exchange_weak(parent, next, std::memory_order_relaxed);
        point = next;
    }
}

/// Of two pieces one; its root is the lesser.
void joinPieces(std::vector<std::uint32_t>& parents, std::uint32_t a, std::uint32_t b) noexcept
{
    for (;;) {
        a = rootOfPiece(parents, a);
        b = rootOfPiece(parents, b);
        if (a == b) return;
        if (a < b) std::swap(a, b);
        std::uint32_t expected = a;
        if (std::atomic_ref(parents[a]).compare_exchange_strong(expected, b, std::memory_order_relaxed)) return;
    }
}

}  // namespace

RoofPieces findRoofPieces(const KdOrder& order, const PointRanks& ranks, const RoofOptions& options,
                          Progress& progress)
{
    const std::size_t points = ranks.count();
    RoofPieces pieces;
    pieces.pieceOf.assign(points, kNoPiece);
    pieces.level.assign(points, 0);
    std::vector<PackedNormal> normals(points);
    const double leastZ = std::cos(options.steepest), levelZ = std::cos(kLevelSlope);
    forEachNearest(order, options.neighbors, "Fitting planes", progress, [&](const Neighborhood& n) {
        const auto plane = fittedPlane(n);
        // 0.06: what is rougher has no plane at any scale; 0.05: wires and edges have one in any direction.
        if (!plane || plane->deviation > options.roughness || plane->flatness > 0.06 || plane->breadth < 0.05 ||
            plane->normal[2] < leastZ)
            return;
        const std::uint32_t own = ranks(n.point);
        normals[own] = {std::int16_t(plane->normal[0] * kPackedUnit), std::int16_t(plane->normal[1] * kPackedUnit)};
        pieces.pieceOf[own] = own;
        pieces.level[own] = std::uint8_t(plane->normal[2] >= levelZ);
    });
    const auto normalOf = [&](std::uint32_t point) {
        const double x = double(normals[point].x) / kPackedUnit, y = double(normals[point].y) / kPackedUnit;
        return std::array{x, y, std::sqrt(std::max(0.0, 1 - x * x - y * y))};
    };
    const double leastCosine = std::cos(options.bend);
    const double apart = 3 * options.roughness;
    forEachNearest(order, kJoined, "Joining pieces", progress, [&](const Neighborhood& n) {
        const std::uint32_t point = ranks(n.point);
        if (normals[point].x == INT16_MIN) return;
        const auto own = normalOf(point);
        for (std::size_t k = 0; k < n.points.size(); ++k) {
            const std::uint32_t beside = ranks(n.points[k]);
            if (beside == point || normals[beside].x == INT16_MIN) continue;
            const auto other = normalOf(beside);
            const auto& o = n.offsets[k];
            if (own[0] * other[0] + own[1] * other[1] + own[2] * other[2] < leastCosine) continue;
            if (std::fabs(double(o[0]) * own[0] + double(o[1]) * own[1] + double(o[2]) * own[2]) > apart) continue;
            joinPieces(pieces.pieceOf, point, beside);
        }
    });
    for (std::uint32_t i = 0; i < points; ++i) {
        if (i % kRootPiece == 0) progress.check();
        if (pieces.pieceOf[i] != kNoPiece) pieces.pieceOf[i] = rootOfPiece(pieces.pieceOf, i);
    }
    return pieces;
}

}  // namespace punctum
