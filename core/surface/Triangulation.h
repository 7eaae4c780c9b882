// SPDX-License-Identifier: MIT
#pragma once

#include "core/surface/Delaunay.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace punctum
{

/// A finished Delaunay triangulation of points by X and Y, in compact arrays, to be asked for heights.
///
/// Example, heights of many places, which should come in an order in which near ones follow each other:
///     std::vector<SurfacePoint> ground;  // {x, y, z, index of the point}
///     const TrueLengths lengths = trueLengths(cloud);
///     const glm::dvec3 step = lengths.stretch * cloud.coordinates().scale;
///     const Triangulation net(ground, PlaneMetric::of(step.x, step.y));
///     std::uint32_t near = 0;            // where the search begins; each thread has its own
///     const std::optional<double> z = net.height(rawX[i], rawY[i], near);  // raw; none outside of the hull
///
/// Vertices are numbered along a Hilbert curve, not as they were given: SurfacePoint::index tells which is which.
/// Of points with the same X and Y one is kept, the lowest by preset. Points on one line, or fewer than three, make
/// no triangles. What is said of Delaunay (exact, unique) holds. Asking changes nothing: any thread.
class Triangulation
{
public:
    static constexpr std::uint32_t kNone = Delaunay::kNone;

    Triangulation() = default;
    /// Throws Cancelled where there is a progress.
    explicit Triangulation(std::span<const SurfacePoint> points, PlaneMetric metric = {},
                           Delaunay::Keep keep = Delaunay::Keep::Lowest, const Progress* progress = nullptr);
    /// Of a net that has grown to its end.
    explicit Triangulation(Delaunay&& grown);

    std::span<const SurfacePoint> vertices() const noexcept { return m_vertices; }
    /// Number of triangles.
    std::size_t size() const noexcept { return m_corners.size(); }
    bool empty() const noexcept { return m_corners.empty(); }
    /// Vertices of each triangle, counterclockwise.
    std::span<const std::array<std::uint32_t, 3>> triangles() const noexcept { return m_corners; }
    /// Neighbors of each triangle: i is on the other side of the edge from corner i to the next; kNone at the hull.
    std::span<const std::array<std::uint32_t, 3>> neighbors() const noexcept { return m_neighbors; }

    /// The triangle in which or on whose edge a place (raw; may lie between whole numbers) is; none outside of the
    /// hull. `near` is where the search begins (0 when nothing is known) and is set to where it ended, so that
    /// places that follow each other closely are found in a step or two; outside it is the triangle at the hull.
    std::optional<std::uint32_t> locate(double x, double y, std::uint32_t& near) const noexcept;
    /// Height (raw) of the surface: linear in each triangle, exactly that of the point at a vertex.
    std::optional<double> height(double x, double y, std::uint32_t& near) const noexcept;
    /// The same; outside of the hull that of the place of the hull that is nearest by the metric. None only where
    /// there are no triangles.
    std::optional<double> heightNear(double x, double y, std::uint32_t& near) const noexcept;
    /// Height of a triangle's plane at a place.
    double heightIn(std::uint32_t triangle, double x, double y) const noexcept;
    /// Rise of a triangle's plane by a raw step along X and along Y, in raw steps of Z.
    std::array<double, 2> slopeOf(std::uint32_t triangle) const noexcept;
    /// Squared radius of the circle through its corners, by the metric's measure.
    double squaredRadius(std::uint32_t triangle) const noexcept;
    const PlaneMetric& metric() const noexcept { return m_metric; }

private:
    struct Edge {
        std::uint32_t triangle = 0, side = 0;
    };

    Edge nextOnHull(Edge edge) const noexcept;
    Edge lastOnHull(Edge edge) const noexcept;

    std::vector<SurfacePoint> m_vertices;
    std::vector<std::array<std::uint32_t, 3>> m_corners, m_neighbors;
    PlaneMetric m_metric;
};

}  // namespace punctum
