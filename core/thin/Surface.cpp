// SPDX-License-Identifier: MIT
#include "core/thin/Surface.h"

#include "core/task/Progress.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace punctum
{

namespace
{

constexpr std::size_t kSurfaceCheck = 256;  ///< points between two looks at the cancel flag

using Matrix = std::array<std::array<double, 3>, 3>;

/// Turns the axes so that the entry (p, q) of a symmetric matrix is 0 (Jacobi 1846); `axes` keeps where they went.
void turnAxes(Matrix& m, Matrix& axes, std::size_t p, std::size_t q)
{
    if (m[p][q] == 0) return;
    const double theta = (m[q][q] - m[p][p]) / (2 * m[p][q]);
    const double t = (theta < 0 ? -1.0 : 1.0) / (std::fabs(theta) + std::sqrt(theta * theta + 1));
    const double c = 1 / std::sqrt(t * t + 1), s = t * c;
    for (std::size_t k = 0; k < 3; ++k) {
        const double a = m[k][p], b = m[k][q];
        m[k][p] = c * a - s * b;
        m[k][q] = s * a + c * b;
    }
    for (std::size_t k = 0; k < 3; ++k) {
        const double a = m[p][k], b = m[q][k];
        m[p][k] = c * a - s * b;
        m[q][k] = s * a + c * b;
        const double u = axes[k][p], v = axes[k][q];
        axes[k][p] = c * u - s * v;
        axes[k][q] = s * u + c * v;
    }
}

}  // namespace

SurfacePiece::Vector planeNormal(std::span<const std::array<float, 3>> places) noexcept
{
    if (places.size() < 3) return {0, 0, 0};
    std::array<double, 3> mean{};
    for (const auto& p : places)
        for (std::size_t a = 0; a < 3; ++a) mean[a] += double(p[a]) / double(places.size());
    Matrix m{}, axes{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    for (const auto& p : places)
        for (std::size_t a = 0; a < 3; ++a)
            for (std::size_t b = 0; b < 3; ++b) m[a][b] += (double(p[a]) - mean[a]) * (double(p[b]) - mean[b]);
    for (int round = 0; round < 4; ++round) {
        turnAxes(m, axes, 0, 1);
        turnAxes(m, axes, 0, 2);
        turnAxes(m, axes, 1, 2);
    }
    std::size_t least = 0;
    for (std::size_t a = 1; a < 3; ++a)
        if (m[a][a] < m[least][least]) least = a;
    // Of points in one line or place no plane is the best one.
    const double second = std::min(m[(least + 1) % 3][(least + 1) % 3], m[(least + 2) % 3][(least + 2) % 3]);
    const double largest = std::max(m[(least + 1) % 3][(least + 1) % 3], m[(least + 2) % 3][(least + 2) % 3]);
    if (!(second > 1e-9 * largest)) return {0, 0, 0};
    return {float(axes[0][least]), float(axes[1][least]), float(axes[2][least])};
}

float bend(const SurfacePiece::Vector& a, const SurfacePiece::Vector& b) noexcept
{
    const float cosine = std::fabs(a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
    const bool none = (a[0] == 0 && a[1] == 0 && a[2] == 0) || (b[0] == 0 && b[1] == 0 && b[2] == 0);
    return none ? 0.0f : std::max(0.0f, 1 - cosine);
}

bool SurfacePiece::read(const KdOrder& order, std::size_t node, std::size_t neighbors, double marginSpacings,
                        const Progress& progress)
{
    const auto mine = order.points(node);
    own = mine.size();
    points.assign(mine.begin(), mine.end());
    std::sort(points.begin(), points.end());
    std::vector<KdOrder::Found> found;
    const KdOrder::Box& box = order.box(node);
    if (marginSpacings > 0) {
        std::vector<double> reach;
        for (std::size_t k = 0; k < own; k += std::max<std::size_t>(1, own / 16)) {
            order.nearest(points[k], neighbors, found);
            reach.push_back(std::sqrt(found.back().squared / double(found.size())));
        }
        std::nth_element(reach.begin(), reach.begin() + std::ptrdiff_t(reach.size() / 2), reach.end());
        const double margin = marginSpacings * reach[reach.size() / 2];
        std::array<double, 3> low{}, high{};
        for (std::size_t a = 0; a < 3; ++a) {
            const double raw = order.scale()[a] > 0 ? margin / order.scale()[a] : 0.0;
            low[a] = double(box.min[a]) - raw;
            high[a] = double(box.max[a]) + raw;
        }
        order.forLeavesIn(low, high, node, [&](std::size_t leaf) {
            for (const std::uint32_t p : order.points(leaf)) {
                const KdOrder::Raw r = order.raw(p);
                bool inside = points.size() < 3 * own + 1024;
                for (std::size_t a = 0; a < 3; ++a)
                    inside = inside && double(r[a]) >= low[a] && double(r[a]) <= high[a];
                if (inside) points.push_back(p);
            }
        });
        std::sort(points.begin() + std::ptrdiff_t(own), points.end());
    }
    std::array<double, 3> origin{};
    for (std::size_t a = 0; a < 3; ++a) origin[a] = (double(box.min[a]) + double(box.max[a])) / 2;
    places.clear();
    for (const std::uint32_t p : points) places.push_back(order.local(p, origin));
    const auto number = [&](std::uint32_t point) {
        const auto middle = points.begin() + std::ptrdiff_t(own);
        auto at = std::lower_bound(points.begin(), middle, point);
        if (at == middle || *at != point) at = std::lower_bound(middle, points.end(), point);
        return at != points.end() && *at == point ? std::uint32_t(at - points.begin()) : UINT32_MAX;
    };
    normals.resize(points.size());
    areas.resize(points.size());
    near.resize(points.size());
    std::vector<std::array<float, 3>> patch;
    for (std::size_t k = 0; k < points.size(); ++k) {
        if (k % kSurfaceCheck == 0 && progress.cancelled()) return false;
        order.nearest(points[k], neighbors, found);
        const KdOrder::Raw r = order.raw(points[k]);
        patch.clear();
        near[k].clear();
        for (const KdOrder::Found& f : found) {
            patch.push_back(order.local(f.point, {double(r[0]), double(r[1]), double(r[2])}));
            const std::uint32_t there = number(f.point);
            if (there != UINT32_MAX && there != k) near[k].push_back(there);
        }
        normals[k] = planeNormal(patch);
        areas[k] = float(std::numbers::pi * found.back().squared / double(found.size()));
    }
    return true;
}

}  // namespace punctum
