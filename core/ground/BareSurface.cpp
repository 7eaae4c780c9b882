// SPDX-License-Identifier: MIT
#include "core/ground/BareSurface.h"

#include "core/ground/GridFilling.h"
#include "core/ground/GridMorphology.h"
#include "core/ground/GridParts.h"
#include "core/task/Progress.h"

#include <cmath>
#include <cstdint>
#include <utility>

namespace punctum
{

namespace
{

using CellMarks = std::vector<std::uint8_t>;

int cellsAlong(float length, const BareSurfaceSettings& s)
{
    return std::max(1, int(std::lround(length * s.meter / s.cell)));
}

int largestRadius(const BareSurfaceSettings& s)
{
    return std::max(1, int(std::ceil(s.window / s.cell - 1e-4f)));
}

HeightGrid filledGrid(HeightGrid grid, const Progress& progress)
{
    fillHoles(grid, progress);
    return grid;
}

HeightGrid withoutObjects(const HeightGrid& lowest, const CellMarks& objects, const Progress& progress)
{
    HeightGrid rest = lowest;
    for (std::size_t k = 0; k < objects.size(); ++k)
        if (objects[k] != 0) rest.z[k] = HeightGrid::kNone;
    // Objects alone: better their lowest points than nothing.
    if (std::all_of(rest.z.begin(), rest.z.end(), [](float z) { return std::isnan(z); })) rest = lowest;
    return filledGrid(std::move(rest), progress);
}

/// Takes small deep pits out of the lowest points.
void dropLowOutliers(HeightGrid& lowest, const BareSurfaceSettings& s, const Progress& progress)
{
    const HeightGrid surface = filledGrid(lowest, progress);
    const int reach = cellsAlong(s.pitReach, s);
    const HeightGrid closed = closedBy(openedBy(surface, largestRadius(s), progress), reach, progress);
    const HeightGrid slopes = slopesOf(closed, s.cell);
    CellMarks pits(lowest.z.size());
    for (std::size_t k = 0; k < pits.size(); ++k)
        pits[k] = closed.z[k] - surface.z[k] > s.pitDepth * s.meter + 0.5f * slopes.z[k] * float(reach) * s.cell;
    const double most = double(s.pitArea) * double(s.meter) * double(s.meter) / (double(s.cell) * double(s.cell));
    forEachPart(std::move(pits), lowest.width, lowest.height, [&](const std::vector<std::uint32_t>& part) {
        if (double(part.size()) <= std::max(1.0, most))
            for (const std::uint32_t k : part) lowest.z[k] = HeightGrid::kNone;
    });
}

/// A part of a surface that may be a roof, among objects that are known.
struct RoofPart {
    const HeightGrid* surface;
    const CellMarks *objects, *inPart;
    const BareSurfaceSettings* s;

    bool in(int x, int y) const { return x >= 0 && y >= 0 && x < surface->width && y < surface->height; }
    bool isObject(int x, int y) const { return (*objects)[surface->index(x, y)] != 0; }
    bool isInPart(int x, int y) const { return (*inPart)[surface->index(x, y)] != 0; }

    /// What lies beside a cell in a direction: the lowest height within two meters, or that beyond the objects that
    /// adjoin. NaN where nothing tells: in the part itself, outside of the grid, too far away.
    float heightBeside(int x, int y, int dx, int dy) const
    {
        int u = x + dx, v = y + dy;
        if (!in(u, v) || isInPart(u, v)) return HeightGrid::kNone;
        const bool object = isObject(u, v);
        float low = surface->at(u, v);
        for (int step = 2; step <= cellsAlong(object ? s->roofBeyond : 2, *s); ++step) {
            u += dx;
            v += dy;
            if (!in(u, v)) break;
            if (!object) {
                low = std::min(low, surface->at(u, v));
            } else if (!isObject(u, v)) {
                return !isInPart(u, v) ? surface->at(u, v) : HeightGrid::kNone;
            }
        }
        return object ? HeightGrid::kNone : low;
    }

