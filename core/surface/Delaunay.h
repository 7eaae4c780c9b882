// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace punctum
{

class Progress;

/// A point that a surface is made of, in raw coordinates of its cloud.
struct SurfacePoint {
    std::int32_t x = 0, y = 0, z = 0;
    std::uint32_t index = 0;  ///< whatever the caller likes to know it by: that of the cloud's point
    friend bool operator==(const SurfacePoint&, const SurfacePoint&) = default;
};

/// How long raw steps along X and Y are beside each other: squared lengths are x * dx^2 + y * dy^2. The weights are
/// whole, so that what is asked of them is answered exactly; where the ratio of the steps is not that of small
/// whole numbers (degrees), they come within a millionth or so of it.
struct PlaneMetric {
    std::uint32_t x = 1, y = 1;  ///< 1 to kMost
    static constexpr std::uint32_t kMost = 1u << 20;
    /// Of steps that are so long along X and Y.
    static PlaneMetric of(double stepX, double stepY);
    friend bool operator==(const PlaneMetric&, const PlaneMetric&) = default;
};

/// The Delaunay triangulation of points by X and Y, while it grows. Points are inserted one by one along a Hilbert
/// curve, in rounds of doubling size (Amenta, Choi and Rote 2003), by edge flips (Lawson 1977), with a vertex at
/// infinity beyond the hull.
///
/// Exact: all decisions are those of exact arithmetic on the raw integers, whatever their size (doubles where their
/// error bound allows, else integers of 128 bits). Unique: where four points lie on one circle, the diagonal is the
/// one that comes of lifting points by infinitely little, the more the later they are by (x, y) (Edelsbrunner and
/// Muecke 1990; Devillers and Teillaud 2011). So the triangles are a function of the set of places alone, not of
/// the order of insertion or of what else was cut away far from them, on grids too.
///
/// A value; not to be used by two threads at once.
class Delaunay
{
public:
    static constexpr std::uint32_t kNone = UINT32_MAX;
    /// Which of several points with the same X and Y is the vertex; of those, the one of least index.
    enum class Keep { Lowest, Highest };

    explicit Delaunay(PlaneMetric metric = {}, Keep keep = Keep::Lowest) : m_metric(metric), m_keep(keep) {}

    /// Some 0.5 to 1 us a point. With progress: throws Cancelled, after which it is of no use.
    void insert(std::span<const SurfacePoint> points, const Progress* progress = nullptr);

    /// Triangles, with those at infinity (isGhost()); none as long as all points are on one line.
    std::size_t size() const noexcept { return m_corners.size() / 3; }
    /// Counterclockwise; kNone is the vertex at infinity.
    std::array<std::uint32_t, 3> corners(std::size_t triangle) const noexcept
    {
        return {m_corners[3 * triangle], m_corners[3 * triangle + 1], m_corners[3 * triangle + 2]};
    }
    bool isGhost(std::size_t triangle) const noexcept
    {
        return m_corners[3 * triangle] == kNone || m_corners[3 * triangle + 1] == kNone ||
               m_corners[3 * triangle + 2] == kNone;
    }
    const SurfacePoint& vertex(std::uint32_t v) const noexcept { return m_vertices[v]; }
    const PlaneMetric& metric() const noexcept { return m_metric; }

    /// Twice the signed area of abc: positive when counterclockwise. Exact.
    static int orientation(const SurfacePoint& a, const SurfacePoint& b, const SurfacePoint& c) noexcept;
    /// Positive when p is inside of the circle (by the metric an ellipse) through a, b and c, which are
    /// counterclockwise; 0 when on it. Exact.
    int inCircle(const SurfacePoint& a, const SurfacePoint& b, const SurfacePoint& c,
                 const SurfacePoint& p) const noexcept;

private:
    friend class Triangulation;

    bool begin(std::span<const std::uint32_t> order);
    void insertVertex(std::uint32_t v);
    std::uint32_t locate(const SurfacePoint& p) const noexcept;
    bool conflicts(std::uint32_t triangle, const SurfacePoint& p) const noexcept;
    void setTriangle(std::uint32_t t, std::uint32_t a, std::uint32_t b, std::uint32_t c) noexcept;
    void join(std::uint32_t edge, std::uint32_t other) noexcept;
    void keepOne(std::uint32_t kept, std::uint32_t other) noexcept;

    PlaneMetric m_metric;
    Keep m_keep;
    std::vector<SurfacePoint> m_vertices;    ///< some of which no triangle has: doubles of others
    std::vector<std::uint32_t> m_corners;    ///< three a triangle
    std::vector<std::uint32_t> m_twins;      ///< of edge 3 t + i, from corner i to the next: that of the other side
    std::vector<std::uint32_t> m_waiting;    ///< vertices, as long as all are on one line
    std::vector<std::uint32_t> m_unchecked;  ///< edges that may have to be flipped
    std::uint32_t m_last = 0;                ///< the triangle where the next search begins
};

/// The corners of the convex hull of these points, counterclockwise, each place once (Andrew 1979); those that
/// differ where they are fewer than three, or the ends of a line. Of points in one place the one of least index.
/// Exact.
std::vector<SurfacePoint> convexHull(std::vector<SurfacePoint> points);

}  // namespace punctum
