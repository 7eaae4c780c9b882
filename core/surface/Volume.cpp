// SPDX-License-Identifier: MIT
#include "core/surface/Volume.h"

#include "core/Error.h"
#include "core/cloud/BlockBoxes.h"
#include "core/cloud/Slabs.h"
#include "core/cloud/Units.h"
#include "core/surface/SurfaceProbe.h"
#include "core/task/Progress.h"

#include <tbb/parallel_for.h>
#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <shared_mutex>

namespace punctum
{

namespace
{

/// Of the normal distribution: standard deviation from the median of the amounts.
constexpr double kFromMedian = 1.4826;
constexpr double kAreaError = 1e-4;  ///< of areas whose outlines cross themselves
constexpr int kLeastLattice = 16, kMostLattice = 256;

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

struct TileVolume {
    double cut = 0, fill = 0, area = 0, lacking = 0;
    double base = 0;  ///< its height (world) times area
    std::size_t points = 0;
    std::vector<float> residuals;
};

/// Heights of the base in one tile.
class BaseHeights
{
public:
    BaseHeights(const PointCloud& cloud, const VolumeQuestion& question, const EdgeBase* edge)
        : m_grid(cloud.coordinates()), m_question(question), m_edge(edge)
    {
        if (question.base == VolumeBase::Surface) m_other.emplace(*question.otherTiles);
    }

