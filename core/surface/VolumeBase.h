// SPDX-License-Identifier: MIT
#pragma once

#include "core/surface/Polygon.h"
#include "core/surface/SurfaceTiles.h"
#include "core/surface/Triangulation.h"

#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace punctum
{

class Progress;

/// What the surface in an area is compared with.
enum class VolumeBase {
    Outline,  ///< the surface through the heights along the area's edge, triangulated
    Lowest,   ///< the least of these heights
    Plane,    ///< the plane that fits them best
    Height,   ///< a height
    Surface,  ///< another surface
};

/// "outline", and back.
std::string_view nameOf(VolumeBase base) noexcept;
std::optional<VolumeBase> volumeBaseOf(std::string_view name) noexcept;

/// A base that comes of the surface's heights along the edge of an area, in raw coordinates. The edge is looked at
/// in steps of half the points' spacing: what lies between two corners counts as the ground is there, not as a
/// straight line from one to the other. Immutable.
class EdgeBase
{
public:
    /// Outline, Lowest or Plane. `rings` are raw. Throws Error where the edge has no surface or no area in it, and
    /// Cancelled.
    EdgeBase(VolumeBase kind, std::span<const Ring> rings, const SurfaceTiles& tiles, Progress& progress);

    /// Height (raw) at a place (raw) in the area; `near` as in Triangulation.
    double height(double x, double y, std::uint32_t& near) const noexcept;
    /// Length of the edge where there is surface, and where there is none; in units of true length.
    double length() const noexcept { return m_length; }
    double lacking() const noexcept { return m_lacking; }
    /// How many points of the surface the mean height of the base is as good as the mean of: those along the edge,
    /// but of Outline fewer, since some of them have large triangles.
    double pointsWorth() const noexcept { return m_pointsWorth; }

private:
    struct Place {
        double x = 0, y = 0, z = 0;  ///< raw
        double length = 0;           ///< of the edge for which it stands
    };
    std::vector<Place> placesAlong(std::span<const Ring> rings, const SurfaceTiles& tiles, Progress& progress);
    void fitPlane(const std::vector<Place>& places, const SurfaceTiles& tiles);
    void triangulate(const std::vector<Place>& places, const SurfaceTiles& tiles, const Progress& progress);
    double worthOfNet(const std::vector<Place>& places, std::span<const Ring> rings) const;

    double m_length = 0, m_lacking = 0;
    double m_spacing = 0;  ///< of the points of the surface
    double m_pointsWorth = 1;
    double m_x = 0, m_y = 0, m_z = 0;   ///< a place of the plane
    double m_slopeX = 0, m_slopeY = 0;  ///< of it, by raw steps
    Triangulation m_net;                ///< of Outline; heights in steps from m_z
    double m_step = 0;
};

}  // namespace punctum