    /// Whether most of its outline drops, as the edge of a roof does.
    bool dropsAround(const std::vector<std::uint32_t>& cells) const
    {
        std::size_t outline = 0, drops = 0;
        for (const std::uint32_t k : cells)
            for (int side = 0; side < 4; ++side) {
                const int x = int(k) % surface->width, y = int(k) / surface->width;
                const float beside = heightBeside(x, y, (side == 0) - (side == 1), (side == 2) - (side == 3));
                if (std::isnan(beside)) continue;
                ++outline;
                drops += surface->z[k] - beside > s->roofDrop * s->meter;
            }
        return outline > 0 && double(drops) >= double(s->roofEdge) * double(outline);
    }
};

/// Marks what is larger than the window and stands out like a roof. `last`: what the openings left; `surface`:
/// before.
void markLargeRoofs(CellMarks& objects, const HeightGrid& last, const HeightGrid& surface,
                    const BareSurfaceSettings& s, const Progress& progress)
{
    const HeightGrid opened = openedBy(last, cellsAlong(s.roofRadius, s), progress);
    CellMarks high(objects.size());
    for (std::size_t k = 0; k < high.size(); ++k)
        high[k] = objects[k] == 0 && last.z[k] - opened.z[k] > s.roofHeight * s.meter;
    const double least = double(s.roofArea) * double(s.meter) * double(s.meter) / (double(s.cell) * double(s.cell));
    CellMarks inPart(objects.size());
    forEachPart(std::move(high), last.width, last.height, [&](const std::vector<std::uint32_t>& part) {
        if (double(part.size()) < least) return;
        for (const std::uint32_t k : part) inPart[k] = 1;
        const bool roof = RoofPart{&surface, &objects, &inPart, &s}.dropsAround(part);
        for (const std::uint32_t k : part) inPart[k] = 0;
        if (roof)
            for (const std::uint32_t k : part) objects[k] = 1;
    });
}

/// Marks cells that an opening cut by more than the tolerance, and takes over what it left. (Plain pointers, since
/// marks are bytes, which the compiler must else take for anything.)
void markCut(std::uint8_t* objects, float* last, const float* opened, std::size_t count, float tolerance,
             const float* extra)
{
    if (extra == nullptr)
        for (std::size_t k = 0; k < count; ++k) objects[k] |= std::uint8_t(last[k] - opened[k] > tolerance);
    else
        for (std::size_t k = 0; k < count; ++k)
            objects[k] |= std::uint8_t(last[k] - opened[k] > tolerance + extra[k]);
    std::copy_n(opened, count, last);
}

/// Openings by larger and larger windows; marks what each cuts off by more than its tolerance, which `extra` raises
/// (null: not at all). `surface`: the heights before; `heights`: what is opened.
CellMarks objectsIn(const HeightGrid& heights, const HeightGrid& surface, float step, const HeightGrid* extra,
                    const BareSurfaceSettings& s, const Progress& progress)
{
    CellMarks objects(heights.z.size());
    GrowingOpenings openings(heights);
    HeightGrid last = heights;
    const int most = largestRadius(s);
    for (int radius = 1; radius <= most; ++radius) {
        const HeightGrid& opened = openings.next(progress);
        const float tolerance = step * s.meter + s.slope * float(radius) * s.cell;
        forRows(last.width, last.height, [&](int first, int end) {
            const std::size_t from = last.index(0, first), count = last.index(0, end) - from;
            markCut(objects.data() + from, last.z.data() + from, opened.z.data() + from, count, tolerance,
                    extra != nullptr ? extra->z.data() + from : nullptr);
        });
    }
    markLargeRoofs(objects, last, surface, s, progress);
    return objects;
}

/// Objects above the trend of the surface that is known so far. `surface`: with all objects.
CellMarks objectsAboveTrend(const HeightGrid& surface, const HeightGrid& known, const BareSurfaceSettings& s,
                            const Progress& progress)
{
    HeightGrid trend = known;
    blurGrid(trend, cellsAlong(s.trendReach, s), progress);
    HeightGrid edges = known;
    for (std::size_t k = 0; k < edges.z.size(); ++k) edges.z[k] = std::abs(known.z[k] - trend.z[k]);
    blurGrid(edges, cellsAlong(s.toleranceReach, s), progress);
    HeightGrid extra = known;
    blurGrid(extra, cellsAlong(s.toleranceReach, s), progress);
    extra = slopesOf(extra, s.cell);
    for (std::size_t k = 0; k < extra.z.size(); ++k) {
        extra.z[k] = s.trendSlope * s.meter * extra.z[k] + s.edgeShare * edges.z[k];
        trend.z[k] = surface.z[k] - s.trendShare * trend.z[k];
    }
    edges = HeightGrid();
    return objectsIn(trend, surface, s.step, &extra, s, progress);
}

/// Marks what stands out of the surface more than the surface is rough there.
void markBumps(CellMarks& objects, const HeightGrid& known, const BareSurfaceSettings& s, const Progress& progress)
{
    HeightGrid smooth = known;
    blurGrid(smooth, cellsAlong(s.bumpReach, s), progress);
    HeightGrid rough = known;
    for (std::size_t k = 0; k < rough.z.size(); ++k) rough.z[k] = std::abs(known.z[k] - smooth.z[k]);
    blurGrid(rough, cellsAlong(s.trendReach, s), progress);
    for (std::size_t k = 0; k < objects.size(); ++k)
        if (known.z[k] - smooth.z[k] > s.bumpHeight * s.meter + s.bumpRoughness * rough.z[k]) objects[k] = 1;
}

}  // namespace

int reachInCells(const BareSurfaceSettings& s)
{
    return 2 * std::max(largestRadius(s), cellsAlong(s.roofRadius, s)) + 16;
}

BareSurface bareSurface(HeightGrid lowest, const BareSurfaceSettings& s, const Progress& progress)
{
    BareSurface result;
    if (std::all_of(lowest.z.begin(), lowest.z.end(), [](float z) { return std::isnan(z); })) {
        result.tolerance = result.heights = std::move(lowest);
        return result;
    }
    dropLowOutliers(lowest, s, progress);
    const HeightGrid surface = filledGrid(lowest, progress);
    CellMarks objects = objectsIn(surface, surface, 0, nullptr, s, progress);
    for (int pass = 0; pass < 2; ++pass)
        objects = objectsAboveTrend(surface, withoutObjects(lowest, objects, progress), s, progress);
    markBumps(objects, withoutObjects(lowest, objects, progress), s, progress);
    result.heights = withoutObjects(lowest, objects, progress);
    result.tolerance = slopesOf(result.heights, s.cell);
    for (float& v : result.tolerance.z) {
        const float beyond = std::max(0.0f, v - 1);
        v = s.threshold + (s.steepness * v + s.cliff * beyond * beyond) * s.meter;
    }
    return result;
}

}  // namespace punctum
