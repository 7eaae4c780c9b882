// SPDX-License-Identifier: MIT
#include "core/raster/Terrain.h"

#include "core/Error.h"
#include "core/surface/Triangulation.h"
#include "core/task/Progress.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numeric>

namespace punctum
{

namespace
{

constexpr std::size_t kTerrainBin = 32;        ///< cells a side of the squares that points are sorted into
constexpr std::size_t kMostBins = 16;          ///< a side of a piece
constexpr double kTilePoints = 400'000;        ///< that a piece should have, at most
constexpr std::size_t kWordsAtOnce = 1 << 10;  ///< of a set, that one task looks at
/// Cells that a height is taken beside the middle: there is hardly ever an edge exactly, so that it does not matter
/// from where the triangle is looked for.
constexpr glm::dvec2 kBeside(1.2345e-7, 2.7182e-7);

/// Points sorted into squares of cells.
class BinnedPoints
{
public:
    BinnedPoints(const PointCloud& cloud, const PointSet& points, const RasterFrame& frame, Progress& progress)
        : m_cloud(cloud),
          m_frame(frame),
          m_across((frame.columns + kTerrainBin - 1) / kTerrainBin),
          m_down((frame.rows + kTerrainBin - 1) / kTerrainBin),
          m_starts(m_across * m_down + 1)
    {
        std::vector<std::atomic<std::uint32_t>> next(m_across * m_down);
        forPoints(points, "Sorting ground points", progress,
                  [&](std::size_t bin, PointIndex) { next[bin].fetch_add(1, std::memory_order_relaxed); });
        for (std::size_t b = 0; b < next.size(); ++b) {
            m_starts[b + 1] = m_starts[b] + next[b].load();
            next[b] = 0;
        }
        m_points.resize(m_starts.back());
        // in any order within a square: the triangulation is the same
        forPoints(points, "Sorting ground points", progress, [&](std::size_t bin, PointIndex i) {
            m_points[m_starts[bin] + next[bin].fetch_add(1, std::memory_order_relaxed)] = std::uint32_t(i);
        });
    }

    std::size_t across() const noexcept { return m_across; }
    std::size_t down() const noexcept { return m_down; }
    std::size_t size() const noexcept { return m_points.size(); }

    /// The points of a rectangle of squares.
    void gather(std::size_t left, std::size_t top, std::size_t right, std::size_t bottom,
                std::vector<SurfacePoint>& out) const
    {
        const std::int32_t *const x = m_cloud.rawX().data(), *const y = m_cloud.rawY().data(),
                                  *const z = m_cloud.rawZ().data();
        out.clear();
        for (std::size_t row = top; row < bottom; ++row)
            for (std::size_t k = m_starts[row * m_across + left]; k < m_starts[row * m_across + right]; ++k) {
                const std::uint32_t i = m_points[k];
                out.push_back({x[i], y[i], z[i], i});
            }
    }

private:
    template <typename F>
    void forPoints(const PointSet& points, const char* stage, Progress& progress, F f) const
    {
        const DecimalScale stepsX = m_cloud.coordinates().steps(0), stepsY = m_cloud.coordinates().steps(1);
        const std::int32_t *const x = m_cloud.rawX().data(), *const y = m_cloud.rawY().data();
        const std::size_t words = points.words().size(), tasks = (words + kWordsAtOnce - 1) / kWordsAtOnce;
        progress.begin(stage, tasks);
        tbb::parallel_for(std::size_t(0), tasks, [&](std::size_t task) {
            if (progress.cancelled()) return;
            points.forEachInWords(
                task * kWordsAtOnce, std::min(words, (task + 1) * kWordsAtOnce), [&](PointIndex i) {
                    const double column = RasterFrame::inCells(stepsX(x[i]), m_frame.cell) - double(m_frame.left),
                                 row = double(m_frame.top) - RasterFrame::inCells(stepsY(y[i]), m_frame.cell);
                    const auto c = std::size_t(std::clamp(column, 0.0, double(m_frame.columns - 1))),
                               r = std::size_t(std::clamp(row, 0.0, double(m_frame.rows - 1)));
                    f(r / kTerrainBin * m_across + c / kTerrainBin, i);
                });
            progress.add(1);
        });
        progress.check();
    }