    /// In `world`, at a place (raw, and in `world`); none where there is none.
    std::optional<double> at(const glm::dvec2& raw, const glm::dvec2& world)
    {
        if (m_edge != nullptr) return m_edge->height(raw.x, raw.y, m_near) * m_grid.scale.z + m_grid.offset.z;
        if (!m_other) return m_question.height;
        const CoordinateScale& grid = m_question.otherCloud->coordinates();
        const std::optional<double> z =
            m_other->at((world.x - grid.offset.x) / grid.scale.x, (world.y - grid.offset.y) / grid.scale.y);
        if (!z) return std::nullopt;
        return *z * grid.scale.z + grid.offset.z;
    }

private:
    const CoordinateScale& m_grid;
    const VolumeQuestion& m_question;
    const EdgeBase* m_edge;
    std::uint32_t m_near = 0;
    std::optional<SurfaceProbe> m_other;
};

RawRect rectOf(std::span<const Ring> rings)
{
    if (rings.empty()) return {-INFINITY, -INFINITY, INFINITY, INFINITY};
    RawRect rect{INFINITY, INFINITY, -INFINITY, -INFINITY};
    for (const Ring& ring : rings)
        for (const glm::dvec2& p : ring)
            rect = {std::min(rect.minX, p.x), std::min(rect.minY, p.y), std::max(rect.maxX, p.x),
                    std::max(rect.maxY, p.y)};
    return rect;
}

std::vector<Ring> rawRings(std::span<const Ring> rings, const CoordinateScale& grid)
{
    std::vector<Ring> raw(rings.begin(), rings.end());
    for (Ring& ring : raw)
        for (glm::dvec2& p : ring) p = (p - glm::dvec2(grid.offset)) / glm::dvec2(grid.scale);
    return raw;
}

bool isAsked(std::span<const Ring> within, const glm::dvec2& place)
{
    return within.empty() || isInside(within, place);
}

/// What a tile has of the volume, and which of its points count. `rings` are raw.
TileVolume volumeInTile(const PointCloud& cloud, const SurfaceTiles& tiles, std::size_t t,
                        std::span<const Ring> rings, BaseHeights base, const Progress& progress)
{
    const CoordinateScale& grid = cloud.coordinates();
    const std::array<double, 3>& steps = tiles.steps();
    const RawRect& box = tiles.box(t);
    const SurfaceNet net = tiles.net(t);
    TileVolume part;
    if (net.triangles.empty() && rings.empty()) return part;
    const int cells = std::clamp(int(3 * std::sqrt(double(tiles.points(t).size()))), kLeastLattice, kMostLattice);
    const double dx = (box.maxX - box.minX) / cells, dy = (box.maxY - box.minY) / cells;
    const double cellArea = dx * steps[0] * dy * steps[1];
    std::uint32_t near = 0;
    const auto take = [&](const glm::dvec2& at, double area) {
        const glm::dvec2 world = at * glm::dvec2(grid.scale) + glm::dvec2(grid.offset);
        const std::optional<double> z = net.height(at.x, at.y, near), level = base.at(at, world);
        if (!z || !level) {
            // without an area nothing was asked for where the surface is not
            if (z || !rings.empty()) part.lacking += area;
            return;
        }
        const double above = (*z * grid.scale.z + grid.offset.z - *level) * (steps[2] / grid.scale.z);
        (above > 0 ? part.cut : part.fill) += std::abs(above) * area;
        part.area += area;
        part.base += *level * area;
    };
    CellCover cover(rings, box.minY, box.maxY);
    for (int j = 0; j < cells && !progress.cancelled(); ++j) {
        const double y = box.minY + j * dy;
        if (rings.empty()) {
            for (int i = 0; i < cells; ++i) take({box.minX + (i + 0.5) * dx, y + dy / 2}, cellArea);
        } else {
            for (const CellCover::Part& cell : cover.row(box.minX, dx, cells, y, dy))
                if (cell.share > 0) take({cell.x, cell.y}, cell.share * cellArea);
        }
    }
    for (const std::uint32_t i : tiles.points(t))
        if (isAsked(rings, {cloud.rawX()[i], cloud.rawY()[i]})) ++part.points;
    if (part.points != 0) addResiduals(net, box, part.residuals);
    return part;
}

/// The points of the surface that another one is compared with, in the same area.
TileVolume pointsOfOther(const PointCloud& cloud, const SurfaceTiles& tiles, const VolumeQuestion& question,
                         Progress& progress)
{
    const CoordinateScale& grid = cloud.coordinates();
    const SurfaceTiles& others = *question.otherTiles;
    std::vector<TileVolume> parts(others.size());
    tbb::parallel_for(std::size_t(0), others.size(), [&](std::size_t t) {
        if (progress.cancelled()) return;
        for (const std::uint32_t i : others.points(t)) {
            const glm::dvec3 p = question.otherCloud->world(i);
            const auto own =
                tiles.tileAt((p.x - grid.offset.x) / grid.scale.x, (p.y - grid.offset.y) / grid.scale.y);
            if (own && isAsked(question.within, glm::dvec2(p))) ++parts[t].points;
        }
        if (parts[t].points != 0) addResiduals(others.net(t), others.box(t), parts[t].residuals);
    });
    progress.check();
    TileVolume sum;
    for (const TileVolume& part : parts) {
        sum.points += part.points;
        sum.residuals.insert(sum.residuals.end(), part.residuals.begin(), part.residuals.end());
    }
    return sum;
}

}  // namespace

Ring outlineOf(const PointCloud& cloud, const PointSet& points)
{
    std::vector<SurfacePoint> all;
    points.forEach([&](PointIndex i) { all.push_back({cloud.rawX()[i], cloud.rawY()[i], 0, std::uint32_t(i)}); });
    const std::vector<SurfacePoint> hull = convexHull(std::move(all));
    Ring outline;
    outline.reserve(hull.size());
    for (const SurfacePoint& p : hull) outline.push_back(glm::dvec2(cloud.world(p.index)));
    return outline;
}

Volume volumeOf(const PointCloud& cloud, const SurfaceTiles& tiles, const VolumeQuestion& question,
                Progress& progress)
{
    const std::vector<Ring> rings = rawRings(question.within, cloud.coordinates());
    std::optional<EdgeBase> edge;
    if (question.base <= VolumeBase::Plane) {
        progress.begin("Looking along the outline", 0);
        edge.emplace(question.base, rings, tiles, progress);
    }
    std::vector<std::size_t> chosen;
    tiles.forTilesIn(rectOf(rings), [&](std::size_t t) { chosen.push_back(t); });
    std::vector<TileVolume> parts(chosen.size());
    progress.begin("Measuring the volume", chosen.size());
    tbb::parallel_for(std::size_t(0), chosen.size(), [&](std::size_t k) {
        if (progress.cancelled()) return;
        parts[k] = volumeInTile(cloud, tiles, chosen[k], rings,
                                BaseHeights(cloud, question, edge ? &*edge : nullptr), progress);
        progress.add(1);
    });
    progress.check();

    Volume volume;
    std::vector<float> residuals;
    for (const TileVolume& part : parts) {
        volume.cut += part.cut;
        volume.fill += part.fill;
        volume.area += part.area;
        volume.lacking += part.lacking;
        volume.height += part.base;
        volume.points += part.points;
        residuals.insert(residuals.end(), part.residuals.begin(), part.residuals.end());
    }
    if (volume.area == 0)
        throw Error(question.otherTiles ? "The two surfaces have no place in common there."
                                        : "There is no ground surface there.");
    // what lies beyond all tiles
    const double asked = areaInside(rings) * tiles.steps()[0] * tiles.steps()[1];
    const double beyond = asked - volume.area - volume.lacking;
    if (beyond > kAreaError * asked) volume.lacking += beyond;
    volume.height /= volume.area;
    if (edge) {
        volume.edge = edge->length();
        volume.edgeLacking = edge->lacking();
    }
    volume.residual = deviationOf(residuals) * tiles.steps()[2];
    const auto errorOf = [&](double residual, std::size_t points) {
        return points == 0 ? 0.0 : residual * volume.area / std::sqrt(double(points));
    };
    volume.deviation = errorOf(volume.residual, volume.points);
    if (edge)
        volume.deviation =
            std::hypot(volume.deviation, volume.residual * volume.area / std::sqrt(edge->pointsWorth()));
    if (question.base == VolumeBase::Surface) {
        TileVolume other = pointsOfOther(cloud, tiles, question, progress);
        volume.deviation =
            std::hypot(volume.deviation,
                       errorOf(deviationOf(other.residuals) * question.otherTiles->steps()[2], other.points));
    }
    return volume;
}

PointSet pointsForVolume(const PointCloud& cloud, std::span<const Ring> within, const std::bitset<256>* classes,
                         const PointSet* hidden, Progress& progress)
{
    const CoordinateScale& grid = cloud.coordinates();
    const TrueLengths lengths = trueLengths(cloud);
    RawRect rect = rectOf(rawRings(within, grid));
    if (!within.empty()) {
        const RawBounds all = cloud.boxes()->bounds();
        const glm::dvec3 steps = glm::abs(lengths.stretch * grid.scale);
        const double area = (double(all.max.x) - all.min.x) * steps.x * (double(all.max.y) - all.min.y) * steps.y;
        const double reach =
            SurfaceTiles::reachOf(lengths, std::sqrt(area / double(std::max<PointIndex>(1, cloud.size()))));
        // a circle about a triangle that touches the area, of a radius of the reach
        rect = rect.grown(2 * reach / steps.x, 2 * reach / steps.y);
    }
    std::optional<Attribute> codes;
    if (classes != nullptr) {
        const std::shared_lock lock(cloud.mutex());
        const Attribute* const found = cloud.findAttribute("Classification");
        if (found == nullptr) throw Error("A surface needs points with classes, and these have none.");
        codes = *found;
    }
    const auto boxes = cloud.boxes();
    PointSet points(cloud.size());
    progress.begin("Looking for the surface's points", cloud.size());
    forEachSlab(cloud, progress, [&](std::size_t firstWord, std::size_t lastWord) {
        const PointSet* const deleted = cloud.deleted().get();
        std::array<std::uint8_t, 64> code{};
        for (std::size_t w = firstWord; w < lastWord; ++w) {
            const RawBounds box = (*boxes)[w / BlockBoxes::kWords];
            if (!rect.meets({double(box.min.x), double(box.min.y), double(box.max.x), double(box.max.y)})) continue;
            std::uint64_t bits = shownBits(cloud.size(), deleted, w);
            if (hidden != nullptr) bits &= ~hidden->words()[w];
            if (bits == 0) continue;
            const PointRange range{PointIndex(w) * 64, std::min<PointIndex>(cloud.size(), PointIndex(w + 1) * 64)};
            if (codes) codes->gatherBits(range, code.data());
            for (PointIndex i = range.first; i < range.last; ++i)
                if ((codes && !(*classes)[code[i - range.first]]) || !rect.holds(cloud.rawX()[i], cloud.rawY()[i]))
                    bits &= ~(std::uint64_t(1) << (i - range.first));
            points.words()[w] = bits;
        }
    });
    return points;
}

bool anySurfaceIn(const PointCloud& cloud, std::span<const Ring> within, const PointSet& points)
{
    const std::vector<Ring> rings = rawRings(within, cloud.coordinates());
    const RawRect rect = rectOf(rings);
    int found = 0;
    points.forEach([&](PointIndex i) {
        const double x = cloud.rawX()[i], y = cloud.rawY()[i];
        if (found < 3 && rect.holds(x, y) && isAsked(rings, {x, y})) ++found;
    });
    return found >= 3;
}

}  // namespace punctum
