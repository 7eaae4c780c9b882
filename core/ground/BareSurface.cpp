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

/// How much of a part's outline drops, as the edge of a roof does. The outline of the grid does not count.
bool dropsAround(const std::vector<std::uint32_t>& part, const CellMarks& inPart, const HeightGrid& surface,
                 const BareSurfaceSettings& s)
{
    const int w = surface.width, h = surface.height, reach = cellsAlong(2, s);
    std::size_t outline = 0, drops = 0;
    for (const std::uint32_t k : part) {
        const int x = int(k) % w, y = int(k) / w;
        for (int side = 0; side < 4; ++side) {
            const int dx = (side == 0) - (side == 1), dy = (side == 2) - (side == 3);
            const int u = x + dx, v = y + dy;
            if (u < 0 || v < 0 || u >= w || v >= h || inPart[surface.index(u, v)] != 0) continue;
            float low = surface.at(u, v);
            for (int step = 2; step <= reach; ++step)
                low = std::min(
                    low, surface.at(std::clamp(x + step * dx, 0, w - 1), std::clamp(y + step * dy, 0, h - 1)));
            ++outline;
            drops += surface.z[k] - low > s.roofDrop * s.meter;
        }
    }
    return outline > 0 && double(drops) >= double(s.roofEdge) * double(outline);
}

/// CellMarks what is larger than the window and stands out like a roof. `last`: what the openings left; `surface`:
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
        const bool roof = dropsAround(part, inPart, surface, s);
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
CellMarks objectsIn(const HeightGrid& heights, const HeightGrid& surface, float step, float slope,
                    const HeightGrid* extra, const BareSurfaceSettings& s, const Progress& progress)
{
    CellMarks objects(heights.z.size());
    GrowingOpenings openings(heights);
    HeightGrid last = heights;
    const int most = largestRadius(s);
    for (int radius = 1; radius <= most; ++radius) {
        const HeightGrid& opened = openings.next(progress);
        const float tolerance = step * s.meter + slope * float(radius) * s.cell;
        forRows(last.width, last.height, [&](int first, int end) {
            const std::size_t from = last.index(0, first), count = last.index(0, end) - from;
            markCut(objects.data() + from, last.z.data() + from, opened.z.data() + from, count, tolerance,
                    extra != nullptr ? extra->z.data() + from : nullptr);
        });
    }
    markLargeRoofs(objects, last, surface, s, progress);
    return objects;
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
    const HeightGrid first =
        withoutObjects(lowest, objectsIn(surface, surface, 0, s.slope, nullptr, s, progress), progress);

    HeightGrid above = first;  // above the trend
    blurGrid(above, cellsAlong(s.trendReach, s), progress);
    for (std::size_t k = 0; k < above.z.size(); ++k) above.z[k] = surface.z[k] - s.trendShare * above.z[k];
    HeightGrid extra = first;
    blurGrid(extra, cellsAlong(s.tolReach, s), progress);
    extra = slopesOf(extra, s.cell);
    for (float& v : extra.z) v *= s.trendSlope * s.meter;
    const CellMarks objects = objectsIn(above, surface, s.step, s.slope * s.slopeShare, &extra, s, progress);

    result.heights = withoutObjects(lowest, objects, progress);
    result.tolerance = slopesOf(result.heights, s.cell);
    for (float& v : result.tolerance.z) {
        const float beyond = std::max(0.0f, v - 1);
        v = s.threshold + (s.steepness * v + s.cliff * beyond * beyond) * s.meter;
    }
    return result;
}

}  // namespace punctum
