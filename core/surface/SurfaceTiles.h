// SPDX-License-Identifier: MIT
#pragma once

#include "core/surface/Triangulation.h"

#include "core/cloud/PointCloud.h"
#include "core/cloud/Units.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace punctum
{

/// Rectangle of raw coordinates.
struct RawRect {
    double minX = 0, minY = 0, maxX = 0, maxY = 0;
    bool meets(const RawRect& o) const noexcept
    {
        return minX <= o.maxX && o.minX <= maxX && minY <= o.maxY && o.minY <= maxY;
    }
    bool holds(const RawRect& o) const noexcept
    {
        return minX <= o.minX && o.maxX <= maxX && minY <= o.minY && o.maxY <= maxY;
    }
    bool holds(double x, double y) const noexcept { return x >= minX && x <= maxX && y >= minY && y <= maxY; }
    RawRect grown(double x, double y) const noexcept { return {minX - x, minY - y, maxX + x, maxY + y}; }
};

/// Ellipse of raw coordinates: a circle by the metric.
struct RawDisc {
    double x = 0, y = 0;
    double squaredRadius = 0;  ///< by the metric
};

/// The triangulated surface in and about one tile.
struct SurfaceNet {
    Triangulation triangles;
    double squaredReach = 0;  ///< triangles about which there is a larger circle (squared radius) do not count

    /// Height (raw) of the surface in the tile; none where there is none. See Triangulation::height().
    std::optional<double> height(double x, double y, std::uint32_t& near) const noexcept;
    bool counts(std::uint32_t triangle) const noexcept { return triangles.squaredRadius(triangle) <= squaredReach; }

private:
    bool countsAbout(std::uint32_t triangle, std::size_t corner) const noexcept;
};

/// The ground of a cloud in square tiles, so that its surface can be triangulated piece by piece, by many threads,
/// with no seam: inside of a tile the triangles are exactly those of the triangulation of all ground points.
///
/// Tiles are the leaves of a quadtree over raw X and Y, each with some 1,500 points at most, whatever the density.
/// For each one, points beyond its edge are taken in until no other could change a triangle that touches it: until
/// no circle about such a triangle has points in it that were not taken in. That can go far where the ground has
/// gaps, so the surface has a reach: triangles about which there is a circle of a larger radius are no part of it.
/// Beyond the last ground points there is no surface.
///
/// Example, heights above ground of all points, tile by tile:
///     const SurfaceTiles tiles(cloud, ground, 0.0, progress);
///     tbb::parallel_for(std::size_t(0), tiles.size(), [&](std::size_t t) {
///         const SurfaceNet net = tiles.net(t);
///         std::uint32_t near = 0;
///         for (const std::uint32_t i : pointsOver[t])  // those with tiles.tileAt(x, y) == t
///             if (const auto z = net.height(x[i], y[i], near)) above[i] = rawZ[i] - *z;
///     });
///
/// Coordinates never change, so that everything but change() may be called by any threads at once, with no lock.
class SurfaceTiles
{
public:
    static constexpr std::size_t kMostPoints = 1536;

    /// Of the ground points `ground` (a set over the cloud; deleted points must not be in it). `reach` is in units
    /// of true length; 0: as fits, 100 m, or 25 times the spacing where that is more. In parallel; the same on any
    /// number of threads. Takes no lock but in trueLengths(). Throws Cancelled, and Error (more than 2^32 points).
    SurfaceTiles(const PointCloud& cloud, const PointSet& ground, double reach, Progress& progress);

    std::size_t size() const noexcept { return m_boxes.size(); }
    /// Tiles have no place in common, and together cover all points of the cloud.
    const RawRect& box(std::size_t tile) const noexcept { return m_boxes[tile]; }
    /// The tile of a place; none where there is none.
    std::optional<std::size_t> tileAt(double x, double y) const noexcept;
    /// Calls f(tile) for each tile that meets a rectangle.
    template <typename F>
    void forTilesIn(const RawRect& rect, F&& f) const
    {
        std::array<std::uint32_t, 4 * 34> stack{0};
        for (std::size_t depth = m_nodes.empty() ? 0 : 1; depth != 0;) {
            const Node& node = m_nodes[stack[--depth]];
            if (!node.box.meets(rect)) continue;
            if (node.children == 0) {
                f(std::size_t(node.tile));
            } else {
                for (std::uint32_t i = 4; i-- > 0;) stack[depth++] = node.children + i;
            }
        }
    }
    /// The ground points in a tile, in no particular order.
    std::span<const std::uint32_t> points(std::size_t tile) const noexcept { return m_points[tile]; }
    /// Ground points in all.
    std::size_t pointCount() const noexcept;

    /// The surface in a tile, and as far beyond its edges as `beyond` (a share of its side, less than 1/8) says.
    /// Some 2 ms.
    SurfaceNet net(std::size_t tile, double beyond = 0.0) const;

    /// Ground points that were none, and that are none any longer: those of `changed` are ground where `ground`
    /// says so. Returns the tiles whose net(tile, beyond) may be another one now, in rising order; `beyond` must be
    /// that with which notes were taken (noteNet()). Not to be called beside anything else.
    std::vector<std::size_t> change(const PointSet& changed, const PointSet& ground);
    /// Like net(); remembers what the tile's net relies on, for change(). Several threads may, of different tiles.
    SurfaceNet noteNet(std::size_t tile, double beyond);

    const PlaneMetric& metric() const noexcept { return m_metric; }
    /// Largest radius, in units of true length.
    double reach() const noexcept { return m_reach; }
    /// The reach that is preset for points so far apart (`lengths.unit`).
    static double reachOf(const TrueLengths& lengths, double spacing) noexcept;
    /// Units of true length of a raw step along each axis.
    const std::array<double, 3>& steps() const noexcept { return m_steps; }

private:
    friend class SurfaceNetMaker;

    struct Node {
        RawRect box;
        std::uint32_t children = 0;  ///< the first of four; 0: a leaf
        std::uint32_t tile = 0;
    };
    /// What a tile's net relies on beyond its own points.
    struct Notes {
        RawRect whole;                            ///< all points in it
        RawRect far;                              ///< and of those in this one
        std::vector<RawDisc> discs;               ///< all in these
        bool needsHull = false;                   ///< and, if so,
        std::vector<std::array<double, 2>> hull;  ///< all that are not inside of it
    };
    struct Keyed {
        std::uint64_t key = 0;  ///< Morton code
        std::uint32_t index = 0;
    };

    void grow(std::uint32_t node, int level, std::span<const Keyed> points);
    void splitWide(std::uint32_t node);
    void splitNode(std::uint32_t node);
    bool hasPointsIn(const RawRect& rect) const noexcept;
    void numberTiles();
    std::uint32_t leafAt(double x, double y) const noexcept;
    SurfacePoint point(std::uint32_t index) const noexcept
    {
        return {m_axes[0][index], m_axes[1][index], m_axes[2][index], index};
    }

    std::array<std::shared_ptr<const Column>, 3> m_columns;
    std::array<const std::int32_t*, 3> m_axes{};
    std::array<double, 3> m_steps{};
    PlaneMetric m_metric;
    double m_reach = 0;
    double m_squaredReach = 0;           ///< by the metric
    std::array<double, 2> m_rawReach{};  ///< along X and Y
    std::vector<Node> m_nodes;
    std::vector<RawRect> m_boxes;
    std::vector<std::vector<std::uint32_t>> m_points;
    std::vector<Notes> m_notes;
};

}  // namespace punctum
