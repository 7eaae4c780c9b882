// SPDX-License-Identifier: MIT
#include "core/surface/Delaunay.h"

#include "core/surface/HilbertOrder.h"
#include "core/task/Progress.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

namespace punctum
{

namespace
{

__extension__ using NetWide = __int128;

constexpr std::uint32_t following(std::uint32_t edge) noexcept
{
    return edge % 3 == 2 ? edge - 2 : edge + 1;
}
constexpr std::uint32_t preceding(std::uint32_t edge) noexcept
{
    return edge % 3 == 0 ? edge + 2 : edge - 1;
}

template <typename T>
int signOf(T value) noexcept
{
    return value > 0 ? 1 : value < 0 ? -1 : 0;
}

/// From p.
struct Offset {
    std::int64_t x, y;  ///< 33 bits
    Offset(const SurfacePoint& to, const SurfacePoint& p) noexcept
        : x(std::int64_t(to.x) - p.x), y(std::int64_t(to.y) - p.y)
    {
    }
};

NetWide crossOf(const Offset& a, const Offset& b) noexcept
{
    return NetWide(a.x) * b.y - NetWide(a.y) * b.x;
}

/// The sign of the determinant in whole numbers: crosses have 66 bits with their sign, lifts 86. Lifts are taken in
/// two halves, so that all sums fit into 128 bits.
int exactInCircle(const Offset& a, const Offset& b, const Offset& c, const PlaneMetric& metric) noexcept
{
    constexpr int kHalf = 44;
    NetWide high = 0, low = 0;
    const auto add = [&](const Offset& of, const NetWide cross) {
        const NetWide lift = NetWide(of.x) * of.x * metric.x + NetWide(of.y) * of.y * metric.y;
        high += (lift >> kHalf) * cross;
        low += (lift & ((NetWide(1) << kHalf) - 1)) * cross;
    };
    add(a, crossOf(b, c));
    add(b, crossOf(c, a));
    add(c, crossOf(a, b));
    high += low >> kHalf;  // rounded down, so that the rest is not negative
    const NetWide rest = low & ((NetWide(1) << kHalf) - 1);
    return high != 0 ? signOf(high) : signOf(rest);
}

bool laterInPlane(const SurfacePoint& a, const SurfacePoint& b) noexcept
{
    return a.x > b.x || (a.x == b.x && a.y > b.y);
}

/// Points of a batch come in rounds of doubling size, each a random half of what is left.
int roundOf(std::size_t i) noexcept
{
    std::uint64_t h = (i + 1) * 0x9E3779B97F4A7C15u;
    h ^= h >> 32;
    h *= 0xD6E8FEB86659FD93u;
    h ^= h >> 32;
    return std::countr_zero(h | (std::uint64_t(1) << 40));
}

}  // namespace

PlaneMetric PlaneMetric::of(double stepX, double stepY)
{
    if (!(stepX > 0) || !(stepY > 0) || !std::isfinite(stepX) || !std::isfinite(stepY)) return {};
    // the last convergent of the ratio's continued fraction whose parts are small enough
    const double ratio = (stepX / stepY) * (stepX / stepY);
    if (ratio >= double(kMost)) return {kMost, 1};
    if (ratio <= 1.0 / double(kMost)) return {1, kMost};
    double rest = ratio;
    std::uint64_t p = 1, q = 0, lastP = 0, lastQ = 1;
    for (int i = 0; i < 40; ++i) {
        const double whole = std::floor(rest);
        if (whole > double(kMost)) break;
        const std::uint64_t w = std::uint64_t(whole);
        const std::uint64_t nextP = w * p + lastP, nextQ = w * q + lastQ;
        if (nextP > kMost || nextQ > kMost) break;
        lastP = std::exchange(p, nextP);
        lastQ = std::exchange(q, nextQ);
        const double part = rest - whole;
        // nearer than the ratio itself is known
        if (part < 1e-12 || std::abs(double(p) / double(q) - ratio) <= 1e-12 * ratio) break;
        rest = 1.0 / part;
    }
    if (p == 0 || q == 0) return {1, kMost};  // a ratio near to the least: its first convergent is 0
    return {std::uint32_t(p), std::uint32_t(q)};
}

int Delaunay::orientation(const SurfacePoint& a, const SurfacePoint& b, const SurfacePoint& c) noexcept
{
    const Offset u(b, a), v(c, a);
    // the sum of two products of 33 bits each may need more than 64
    constexpr std::int64_t kShort = std::int64_t(1) << 30;
    const auto isShort = [](std::int64_t d) { return d < kShort && d > -kShort; };
    if (isShort(u.x) && isShort(u.y) && isShort(v.x) && isShort(v.y)) [[likely]]
        return signOf(u.x * v.y - u.y * v.x);
    return signOf(crossOf(u, v));
}

int Delaunay::inCircle(const SurfacePoint& a, const SurfacePoint& b, const SurfacePoint& c,
                       const SurfacePoint& p) const noexcept
{
    const Offset oa(a, p), ob(b, p), oc(c, p);
    // differences have 33 bits, and are exact as doubles; so are they times a weight of 20 bits
    const double ax = double(oa.x), ay = double(oa.y), bx = double(ob.x), by = double(ob.y), cx = double(oc.x),
                 cy = double(oc.y);
    const double wx = double(m_metric.x), wy = double(m_metric.y);
    const double bc1 = bx * cy, bc2 = by * cx, ca1 = cx * ay, ca2 = cy * ax, ab1 = ax * by, ab2 = ay * bx;
    const double liftA = wx * ax * ax + wy * ay * ay, liftB = wx * bx * bx + wy * by * by,
                 liftC = wx * cx * cx + wy * cy * cy;
    const double sum = liftA * (bc1 - bc2) + liftB * (ca1 - ca2) + liftC * (ab1 - ab2);
    const double most = liftA * (std::abs(bc1) + std::abs(bc2)) + liftB * (std::abs(ca1) + std::abs(ca2)) +
                        liftC * (std::abs(ab1) + std::abs(ab2));
    // Shewchuk 1997, figure 8: (10 + 96 e) e for differences that are rounded too, e = 2^-53
    if (std::abs(sum) > most * 1.12e-15) return signOf(sum);
    if (most <= 0x1p53) return signOf(sum);  // all that was computed is whole, and small enough to be exact
    return exactInCircle(oa, ob, oc, m_metric);
}

bool Delaunay::conflicts(std::uint32_t triangle, const SurfacePoint& p) const noexcept
{
    const std::uint32_t* v = &m_corners[3 * std::size_t(triangle)];
    for (std::size_t i = 0; i < 3; ++i) {
        if (v[i] != kNone) continue;
        // beyond the hull's edge, or on it
        const SurfacePoint &a = m_vertices[v[(i + 1) % 3]], &b = m_vertices[v[(i + 2) % 3]];
        const int side = orientation(a, b, p);
        if (side != 0) return side > 0;
        return laterInPlane(a, b) ? laterInPlane(a, p) && laterInPlane(p, b)
                                  : laterInPlane(b, p) && laterInPlane(p, a);
    }
    const SurfacePoint &a = m_vertices[v[0]], &b = m_vertices[v[1]], &c = m_vertices[v[2]];
    const int side = inCircle(a, b, c, p);
    if (side != 0) [[likely]]
        return side > 0;
    // On one circle: the latest of the four is lifted most. When that is p, p goes outside; when it is a corner, p
    // is inside where it is on the corner's opposite edge's inner side.
    const SurfacePoint* latest = &p;
    for (const SurfacePoint* q : {&a, &b, &c})
        if (laterInPlane(*q, *latest)) latest = q;
    if (latest == &a) return orientation(p, b, c) > 0;
    if (latest == &b) return orientation(a, p, c) > 0;
    if (latest == &c) return orientation(a, b, p) > 0;
    return false;
}

void Delaunay::setTriangle(std::uint32_t t, std::uint32_t a, std::uint32_t b, std::uint32_t c) noexcept
{
    std::uint32_t* v = &m_corners[3 * std::size_t(t)];
    v[0] = a;
    v[1] = b;
    v[2] = c;
}

void Delaunay::join(std::uint32_t edge, std::uint32_t other) noexcept
{
    m_twins[edge] = other;
    m_twins[other] = edge;
}

void Delaunay::keepOne(std::uint32_t kept, std::uint32_t other) noexcept
{
    SurfacePoint& a = m_vertices[kept];
    const SurfacePoint& b = m_vertices[other];
    const bool better = m_keep == Keep::Lowest ? b.z < a.z : b.z > a.z;
    if (better || (b.z == a.z && b.index < a.index)) a = b;
}

std::uint32_t Delaunay::locate(const SurfacePoint& p) const noexcept
{
    std::uint32_t t = m_last;
    for (std::uint32_t i = 0; i < 3; ++i)
        if (m_corners[3 * t + i] == kNone) {  // into the triangle at the hull's edge
            t = m_twins[following(3 * t + i)] / 3;
            break;
        }
    const auto isBeyond = [&](std::uint32_t edge) {
        return orientation(m_vertices[m_corners[edge]], m_vertices[m_corners[following(edge)]], p) < 0;
    };
    std::uint32_t edge = 3 * t;
    if (!isBeyond(edge)) {
        edge = following(edge);
        if (!isBeyond(edge)) {
            edge = following(edge);
            if (!isBeyond(edge)) return t;
        }
    }
    // From triangle to triangle across an edge beyond which p lies: never in a circle, since they are Delaunay's
    // (De Floriani, Falcidieno, Nagy and Pienovi 1991).
    for (;;) {
        edge = m_twins[edge];
        const std::uint32_t next = following(edge), last = preceding(edge);
        if (m_corners[last] == kNone) return edge / 3;
        if (isBeyond(next)) {
            edge = next;
        } else if (isBeyond(last)) {
            edge = last;
        } else {
            return edge / 3;
        }
    }
}

void Delaunay::insertVertex(std::uint32_t v)
{
    const SurfacePoint p = m_vertices[v];
    const std::uint32_t t = locate(p);
    m_last = t;
    const std::array<std::uint32_t, 3> old = corners(t);
    for (const std::uint32_t corner : old)
        if (corner != kNone && m_vertices[corner].x == p.x && m_vertices[corner].y == p.y) {
            keepOne(corner, v);
            return;
        }
    // Three triangles around v, in each of which it is the last corner. A thin one, where v is on an edge, does not
    // stay.
    const std::uint32_t second = std::uint32_t(size()), third = second + 1;
    const std::array<std::uint32_t, 3> outer{m_twins[3 * t], m_twins[3 * t + 1], m_twins[3 * t + 2]};
    m_corners.resize(m_corners.size() + 6);
    m_twins.resize(m_twins.size() + 6);
    setTriangle(t, old[0], old[1], v);
    setTriangle(second, old[1], old[2], v);
    setTriangle(third, old[2], old[0], v);
    join(3 * t, outer[0]);
    join(3 * second, outer[1]);
    join(3 * third, outer[2]);
    join(3 * t + 1, 3 * second + 2);
    join(3 * second + 1, 3 * third + 2);
    join(3 * third + 1, 3 * t + 2);
    m_unchecked.assign({3 * t, 3 * second, 3 * third});
    while (!m_unchecked.empty()) {
        const std::uint32_t edge = m_unchecked.back();  // from a to b, with v opposite
        m_unchecked.pop_back();
        const std::uint32_t beyond = m_twins[edge], near = edge / 3, far = beyond / 3;
        if (!conflicts(far, p)) continue;
        const std::uint32_t a = m_corners[edge], b = m_corners[edge + 1], q = m_corners[preceding(beyond)];
        const std::uint32_t besideA = m_twins[following(beyond)], besideB = m_twins[preceding(beyond)];
        const std::uint32_t acrossB = m_twins[edge + 1];
        setTriangle(near, a, q, v);
        setTriangle(far, q, b, v);
        join(3 * near, besideA);
        join(3 * far, besideB);
        join(3 * far + 1, acrossB);
        join(3 * far + 2, 3 * near + 1);
        m_unchecked.push_back(3 * near);
        m_unchecked.push_back(3 * far);
    }
}

bool Delaunay::begin(std::span<const std::uint32_t> order)
{
    // three that are not on one line, then the others; false as long as there are none
    m_waiting.insert(m_waiting.end(), order.begin(), order.end());
    const auto at = [&](std::size_t i) -> const SurfacePoint& { return m_vertices[m_waiting[i]]; };
    std::size_t second = 1;
    while (second < m_waiting.size() && at(second).x == at(0).x && at(second).y == at(0).y) ++second;
    std::size_t third = second + 1;
    while (third < m_waiting.size() && orientation(at(0), at(second), at(third)) == 0) ++third;
    if (third >= m_waiting.size()) return false;
    const std::uint32_t a = m_waiting[0];
    std::uint32_t b = m_waiting[second], c = m_waiting[third];
    m_waiting.erase(m_waiting.begin() + std::ptrdiff_t(third));
    m_waiting.erase(m_waiting.begin() + std::ptrdiff_t(second));
    m_waiting.erase(m_waiting.begin());
    if (orientation(m_vertices[a], m_vertices[b], m_vertices[c]) < 0) std::swap(b, c);
    m_corners.resize(12);
    m_twins.resize(12);
    setTriangle(0, a, b, c);
    setTriangle(1, b, a, kNone);
    setTriangle(2, c, b, kNone);
    setTriangle(3, a, c, kNone);
    join(0, 3);
    join(1, 6);
    join(2, 9);
    join(4, 11);  // a to infinity and back
    join(7, 5);   // b
    join(10, 8);  // c
    m_last = 0;
    return true;
}

void Delaunay::insert(std::span<const SurfacePoint> points, const Progress* progress)
{
    const std::vector<std::uint32_t> along = hilbertOrder(points);
    const std::uint32_t first = std::uint32_t(m_vertices.size());
    m_vertices.reserve(m_vertices.size() + points.size());
    for (const std::uint32_t i : along) m_vertices.push_back(points[i]);

    // a small batch is all in the cache, and is inserted as it comes
    constexpr std::size_t kSmall = 64;
    constexpr int kRounds = 20;
    std::array<std::size_t, kRounds + 2> starts{};
    std::vector<std::uint32_t> order(along.size());
    const auto round = [&](std::size_t i) {
        return along.size() <= kSmall ? kRounds : kRounds - std::min(kRounds, roundOf(i));
    };
    for (std::size_t i = 0; i < order.size(); ++i) ++starts[std::size_t(round(i)) + 1];
    for (std::size_t r = 1; r < starts.size(); ++r) starts[r] += starts[r - 1];
    for (std::size_t i = 0; i < order.size(); ++i)
        order[starts[std::size_t(round(i))]++] = first + std::uint32_t(i);

    m_corners.reserve(6 * (m_vertices.size() + 1));
    m_twins.reserve(6 * (m_vertices.size() + 1));
    if (m_corners.empty()) {
        if (!begin(order)) return;
        order = std::exchange(m_waiting, {});
    }
    for (std::size_t i = 0; i < order.size(); ++i) {
        if (progress && i % 4096 == 0) progress->check();
        insertVertex(order[i]);
    }
}

std::vector<SurfacePoint> convexHull(std::vector<SurfacePoint> points)
{
    std::sort(points.begin(), points.end(), [](const SurfacePoint& a, const SurfacePoint& b) {
        return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.index < b.index;
    });
    const auto samePlace = [](const SurfacePoint& a, const SurfacePoint& b) { return a.x == b.x && a.y == b.y; };
    points.erase(std::unique(points.begin(), points.end(), samePlace), points.end());
    if (points.size() < 3) return points;
    std::vector<SurfacePoint> hull;
    for (int chain = 0; chain < 2; ++chain) {
        const std::size_t first = hull.size();
        for (const SurfacePoint& p : points) {
            while (hull.size() >= first + 2 && Delaunay::orientation(hull[hull.size() - 2], hull.back(), p) <= 0)
                hull.pop_back();
            hull.push_back(p);
        }
        hull.pop_back();
        std::reverse(points.begin(), points.end());
    }
    return hull;
}

}  // namespace punctum