    const PointCloud& m_cloud;
    RasterFrame m_frame;
    std::size_t m_across, m_down;
    std::vector<std::size_t> m_starts;
    std::vector<std::uint32_t> m_points;
};

/// A triangle in true lengths, its corners in a fixed order, so that the same numbers come of it wherever it is
/// met.
struct FlatTriangle {
    std::array<glm::dvec3, 3> corners;  ///< X and Y true lengths from a corner of the frame; Z raw
    glm::dvec2 middle{0.0};             ///< of the circle through them
    double radius = 0;

    double heightAt(const glm::dvec2& p) const
    {
        const glm::dvec3 u = corners[1] - corners[0], v = corners[2] - corners[0];
        const double area = u.x * v.y - u.y * v.x;
        const glm::dvec2 d = p - glm::dvec2(corners[0]);
        const double s = (d.x * v.y - d.y * v.x) / area, t = (u.x * d.y - u.y * d.x) / area;
        return corners[0].z + s * u.z + t * v.z;
    }
};

/// Makes the surface of one piece.
class SurfacePiece
{
public:
    SurfacePiece(const PointCloud& cloud, const RasterFrame& frame, const BinnedPoints& bins, double bridge)
        : m_frame(frame),
          m_bins(bins),
          m_radius(bridge / 2),
          m_scale(cloud.coordinates()),
          m_lengths(trueLengths(cloud).stretch),
          m_metric(
              PlaneMetric::of(std::abs(m_scale.scale.x) * m_lengths.x, std::abs(m_scale.scale.y) * m_lengths.y)),
          m_corner(m_frame.west(0), m_frame.north(0))
    {
        // the circle of a triangle over a cell reaches no further than its width
        const double cell = frame.cell * std::min(m_lengths.x, m_lengths.y);
        m_reach = std::size_t(std::min(std::ceil(bridge / (cell * double(kTerrainBin))), 1e6)) + 1;
    }

    /// The cells of a rectangle of squares.
    void fill(std::size_t left, std::size_t top, std::size_t right, std::size_t bottom, Raster& raster,
              const Progress& progress) const
    {
        // most triangles are small, and known with few points around
        if (m_reach > 1 && attempt(left, top, right, bottom, 1, raster, progress)) return;
        attempt(left, top, right, bottom, m_reach, raster, progress);
    }

private:
    bool attempt(std::size_t left, std::size_t top, std::size_t right, std::size_t bottom, std::size_t margin,
                 Raster& raster, const Progress& progress) const
    {
        const std::size_t l = left - std::min(left, margin), t = top - std::min(top, margin),
                          r = std::min(m_bins.across(), right + margin),
                          b = std::min(m_bins.down(), bottom + margin);
        std::vector<SurfacePoint> points;
        m_bins.gather(l, t, r, b, points);
        const bool last = margin >= m_reach;
        if (points.size() < 3) return last;
        const Triangulation net(points, m_metric, Delaunay::Keep::Lowest, &progress);
        points = {};
        if (net.empty()) return last;
        // where nothing is known beyond; beyond the frame there are no points
        const double cell = m_frame.cell, far = std::numeric_limits<double>::infinity();
        const auto edge = [&](std::size_t bin) { return double(bin * kTerrainBin) * cell; };
        const double west = l == 0 ? -far : edge(l) * m_lengths.x,
                     east = r == m_bins.across() ? far : edge(r) * m_lengths.x,
                     north = t == 0 ? far : -edge(t) * m_lengths.y,
                     south = b == m_bins.down() ? -far : -edge(b) * m_lengths.y;
        const std::size_t columns = std::min(raster.columns(), right * kTerrainBin),
                          rows = std::min(raster.rows(), bottom * kTerrainBin);
        std::uint32_t near = 0;
        Known known;
        for (std::size_t row = top * kTerrainBin; row < rows; ++row) {
            progress.check();
            for (std::size_t column = left * kTerrainBin; column < columns; ++column) {
                const glm::dvec2 at = m_frame.middle(column, row) + kBeside * cell;
                const auto found = net.locate((at.x - m_scale.offset.x) / m_scale.scale.x,
                                              (at.y - m_scale.offset.y) / m_scale.scale.y, near);
                float& value = raster.at(column, row);
                value = Raster::kNone;
                if (!found) {
                    if (!last) return false;
                    continue;
                }
                if (known.number != *found) known = {*found, flat(net, *found)};
                const FlatTriangle& triangle = known.triangle;
                const double around = triangle.radius * (1.0 + 1e-9);
                if (!last && (triangle.middle.x - around < west || triangle.middle.x + around > east ||
                              triangle.middle.y - around < south || triangle.middle.y + around > north))
                    return false;
                if (triangle.radius > m_radius) continue;
                const glm::dvec2 place = (at - m_corner) * glm::dvec2(m_lengths);
                value = float(triangle.heightAt(place) * m_scale.scale.z + m_scale.offset.z);
            }
        }
        return true;
    }

