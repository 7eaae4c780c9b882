// SPDX-License-Identifier: MIT
#include "core/surface/Volume.h"

#include "core/Error.h"
#include "core/task/Progress.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace punctum
{

namespace
{

/// Of the normal distribution: standard deviation from the median of the amounts.
constexpr double kFromMedian = 1.4826;
constexpr int kLeastLattice = 16, kMostLattice = 256;

bool isInPolygon(const std::vector<glm::dvec2>& polygon, const glm::dvec2& p) noexcept
{
    bool inside = polygon.empty();
    for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++)
        if ((polygon[i].y > p.y) != (polygon[j].y > p.y) &&
            p.x <
                (polygon[j].x - polygon[i].x) * (p.y - polygon[i].y) / (polygon[j].y - polygon[i].y) + polygon[i].x)
            inside = !inside;
    return inside;
}

/// How far each vertex in a tile is from the plane through its neighbors' mean, whose slope is the mean of its
/// triangles' by their areas: what it would be taken for were it not there. In raw steps of Z.
void addResiduals(const SurfaceNet& net, const RawRect& box, std::vector<float>& residuals)
{
    const auto vertices = net.triangles.vertices();
    struct Sums {
        double z = 0, x = 0, y = 0, slopeX = 0, slopeY = 0, area = 0;
        int neighbors = 0;
        bool whole = true;  ///< all about it is surface
    };
    std::vector<Sums> sums(vertices.size());
    for (std::uint32_t t = 0; t < net.triangles.size(); ++t) {
        const auto& v = net.triangles.triangles()[t];
        const bool counts = net.counts(t);
        const std::array<double, 2> slope = net.triangles.slopeOf(t);
        const SurfacePoint &a = vertices[v[0]], &b = vertices[v[1]], &c = vertices[v[2]];
        const double area = std::abs((double(b.x) - a.x) * (double(c.y) - a.y) -
                                     (double(c.x) - a.x) * (double(b.y) - a.y));  // twice; slivers tell little
        for (std::size_t i = 0; i < 3; ++i) {
            Sums& s = sums[v[i]];
            const SurfacePoint& next = vertices[v[(i + 1) % 3]];  // each neighbor is the next one once
            s.z += next.z;
            s.x += next.x;
            s.y += next.y;
            s.slopeX += slope[0] * area;
            s.slopeY += slope[1] * area;
            s.area += area;
            ++s.neighbors;
            s.whole = s.whole && counts && net.triangles.neighbors()[t][i] != Triangulation::kNone;
        }
    }
    for (std::size_t v = 0; v < vertices.size(); ++v) {
        const Sums& s = sums[v];
        const SurfacePoint& p = vertices[v];
        if (!s.whole || s.neighbors < 3 || !(s.area > 0) || !box.holds(p.x, p.y)) continue;
        const double n = s.neighbors;
        const double expected = s.z / n + s.slopeX / s.area * (p.x - s.x / n) + s.slopeY / s.area * (p.y - s.y / n);
        // the mean of n has an error, too
        residuals.push_back(float((double(p.z) - expected) / std::sqrt(1.0 + 1.0 / n)));
    }
}

double deviationOf(std::vector<float>& residuals)
{
    if (residuals.empty()) return 0;
    for (float& r : residuals) r = std::abs(r);
    const auto middle = residuals.begin() + std::ptrdiff_t(residuals.size() / 2);
    std::nth_element(residuals.begin(), middle, residuals.end());
    return kFromMedian * double(*middle);
}

/// The other surface, asked for heights (world) of places near each other.
struct OtherHeights {
    std::size_t tile = SIZE_MAX;
    SurfaceNet net;
    std::uint32_t near = 0;

    std::optional<double> at(const VolumeQuestion& question, double x, double y)
    {
        const CoordinateScale& grid = question.otherCloud->coordinates();
        const double rawX = (x - grid.offset.x) / grid.scale.x, rawY = (y - grid.offset.y) / grid.scale.y;
        const auto where = question.otherTiles->tileAt(rawX, rawY);
        if (!where) return std::nullopt;
        if (*where != tile) {
            net = question.otherTiles->net(*where);
            tile = *where;
            near = 0;
        }
        const std::optional<double> z = net.height(rawX, rawY, near);
        if (!z) return std::nullopt;
        return *z * grid.scale.z + grid.offset.z;
    }
};

struct TileVolume {
    double cut = 0, fill = 0, area = 0, lacking = 0;
    std::size_t points = 0;
    std::vector<float> residuals;
};

}  // namespace

std::vector<glm::dvec2> outlineOf(const PointCloud& cloud, const PointSet& points)
{
    std::vector<SurfacePoint> all;
    points.forEach([&](PointIndex i) { all.push_back({cloud.rawX()[i], cloud.rawY()[i], 0, std::uint32_t(i)}); });
    const std::vector<SurfacePoint> hull = convexHull(std::move(all));
    std::vector<glm::dvec2> outline;
    outline.reserve(hull.size());
    for (const SurfacePoint& p : hull) outline.push_back(glm::dvec2(cloud.world(p.index)));
    return outline;
}

