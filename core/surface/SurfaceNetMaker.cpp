// SPDX-License-Identifier: MIT
#include "core/surface/SurfaceNetMaker.h"

#include <algorithm>
#include <cmath>

namespace punctum
{

namespace
{

/// Share of a tile's side by which it is grown at first: some four times the spacing of its points.
constexpr double kFirstMargin = 0.125;

/// Twice the signed area, of places for which doubles will do.
double sideOf(const std::array<double, 2>& a, const std::array<double, 2>& b, double x, double y) noexcept
{
    return (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]);
}

}  // namespace

bool isInHull(std::span<const std::array<double, 2>> hull, double x, double y) noexcept
{
    for (std::size_t i = 0; i < hull.size(); ++i)
        if (sideOf(hull[i], hull[i + 1 == hull.size() ? 0 : i + 1], x, y) <= 0) return false;
    return hull.size() >= 3;
}

bool isInHull(std::span<const std::array<double, 2>> hull, const RawRect& r) noexcept
{
    return isInHull(hull, r.minX, r.minY) && isInHull(hull, r.maxX, r.minY) && isInHull(hull, r.minX, r.maxY) &&
           isInHull(hull, r.maxX, r.maxY);
}

namespace
{

/// The circle through three corners, a little larger, so that what is on it is in it whatever the rounding.
RawDisc circleOf(const SurfacePoint& a, const SurfacePoint& b, const SurfacePoint& c, const PlaneMetric& m) noexcept
{
    const double bx = double(b.x) - a.x, by = double(b.y) - a.y, cx = double(c.x) - a.x, cy = double(c.y) - a.y;
    const double wx = m.x, wy = m.y, area = 2 * (bx * cy - by * cx);
    const double lb = wx * bx * bx + wy * by * by, lc = wx * cx * cx + wy * cy * cy;
    const double x = (cy * lb - by * lc) / (area * wx), y = (bx * lc - cx * lb) / (area * wy);
    const double radius = std::sqrt(wx * x * x + wy * y * y) * (1 + 1e-7) + 1;
    return {a.x + x, a.y + y, radius * radius};
}

RawRect rectOf(const RawDisc& disc, const PlaneMetric& m) noexcept
{
    const double rx = std::sqrt(disc.squaredRadius / m.x), ry = std::sqrt(disc.squaredRadius / m.y);
    return {disc.x - rx, disc.y - ry, disc.x + rx, disc.y + ry};
}

/// By the metric, from a place to the nearest of a rectangle.
double squaredGap(const RawRect& rect, double x, double y, const PlaneMetric& m) noexcept
{
    const double dx = std::max({rect.minX - x, 0.0, x - rect.maxX}),
                 dy = std::max({rect.minY - y, 0.0, y - rect.maxY});
    return m.x * dx * dx + m.y * dy * dy;
}

/// Of a triangle by its corners, in whatever order; 0: they are too many to be told apart.
std::uint64_t keyOf(std::array<std::uint32_t, 3> corners) noexcept
{
    constexpr int kBits = 21;
    std::sort(corners.begin(), corners.end());
    if (corners[2] >> kBits != 0) return 0;
    return std::uint64_t(corners[0]) << 2 * kBits | std::uint64_t(corners[1]) << kBits | corners[2];
}

RawRect commonOf(const RawRect& a, const RawRect& b) noexcept
{
    return {std::max(a.minX, b.minX), std::max(a.minY, b.minY), std::min(a.maxX, b.maxX), std::min(a.maxY, b.maxY)};
}

}  // namespace

SurfaceNetMaker::SurfaceNetMaker(const SurfaceTiles& tiles, std::size_t tile, double beyond)
    : m_tiles(tiles), m_net(tiles.m_metric)
{
    const RawRect& box = tiles.box(tile);
    const double width = box.maxX - box.minX, height = box.maxY - box.minY;
    m_box = box.grown(beyond * width, beyond * height);
    m_whole = box.grown(kFirstMargin * width, kFirstMargin * height);
    m_far = m_box.grown(2.001 * tiles.m_rawReach[0] + 1, 2.001 * tiles.m_rawReach[1] + 1);
    m_whole = commonOf(m_whole, m_far);
}