    struct Known {
        std::uint32_t number = Triangulation::kNone;
        FlatTriangle triangle;
    };

    FlatTriangle flat(const Triangulation& net, std::uint32_t number) const
    {
        std::array<SurfacePoint, 3> points;
        for (std::size_t k = 0; k < 3; ++k) points[k] = net.vertices()[net.triangles()[number][k]];
        std::sort(points.begin(), points.end(), [](const SurfacePoint& a, const SurfacePoint& b) {
            return std::pair(a.x, a.y) < std::pair(b.x, b.y);
        });
        FlatTriangle triangle;
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec2 world(points[k].x * m_scale.scale.x + m_scale.offset.x,
                                   points[k].y * m_scale.scale.y + m_scale.offset.y);
            triangle.corners[k] = glm::dvec3((world - m_corner) * glm::dvec2(m_lengths), double(points[k].z));
        }
        const glm::dvec2 a(triangle.corners[0]), u = glm::dvec2(triangle.corners[1]) - a,
                                                 v = glm::dvec2(triangle.corners[2]) - a;
        const double area = 2.0 * (u.x * v.y - u.y * v.x), uu = u.x * u.x + u.y * u.y, vv = v.x * v.x + v.y * v.y;
        const glm::dvec2 middle((v.y * uu - u.y * vv) / area, (u.x * vv - v.x * uu) / area);
        triangle.radius = std::hypot(middle.x, middle.y);
        triangle.middle = a + middle;
        return triangle;
    }

    RasterFrame m_frame;
    const BinnedPoints& m_bins;
    double m_radius;
    CoordinateScale m_scale;
    glm::dvec3 m_lengths;
    PlaneMetric m_metric;
    glm::dvec2 m_corner;
    std::size_t m_reach = 1;
};

}  // namespace

Raster surfaceHeights(const PointCloud& cloud, const PointSet& points, const RasterFrame& frame, double bridge,
                      Progress& progress)
{
    if (cloud.size() > UINT32_MAX) throw Error("A surface can be made of up to 4,294,967,295 points.");
    Raster raster(frame);
    if (frame.cells() == 0) return raster;
    const BinnedPoints bins(cloud, points, frame, progress);
    const SurfacePiece piece(cloud, frame, bins, bridge);
    const double inBin = double(bins.size()) / double(bins.across() * bins.down());
    const std::size_t side =
        std::clamp(std::size_t(std::sqrt(kTilePoints / std::max(inBin, 1.0))), std::size_t(1), kMostBins);
    const std::size_t across = (bins.across() + side - 1) / side, down = (bins.down() + side - 1) / side;
    progress.begin("Triangulating", across * down);
    tbb::parallel_for(std::size_t(0), across * down, [&](std::size_t tile) {
        if (progress.cancelled()) return;
        const std::size_t left = tile % across * side, top = tile / across * side;
        piece.fill(left, top, std::min(bins.across(), left + side), std::min(bins.down(), top + side), raster,
                   progress);
        progress.add(1);
    });
    progress.check();
    return raster;
}

}  // namespace punctum