Volume volumeOf(const PointCloud& cloud, const SurfaceTiles& tiles, const VolumeQuestion& question,
                Progress& progress)
{
    const CoordinateScale& grid = cloud.coordinates();
    const std::array<double, 3>& steps = tiles.steps();
    const double lengthOfZ = steps[2] / grid.scale.z;  // of a unit of world
    RawRect about{-INFINITY, -INFINITY, INFINITY, INFINITY};
    if (!question.within.empty()) {
        about = {INFINITY, INFINITY, -INFINITY, -INFINITY};
        for (const glm::dvec2& p : question.within) {
            const double x = (p.x - grid.offset.x) / grid.scale.x, y = (p.y - grid.offset.y) / grid.scale.y;
            about = {std::min(about.minX, x), std::min(about.minY, y), std::max(about.maxX, x),
                     std::max(about.maxY, y)};
        }
    }
    std::vector<std::size_t> chosen;
    tiles.forTilesIn(about, [&](std::size_t t) { chosen.push_back(t); });
    std::vector<TileVolume> parts(chosen.size());
    progress.begin("Measuring the volume", chosen.size());
    tbb::parallel_for(std::size_t(0), chosen.size(), [&](std::size_t k) {
        if (progress.cancelled()) return;
        const std::size_t t = chosen[k];
        const RawRect& box = tiles.box(t);
        const SurfaceNet net = tiles.net(t);
        TileVolume& part = parts[k];
        OtherHeights other;
        progress.add(1);
        if (net.triangles.empty() && question.within.empty()) return;
        const int cells =
            std::clamp(int(3 * std::sqrt(double(tiles.points(t).size()))), kLeastLattice, kMostLattice);
        const double dx = (box.maxX - box.minX) / cells, dy = (box.maxY - box.minY) / cells;
        const double area = dx * steps[0] * dy * steps[1];
        std::uint32_t near = 0;
        for (int j = 0; j < cells; ++j)
            for (int i = 0; i < cells; ++i) {
                const double x = box.minX + (i + 0.5) * dx, y = box.minY + (j + 0.5) * dy;
                const glm::dvec2 world(x * grid.scale.x + grid.offset.x, y * grid.scale.y + grid.offset.y);
                if (!isInPolygon(question.within, world)) continue;
                const std::optional<double> z = net.height(x, y, near);
                const std::optional<double> base =
                    question.otherTiles ? other.at(question, world.x, world.y) : std::optional(question.base);
                if (!z || !base) {
                    // without a polygon nothing was asked for where the surface is not
                    if (z || !question.within.empty()) part.lacking += area;
                    continue;
                }
                const double above = (*z * grid.scale.z + grid.offset.z - *base) * lengthOfZ;
                (above > 0 ? part.cut : part.fill) += std::abs(above) * area;
                part.area += area;
            }
        for (const std::uint32_t i : tiles.points(t))
            if (isInPolygon(question.within, glm::dvec2(cloud.world(i)))) ++part.points;
        if (part.points != 0) addResiduals(net, box, part.residuals);
    });
    progress.check();

    Volume volume;
    std::vector<float> residuals;
    for (const TileVolume& part : parts) {
        volume.cut += part.cut;
        volume.fill += part.fill;
        volume.area += part.area;
        volume.lacking += part.lacking;
        volume.points += part.points;
        residuals.insert(residuals.end(), part.residuals.begin(), part.residuals.end());
    }
    if (volume.area == 0)
        throw Error(question.otherTiles ? "The two surfaces have no place in common there."
                                        : "There is no ground surface there.");
    volume.residual = deviationOf(residuals) * steps[2];
    const auto errorOf = [&](double residual, std::size_t points) {
        return points == 0 ? 0.0 : residual * volume.area / std::sqrt(double(points));
    };
    volume.deviation = errorOf(volume.residual, volume.points);
    if (question.otherTiles) {
        // the other one's points in the same area, tile by tile
        const SurfaceTiles& tilesOfOther = *question.otherTiles;
        std::vector<TileVolume> others(tilesOfOther.size());
        tbb::parallel_for(std::size_t(0), tilesOfOther.size(), [&](std::size_t t) {
            if (progress.cancelled()) return;
            for (const std::uint32_t i : tilesOfOther.points(t)) {
                const glm::dvec3 p = question.otherCloud->world(i);
                const auto own =
                    tiles.tileAt((p.x - grid.offset.x) / grid.scale.x, (p.y - grid.offset.y) / grid.scale.y);
                if (own && isInPolygon(question.within, glm::dvec2(p))) ++others[t].points;
            }
            if (others[t].points != 0) addResiduals(tilesOfOther.net(t), tilesOfOther.box(t), others[t].residuals);
        });
        progress.check();
        std::size_t points = 0;
        residuals.clear();
        for (const TileVolume& part : others) {
            points += part.points;
            residuals.insert(residuals.end(), part.residuals.begin(), part.residuals.end());
        }
        volume.deviation =
            std::hypot(volume.deviation, errorOf(deviationOf(residuals) * tilesOfOther.steps()[2], points));
    }
    return volume;
}

}  // namespace punctum