template <typename F>
void SurfaceNetMaker::forPointsIn(const RawRect& rect, F&& f) const
{
    m_tiles.forTilesIn(rect, [&](std::size_t tile) {
        for (const std::uint32_t index : m_tiles.m_points[tile]) {
            const SurfacePoint p = m_tiles.point(index);
            if (rect.holds(p.x, p.y)) f(p);
        }
    });
}

SurfaceNet SurfaceNetMaker::take(SurfaceTiles::Notes* notes)
{
    forPointsIn(m_whole, [&](const SurfacePoint& p) { m_new.push_back(p); });
    m_net.insert(m_new);
    m_new.clear();
    takeHull();
    do {
        m_net.insert(m_new);
        m_new.clear();
        takeForCircles();
    } while (!m_new.empty());
    if (notes) {
        notes->whole = m_whole;
        notes->far = m_far;
        notes->discs = std::move(m_discs);
        notes->needsHull = m_needsHull;
        notes->hull = std::move(m_hull);
    }
    return {Triangulation(std::move(m_net)), m_tiles.m_squaredReach};
}

bool SurfaceNetMaker::touches(const std::array<std::uint32_t, 3>& corners) const noexcept
{
    std::array<std::array<double, 2>, 3> v{};
    RawRect rect{INFINITY, INFINITY, -INFINITY, -INFINITY};
    for (std::size_t i = 0; i < 3; ++i) {
        v[i] = {double(m_net.vertex(corners[i]).x), double(m_net.vertex(corners[i]).y)};
        rect = {std::min(rect.minX, v[i][0]), std::min(rect.minY, v[i][1]), std::max(rect.maxX, v[i][0]),
                std::max(rect.maxY, v[i][1])};
    }
    if (!rect.meets(m_box)) return false;
    for (std::size_t i = 0; i < 3; ++i) {
        const auto &a = v[i], &b = v[(i + 1) % 3];
        if (sideOf(a, b, m_box.minX, m_box.minY) < 0 && sideOf(a, b, m_box.maxX, m_box.minY) < 0 &&
            sideOf(a, b, m_box.minX, m_box.maxY) < 0 && sideOf(a, b, m_box.maxX, m_box.maxY) < 0)
            return false;
    }
    return true;
}

void SurfaceNetMaker::takeForCircles()
{
    m_discs.clear();
    const PlaneMetric& metric = m_tiles.m_metric;
    for (std::size_t t = 0; t < m_net.size(); ++t) {
        if (m_net.isGhost(t)) continue;
        const std::array<std::uint32_t, 3> c = m_net.corners(t);
        if (!touches(c)) continue;
        const RawDisc disc = circleOf(m_net.vertex(c[0]), m_net.vertex(c[1]), m_net.vertex(c[2]), metric);
        const RawRect about = commonOf(rectOf(disc, metric), m_far);
        if (m_whole.holds(about)) continue;
        m_discs.push_back(disc);
        const std::uint64_t key = keyOf(c);
        if (m_empty.contains(key)) continue;
        // Of each tile the deepest one, of those nearby if they have any: circles are smaller then.
        const double width = m_box.maxX - m_box.minX, height = m_box.maxY - m_box.minY;
        const std::size_t before = m_new.size();
        for (double sides = 0.5; m_new.size() == before; sides *= 4) {
            const RawRect near = commonOf(about, m_box.grown(sides * width, sides * height));
            m_tiles.forTilesIn(near, [&](std::size_t tile) {
                if (m_whole.holds(m_tiles.m_boxes[tile]) ||
                    squaredGap(m_tiles.m_boxes[tile], disc.x, disc.y, metric) > disc.squaredRadius)
                    return;
                double least = disc.squaredRadius;
                SurfacePoint deepest;
                bool found = false;
                for (const std::uint32_t index : m_tiles.m_points[tile]) {
                    const double dx = m_tiles.m_axes[0][index] - disc.x, dy = m_tiles.m_axes[1][index] - disc.y;
                    const double squared = metric.x * dx * dx + metric.y * dy * dy;
                    if (squared > least) continue;
                    const SurfacePoint p = m_tiles.point(index);
                    if (!m_far.holds(p.x, p.y) || isTaken(p)) continue;
                    least = squared;
                    deepest = p;
                    found = true;
                }
                if (!found) return;
                m_new.push_back(deepest);
                m_extra.insert(deepest.index);
            });
            if (near.holds(about)) break;
        }
        if (m_new.size() == before && key != 0) m_empty.insert(key);
    }
}

