// SPDX-License-Identifier: MIT
#include "core/surface/Triangulation.h"

#include <algorithm>
#include <cmath>

namespace punctum
{

namespace
{

Delaunay grownOf(std::span<const SurfacePoint> points, PlaneMetric metric, Delaunay::Keep keep,
                 const Progress* progress)
{
    Delaunay grown(metric, keep);
    grown.insert(points, progress);
    return grown;
}

/// Whether (x, y) is surely on the right of the edge from a to b. Where doubles cannot tell, it is not: a search
/// then ends there, and heights on both sides are the same but for the last bits.
bool isRightOf(const SurfacePoint& a, const SurfacePoint& b, double x, double y) noexcept
{
    const double left = (double(b.x) - a.x) * (y - a.y), right = (double(b.y) - a.y) * (x - a.x);
    return left - right < -4e-16 * (std::abs(left) + std::abs(right));
}

}  // namespace

Triangulation::Triangulation(std::span<const SurfacePoint> points, PlaneMetric metric, Delaunay::Keep keep,
                             const Progress* progress)
    : Triangulation(grownOf(points, metric, keep, progress))
{
}

Triangulation::Triangulation(Delaunay&& grown) : m_metric(grown.metric())
{
    const std::size_t all = grown.size();
    std::vector<std::uint32_t> numbers(all, kNone);
    std::vector<bool> isCorner(grown.m_vertices.size());
    std::uint32_t count = 0;
    for (std::size_t t = 0; t < all; ++t) {
        if (grown.isGhost(t)) continue;
        numbers[t] = count++;
        for (const std::uint32_t v : grown.corners(t)) isCorner[v] = true;
    }
    std::vector<std::uint32_t> names(grown.m_vertices.size());
    std::uint32_t vertexCount = 0;
    for (std::size_t v = 0; v < names.size(); ++v)
        if (isCorner[v]) names[v] = vertexCount++;
    m_vertices.resize(vertexCount);
    for (std::size_t v = 0; v < names.size(); ++v)
        if (isCorner[v]) m_vertices[names[v]] = grown.m_vertices[v];
    m_corners.resize(count);
    m_neighbors.resize(count);
    for (std::size_t t = 0; t < all; ++t) {
        if (numbers[t] == kNone) continue;
        for (std::size_t i = 0; i < 3; ++i) {
            m_corners[numbers[t]][i] = names[grown.m_corners[3 * t + i]];
            m_neighbors[numbers[t]][i] = numbers[grown.m_twins[3 * t + i] / 3];
        }
    }
}

std::optional<std::uint32_t> Triangulation::locate(double x, double y, std::uint32_t& near) const noexcept
{
    if (empty() || !std::isfinite(x) || !std::isfinite(y)) return std::nullopt;
    std::uint32_t t = near < size() ? near : 0, from = kNone;
    for (;;) {
        const std::array<std::uint32_t, 3>& v = m_corners[t];
        std::size_t beyond = 3;
        for (std::size_t i = 0; i < 3 && beyond == 3; ++i) {
            const std::uint32_t other = m_neighbors[t][i];
            if ((from == kNone || other != from) && isRightOf(m_vertices[v[i]], m_vertices[v[(i + 1) % 3]], x, y))
                beyond = i;
        }
        near = t;
        if (beyond == 3) return t;
        if (m_neighbors[t][beyond] == kNone) return std::nullopt;
        from = t;
        t = m_neighbors[t][beyond];
    }
}

double Triangulation::heightIn(std::uint32_t triangle, double x, double y) const noexcept
{
    const std::array<std::uint32_t, 3>& v = m_corners[triangle];
    const SurfacePoint &a = m_vertices[v[0]], &b = m_vertices[v[1]], &c = m_vertices[v[2]];
    // shares of b and c, so that three equal heights give that height, and a vertex its own
    const double bx = double(b.x) - a.x, by = double(b.y) - a.y, cx = double(c.x) - a.x, cy = double(c.y) - a.y;
    const double px = x - a.x, py = y - a.y, area = bx * cy - by * cx;
    const double shareB = (px * cy - py * cx) / area, shareC = (bx * py - by * px) / area;
    return double(a.z) + shareB * (double(b.z) - a.z) + shareC * (double(c.z) - a.z);
}

std::array<double, 2> Triangulation::slopeOf(std::uint32_t triangle) const noexcept
{
    const std::array<std::uint32_t, 3>& v = m_corners[triangle];
    const SurfacePoint &a = m_vertices[v[0]], &b = m_vertices[v[1]], &c = m_vertices[v[2]];
    const double bx = double(b.x) - a.x, by = double(b.y) - a.y, bz = double(b.z) - a.z;
    const double cx = double(c.x) - a.x, cy = double(c.y) - a.y, cz = double(c.z) - a.z;
    const double area = bx * cy - by * cx;
    return {(bz * cy - by * cz) / area, (bx * cz - bz * cx) / area};
}

double Triangulation::squaredRadius(std::uint32_t triangle) const noexcept
{
    const std::array<std::uint32_t, 3>& v = m_corners[triangle];
    const SurfacePoint &a = m_vertices[v[0]], &b = m_vertices[v[1]], &c = m_vertices[v[2]];
    const double wx = m_metric.x, wy = m_metric.y;
    const auto squared = [&](const SurfacePoint& p, const SurfacePoint& q) {
        const double dx = double(p.x) - q.x, dy = double(p.y) - q.y;
        return wx * dx * dx + wy * dy * dy;
    };
    const double area = (double(b.x) - a.x) * (double(c.y) - a.y) - (double(b.y) - a.y) * (double(c.x) - a.x);
    // a b c / (4 area) with sides of the metric; twice the area grows by the root of both weights
    return squared(a, b) * squared(b, c) * squared(c, a) / (4 * area * area * wx * wy);
}

std::optional<double> Triangulation::height(double x, double y, std::uint32_t& near) const noexcept
{
    const std::optional<std::uint32_t> t = locate(x, y, near);
    if (!t) return std::nullopt;
    return heightIn(*t, x, y);
}

Triangulation::Edge Triangulation::nextOnHull(Edge edge) const noexcept
{
    // about the edge's end, from triangle to triangle
    std::uint32_t t = edge.triangle, side = (edge.side + 1) % 3;
    while (m_neighbors[t][side] != kNone) {
        const std::uint32_t vertex = m_corners[t][side];
        t = m_neighbors[t][side];
        side = m_corners[t][0] == vertex ? 0 : m_corners[t][1] == vertex ? 1 : 2;
    }
    return {t, side};
}

Triangulation::Edge Triangulation::lastOnHull(Edge edge) const noexcept
{
    std::uint32_t t = edge.triangle, side = (edge.side + 2) % 3;
    while (m_neighbors[t][side] != kNone) {
        const std::uint32_t vertex = m_corners[t][(side + 1) % 3];
        t = m_neighbors[t][side];
        side = m_corners[t][0] == vertex ? 2 : m_corners[t][1] == vertex ? 0 : 1;
    }
    return {t, side};
}

std::optional<double> Triangulation::heightNear(double x, double y, std::uint32_t& near) const noexcept
{
    if (const std::optional<std::uint32_t> t = locate(x, y, near)) return heightIn(*t, x, y);
    if (empty() || !std::isfinite(x) || !std::isfinite(y)) return std::nullopt;
    // The search ended at an edge of the hull that sees the place. The hull is convex: along it distances fall,
    // then rise.
    Edge edge{near, 0};
    for (std::uint32_t i = 0; i < 3; ++i)
        if (m_neighbors[near][i] == kNone &&
            isRightOf(m_vertices[m_corners[near][i]], m_vertices[m_corners[near][(i + 1) % 3]], x, y))
            edge.side = i;
    int direction = 0;
    for (;;) {
        const SurfacePoint &a = m_vertices[m_corners[edge.triangle][edge.side]],
                           &b = m_vertices[m_corners[edge.triangle][(edge.side + 1) % 3]];
        const double bx = double(b.x) - a.x, by = double(b.y) - a.y, wx = m_metric.x, wy = m_metric.y;
        const double share = ((x - a.x) * bx * wx + (y - a.y) * by * wy) / (bx * bx * wx + by * by * wy);
        if (share > 1.0 && direction >= 0) {
            direction = 1;
            edge = nextOnHull(edge);
        } else if (share < 0.0 && direction <= 0) {
            direction = -1;
            edge = lastOnHull(edge);
        } else {
            near = edge.triangle;
            return double(a.z) + std::clamp(share, 0.0, 1.0) * (double(b.z) - a.z);
        }
    }
}

}  // namespace punctum
