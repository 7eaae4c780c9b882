// SPDX-License-Identifier: MIT
#pragma once

#include "core/surface/SurfaceTiles.h"

#include <unordered_set>

namespace punctum
{

/// Whether a place is inside of a convex polygon, counterclockwise, and not on its edge.
bool isInHull(std::span<const std::array<double, 2>> hull, double x, double y) noexcept;
/// The same of a whole rectangle.
bool isInHull(std::span<const std::array<double, 2>> hull, const RawRect& rect) noexcept;

/// Takes in points about a tile until its triangles are those of all ground points. Private to SurfaceTiles.
///
/// Why that is so: let B be the tile (grown as asked), R the reach, F all places within 2 R of B. The work ends
/// when (1) no circle about a triangle that touches B has points of F in it that were not taken in, and (2) B is
/// within the hull of what was taken in, or all points of F are. Let T be a triangle of all ground points that
/// touches B and has a circle of radius R or less. Its corners are in F. By (2) a place q of both T and B is in
/// some triangle t of what was taken in, whose circle by (1) has no corner of T in it, as T's has none of t. Of the
/// corners of both, t and T are then both Delaunay's at q, which are unique: t is T. Likewise a t that counts is
/// one of all points, since its circle is within F.
class SurfaceNetMaker
{
public:
    SurfaceNetMaker(const SurfaceTiles& tiles, std::size_t tile, double beyond);

    SurfaceNet take(SurfaceTiles::Notes* notes);

private:
    void takeForCircles();
    void takeHull();
    bool touches(const std::array<std::uint32_t, 3>& corners) const noexcept;
    bool isTaken(const SurfacePoint& p) const noexcept
    {
        return m_whole.holds(p.x, p.y) || m_extra.contains(p.index);
    }
    void hullOf(std::vector<std::array<double, 2>>& hull) const;
    template <typename F>
    void forPointsIn(const RawRect& rect, F&& f) const;

    const SurfaceTiles& m_tiles;
    RawRect m_box;    ///< B
    RawRect m_whole;  ///< all points in it were taken in
    RawRect m_far;    ///< F
    Delaunay m_net;
    std::unordered_set<std::uint32_t> m_extra;  ///< points beside those of m_whole
    std::vector<SurfacePoint> m_new;
    std::vector<RawDisc> m_discs;               ///< of the last takeForCircles()
    std::unordered_set<std::uint64_t> m_empty;  ///< triangles whose circle had nothing new in it, by their corners
    bool m_needsHull = false;                   ///< B is not within the hull of the first points
    std::vector<std::array<double, 2>> m_hull;  ///< of all points of F then
};

}  // namespace punctum