void SurfaceNetMaker::hullOf(std::vector<std::array<double, 2>>& hull) const
{
    hull.clear();
    std::vector<std::array<std::uint32_t, 2>> edges;
    for (std::size_t t = 0; t < m_net.size(); ++t) {
        const std::array<std::uint32_t, 3> c = m_net.corners(t);
        for (std::size_t i = 0; i < 3; ++i)
            if (c[i] == Delaunay::kNone) edges.push_back({c[(i + 2) % 3], c[(i + 1) % 3]});
    }
    if (edges.empty()) return;
    std::sort(edges.begin(), edges.end());
    std::uint32_t at = edges[0][0];
    for (std::size_t n = 0; n < edges.size(); ++n) {
        hull.push_back({double(m_net.vertex(at).x), double(m_net.vertex(at).y)});
        at = (*std::lower_bound(edges.begin(), edges.end(), std::array<std::uint32_t, 2>{at, 0}))[1];
    }
}

void SurfaceNetMaker::takeHull()
{
    std::vector<std::array<double, 2>> own;
    hullOf(own);
    if (isInHull(own, m_box)) return;

    // the outermost points of each tile, by eight directions
    const auto outermostIn = [&](const RawRect& rect) {
        std::vector<SurfacePoint> outermost;
        m_tiles.forTilesIn(rect, [&](std::size_t tile) {
            std::array<double, 8> most{};
            most.fill(-INFINITY);
            std::array<SurfacePoint, 8> farthest{};
            for (const std::uint32_t index : m_tiles.m_points[tile]) {
                const SurfacePoint p = m_tiles.point(index);
                if (!rect.holds(p.x, p.y)) continue;
                const double x = p.x, y = p.y;
                const std::array<double, 8> along{x, x + y, y, y - x, -x, -x - y, -y, x - y};
                for (std::size_t i = 0; i < 8; ++i)
                    if (along[i] > most[i]) {
                        most[i] = along[i];
                        farthest[i] = p;
                    }
            }
            if (most[0] != -INFINITY) outermost.insert(outermost.end(), farthest.begin(), farthest.end());
        });
        return convexHull(std::move(outermost));
    };
    const auto placesOf = [](std::span<const SurfacePoint> points) {
        std::vector<std::array<double, 2>> places;
        places.reserve(points.size());
        for (const SurfacePoint& p : points) places.push_back({double(p.x), double(p.y)});
        return places;
    };
    const auto takeAll = [&](std::span<const SurfacePoint> points) {
        for (const SurfacePoint& p : points)
            if (!isTaken(p) && m_extra.insert(p.index).second) m_new.push_back(p);
    };

    // B is mostly within the hull of points not far off, and then that will do.
    const double width = m_box.maxX - m_box.minX, height = m_box.maxY - m_box.minY;
    for (const double sides : {0.5, 2.0, 8.0}) {
        const RawRect near = commonOf(m_box.grown(sides * width, sides * height), m_far);
        const std::vector<SurfacePoint> outer = outermostIn(near);
        if (!isInHull(placesOf(outer), m_box)) continue;
        takeAll(outer);
        return;
    }

    m_needsHull = true;
    std::vector<SurfacePoint> outer = outermostIn(m_far);
    const std::vector<std::array<double, 2>> coarse = placesOf(outer);
    m_tiles.forTilesIn(m_far, [&](std::size_t tile) {
        if (isInHull(coarse, m_tiles.m_boxes[tile])) return;
        for (const std::uint32_t index : m_tiles.m_points[tile]) {
            const SurfacePoint p = m_tiles.point(index);
            if (m_far.holds(p.x, p.y) && !isInHull(coarse, p.x, p.y)) outer.push_back(p);
        }
    });
    outer = convexHull(std::move(outer));
    m_hull = placesOf(outer);
    takeAll(outer);
}

}  // namespace punctum
