// SPDX-License-Identifier: MIT
#include "core/Error.h"
#include "core/cloud/Slabs.h"
#include "core/raster/Contours.h"
#include "core/raster/Crossings.h"
#include "core/raster/MapPoints.h"
#include "core/raster/Maps.h"
#include "core/surface/Delaunay.h"
#include "core/surface/Polygon.h"
#include "core/task/Progress.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <mutex>
#include <shared_mutex>

namespace punctum
{

namespace
{

constexpr double kCloseCells = 3.0;
constexpr double kLeastCells = 16.0;

/// 1 where the largest (or the least) value within so many cells along rows and columns is 1.
Raster spreadCells(const Raster& raster, std::size_t reach, bool largest)
{
    const auto along = [&](const Raster& from, bool rows) {
        Raster to(from.frame(), 0.0f);
        const std::size_t lines = rows ? from.rows() : from.columns(), n = rows ? from.columns() : from.rows();
        tbb::parallel_for(std::size_t(0), lines, [&](std::size_t line) {
            // how far back the last cell of the other kind lies, both ways
            const float wanted = largest ? 1.0f : 0.0f;
            std::size_t since = reach + 1;
            const auto at = [&](std::size_t k) { return rows ? from.at(k, line) : from.at(line, k); };
            const auto put = [&](std::size_t k) -> float& { return rows ? to.at(k, line) : to.at(line, k); };
            for (std::size_t k = 0; k < n; ++k) {
                since = at(k) == wanted ? 0 : since + 1;
                put(k) = since <= reach ? wanted : 1.0f - wanted;
            }
            since = reach + 1;
            for (std::size_t k = n; k-- > 0;) {
                since = at(k) == wanted ? 0 : since + 1;
                if (since <= reach) put(k) = wanted;
            }
        });
        return to;
    };
    return along(along(raster, true), false);
}

std::vector<MapArea> hullArea(const PointCloud& cloud, const PointSet* points, Progress& progress)
{
    progress.begin("Looking for the hull", cloud.size());
    std::mutex mutex;
    std::vector<SurfacePoint> all;
    forEachSlab(cloud, progress, [&](std::size_t firstWord, std::size_t lastWord) {
        std::vector<SurfacePoint> mine;
        const PointSet* const deleted = cloud.deleted().get();
        const std::int32_t *const x = cloud.rawX().data(), *const y = cloud.rawY().data();
        for (std::size_t w = firstWord; w < lastWord; ++w) {
            std::uint64_t bits = shownBits(cloud.size(), deleted, w);
            if (points != nullptr) bits &= points->words()[w];
            for (; bits != 0; bits &= bits - 1) {
                const std::size_t i = w * 64 + std::size_t(std::countr_zero(bits));
                mine.push_back({x[i], y[i]});
            }
        }
        mine = convexHull(std::move(mine));
        const std::lock_guard lock(mutex);
        all.insert(all.end(), mine.begin(), mine.end());
    });
    MapArea area;
    area.rings.emplace_back();
    for (const SurfacePoint& c : convexHull(std::move(all)))
        area.rings[0].emplace_back(cloud.coordinates().steps(0)(c.x), cloud.coordinates().steps(1)(c.y));
    if (area.rings[0].size() < 3) throw Error("The points lie on one line, so that they have no outline.");
    // where an axis of the file runs backwards
    if (signedArea(area.rings[0]) < 0) std::reverse(area.rings[0].begin(), area.rings[0].end());
    area.area = signedArea(area.rings[0]);
    return {area};
}

/// Outer rings with the holes in them, largest first.
std::vector<MapArea> nestedAreas(std::vector<ContourLine> lines, double least)
{
    std::vector<MapArea> areas;
    std::vector<std::pair<double, std::vector<glm::dvec2>>> holes;
    for (ContourLine& line : lines) {
        const double area = signedArea(line.points);
        if (std::abs(area) < least) continue;
        if (area > 0)
            areas.push_back({{std::move(line.points)}, area});
        else
            holes.emplace_back(area, std::move(line.points));
    }
    std::stable_sort(areas.begin(), areas.end(),
                     [](const MapArea& a, const MapArea& b) { return a.area > b.area; });
    struct Box {
        glm::dvec2 low{INFINITY}, high{-INFINITY};
    };
    std::vector<Box> boxes(areas.size());
    for (std::size_t k = 0; k < areas.size(); ++k)
        for (const glm::dvec2& p : areas[k].rings[0]) {
            boxes[k].low = {std::min(boxes[k].low.x, p.x), std::min(boxes[k].low.y, p.y)};
            boxes[k].high = {std::max(boxes[k].high.x, p.x), std::max(boxes[k].high.y, p.y)};
        }
    std::vector<double> cut(areas.size(), 0.0);
    for (auto& [area, ring] : holes) {
        const glm::dvec2 p = ring[0];
        // the smallest one around it
        for (std::size_t k = areas.size(); k-- > 0;) {
            const Box& box = boxes[k];
            if (p.x < box.low.x || p.y < box.low.y || p.x > box.high.x || p.y > box.high.y) continue;
            if (!isInside(areas[k].rings[0], p)) continue;
            cut[k] += area;
            areas[k].rings.push_back(std::move(ring));
            break;
        }
    }
    for (std::size_t k = 0; k < areas.size(); ++k) areas[k].area += cut[k];
    return areas;
}

}  // namespace

std::vector<MapArea> outlinesOf(const PointCloud& cloud, const OutlineRequest& request, Progress& progress)
{
    checkMapped(cloud);
    const auto points = pointsWhere(cloud, {request.where}, progress);
    if (request.convex) return hullArea(cloud, points.get(), progress);
    const double cell = request.cell > 0.0 ? request.cell : mapCell(cloud, progress);
    const auto closing = std::size_t(
        std::clamp(std::ceil((request.close > 0.0 ? request.close / cell : kCloseCells) / 2), 0.0, 1e4));
    const RasterFrame frame =
        widened(rasterFrame(boundsOfPoints(cloud, points.get(), progress), cell), closing + 1);
    if (frame.cells() > RasterFrame::kMostCells)
        throw Error("The cells are too small for the extent of the points.");
    Raster covered(frame, 0.0f);
    {
        Attribute height;
        {
            const std::shared_lock lock(cloud.mutex());
            if (const Attribute* const z = cloud.findAttribute("Z")) height = *z;
        }
        covered = rasterize(cloud, height, {Statistic::Kind::Count}, frame, points.get(), progress);
    }
    for (float& v : covered.values()) v = v > 0.0f ? 1.0f : 0.0f;
    if (closing > 0) covered = spreadCells(spreadCells(covered, closing, true), closing, false);
    progress.check();
    std::vector<ContourLine> lines = levelLines(covered, 0.5f, progress);
    simplifyApart(lines, request.simplify > 0.0 ? request.simplify : cell, cell, progress);
    return nestedAreas(std::move(lines), request.leastArea > 0.0 ? request.leastArea : kLeastCells * cell * cell);
}

}  // namespace punctum
