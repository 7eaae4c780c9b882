// SPDX-License-Identifier: MIT
#include "core/surface/VolumeBase.h"

#include "core/Error.h"
#include "core/surface/SurfaceProbe.h"
#include "core/task/Progress.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace punctum
{

namespace
{

constexpr std::array<std::string_view, 5> kBaseNames{"outline", "lowest", "plane", "height", "surface"};
constexpr double kLeastPlaces = 64, kMostPlaces = 200000;  ///< along the whole edge, but for its corners
constexpr double kHeightSteps = 1 << 30;                   ///< that the range of heights is told in

double lengthOf(const glm::dvec2& raw, const SurfaceTiles& tiles)
{
    return std::hypot(raw.x * tiles.steps()[0], raw.y * tiles.steps()[1]);
}

double edgeOf(std::span<const Ring> rings, const SurfaceTiles& tiles)
{
    double length = 0;
    for (const Ring& ring : rings)
        for (std::size_t k = 0, before = ring.size() - 1; k < ring.size(); before = k++)
            length += lengthOf(ring[k] - ring[before], tiles);
    return length;
}

/// Mean distance of the surface's points from each other in and about the rings.
double spacingAbout(std::span<const Ring> rings, const SurfaceTiles& tiles)
{
    RawRect about{INFINITY, INFINITY, -INFINITY, -INFINITY};
    for (const Ring& ring : rings)
        for (const glm::dvec2& p : ring)
            about = {std::min(about.minX, p.x), std::min(about.minY, p.y), std::max(about.maxX, p.x),
                     std::max(about.maxY, p.y)};
    double area = 0;
    std::size_t points = 0;
    tiles.forTilesIn(about, [&](std::size_t t) {
        if (tiles.points(t).empty()) return;
        const RawRect& box = tiles.box(t);
        area += (box.maxX - box.minX) * tiles.steps()[0] * (box.maxY - box.minY) * tiles.steps()[1];
        points += tiles.points(t).size();
    });
    return points == 0 ? 0 : std::sqrt(area / double(points));
}

}  // namespace

std::string_view nameOf(VolumeBase base) noexcept
{
    return kBaseNames[std::size_t(base)];
}

std::optional<VolumeBase> volumeBaseOf(std::string_view name) noexcept
{
    const auto found = std::find(kBaseNames.begin(), kBaseNames.end(), name);
    if (found == kBaseNames.end()) return std::nullopt;
    return VolumeBase(found - kBaseNames.begin());
}

EdgeBase::EdgeBase(VolumeBase kind, std::span<const Ring> rings, const SurfaceTiles& tiles, Progress& progress)
{
    const std::vector<Place> places = placesAlong(rings, tiles, progress);
    if (places.size() < 3) throw Error("There is no surface along the outline.");
    const auto least =
        std::min_element(places.begin(), places.end(), [](const Place& a, const Place& b) { return a.z < b.z; });
    m_z = least->z;
    if (kind == VolumeBase::Plane) {
        fitPlane(places, tiles);
        m_pointsWorth = std::max(1.0, m_length / m_spacing);
    } else if (kind == VolumeBase::Outline) {
        triangulate(places, tiles, progress);
        m_pointsWorth = worthOfNet(places, rings);
    }
}

std::vector<EdgeBase::Place> EdgeBase::placesAlong(std::span<const Ring> rings, const SurfaceTiles& tiles,
                                                   Progress& progress)
{
    const double whole = edgeOf(rings, tiles);
    if (!(whole > 0)) return {};
    m_spacing = spacingAbout(rings, tiles);
    const double step = std::clamp(m_spacing / 2, whole / kMostPlaces, whole / kLeastPlaces);
    std::vector<Place> places;
    SurfaceProbe probe(tiles);
    for (const Ring& ring : rings)
        for (std::size_t k = 0; k < ring.size(); ++k) {
            const glm::dvec2 from = ring[k], edge = ring[(k + 1) % ring.size()] - from;
            const double length = lengthOf(edge, tiles);
            const auto parts = std::size_t(std::max(1.0, std::ceil(length / step)));
            for (std::size_t part = 0; part < parts; ++part) {
                progress.check();
                // whole steps, of which nets are made
                const glm::dvec2 at = from + edge * (double(part) / double(parts));
                const double x = std::round(at.x), y = std::round(at.y);
                const double share = length / double(parts);
                const std::optional<double> z = probe.at(x, y);
                (z ? m_length : m_lacking) += share;
                if (z) places.push_back({x, y, *z, share});
            }
        }
    return places;
}

/// Least squares, each place by the length for which it stands. Places on one line make a plane that is level
/// across the line.
void EdgeBase::fitPlane(const std::vector<Place>& places, const SurfaceTiles& tiles)
{
    double x = 0, y = 0, z = 0;
    for (const Place& p : places) {
        x += p.length / m_length * p.x;
        y += p.length / m_length * p.y;
        z += p.length / m_length * p.z;
    }
    double xx = 0, xy = 0, yy = 0, xz = 0, yz = 0;
    for (const Place& p : places) {
        const double dx = (p.x - x) * tiles.steps()[0], dy = (p.y - y) * tiles.steps()[1], dz = p.z - z;
        xx += p.length * dx * dx;
        xy += p.length * dx * dy;
        yy += p.length * dy * dy;
        xz += p.length * dx * dz;
        yz += p.length * dy * dz;
    }
    m_x = x;
    m_y = y;
    m_z = z;
    const double determinant = xx * yy - xy * xy;
    if (!(determinant > 1e-9 * (xx + yy) * (xx + yy))) throw Error("The outline encloses no area.");
    m_slopeX = (xz * yy - yz * xy) / determinant * tiles.steps()[0];
    m_slopeY = (yz * xx - xz * xy) / determinant * tiles.steps()[1];
}

void EdgeBase::triangulate(const std::vector<Place>& places, const SurfaceTiles& tiles, const Progress& progress)
{
    double most = m_z;
    for (const Place& p : places) most = std::max(most, p.z);
    m_step = most > m_z ? (most - m_z) / kHeightSteps : 1.0;
    std::vector<SurfacePoint> points;
    points.reserve(places.size());
    for (const Place& p : places)
        points.push_back({std::int32_t(p.x), std::int32_t(p.y), std::int32_t(std::lround((p.z - m_z) / m_step)),
                          std::uint32_t(points.size())});
    m_net = Triangulation(points, tiles.metric(), Delaunay::Keep::Lowest, &progress);
    if (m_net.empty()) throw Error("The outline encloses no area.");
}

/// The base's mean is a weighted one of the places' heights: a third of each triangle's area is each of its
/// corners'. Places that are nearer to each other than points of the surface have the error of one point.
double EdgeBase::worthOfNet(const std::vector<Place>& places, std::span<const Ring> rings) const
{
    std::vector<double> weights(places.size(), 0.0);
    double whole = 0;
    const auto vertices = m_net.vertices();
    for (const auto& corners : m_net.triangles()) {
        Ring triangle;
        for (const std::uint32_t v : corners) triangle.emplace_back(vertices[v].x, vertices[v].y);
        if (!isInside(rings, (triangle[0] + triangle[1] + triangle[2]) / 3.0)) continue;
        const double area = signedArea(triangle);
        whole += area;
        for (const std::uint32_t v : corners) weights[vertices[v].index] += area / 3;
    }
    double squares = 0, together = 0, length = 0;
    for (std::size_t k = 0; k < places.size(); ++k) {
        together += weights[k];
        length += places[k].length;
        if (length < m_spacing && k + 1 < places.size()) continue;
        squares += together * together;
        together = length = 0;
    }
    return squares > 0 ? std::max(1.0, whole * whole / squares) : 1.0;
}

double EdgeBase::height(double x, double y, std::uint32_t& near) const noexcept
{
    if (!m_net.empty()) return m_z + m_step * m_net.heightNear(x, y, near).value_or(0);
    return m_z + m_slopeX * (x - m_x) + m_slopeY * (y - m_y);
}

}  // namespace punctum
