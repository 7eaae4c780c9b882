// SPDX-License-Identifier: MIT
#include "core/raster/Raster.h"

#include "core/Error.h"
#include "core/Text.h"
#include "core/cloud/PointCloud.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <functional>
#include <new>

namespace punctum
{

RasterFrame rasterFrame(const WorldBounds& bounds, double cell)
{
    if (!std::isfinite(cell) || cell <= 0.0) throw Error("The size of a cell must be more than 0.");
    if (bounds.empty()) throw Error("There are no points to make a map of.");
    constexpr double kFarthest = 0x1p50;  // cells from 0: whole numbers are exact, and so are halves
    const double west = std::floor(RasterFrame::inCells(bounds.min.x, cell)),
                 east = std::floor(RasterFrame::inCells(bounds.max.x, cell)) + 1.0,
                 south = std::floor(RasterFrame::inCells(bounds.min.y, cell)),
                 north = std::floor(RasterFrame::inCells(bounds.max.y, cell)) + 1.0;
    const double columns = east - west, rows = north - south;
    for (const double edge : {west, east, south, north})
        if (!(std::abs(edge) < kFarthest)) throw Error("The cells are too small for the extent of the points.");
    constexpr double kMost = double(RasterFrame::kMostCells);
    if (columns > kMost || rows > kMost || columns * rows > kMost)
        throw Error("The map would have " + grouped(std::uint64_t(std::min(columns, 1e15))) + " x " +
                    grouped(std::uint64_t(std::min(rows, 1e15))) + " cells, more than " +
                    grouped(RasterFrame::kMostCells) + "; take larger cells, or a part of the survey.");
    return {cell, std::int64_t(west), std::int64_t(north), std::size_t(columns), std::size_t(rows)};
}

RasterFrame widened(const RasterFrame& frame, std::size_t cells)
{
    RasterFrame wide = frame;
    wide.left -= std::int64_t(cells);
    wide.top += std::int64_t(cells);
    wide.columns += 2 * cells;
    wide.rows += 2 * cells;
    return wide;
}

Raster::Raster(const RasterFrame& frame, float value) : m_frame(frame)
{
    try {
        m_values.assign(frame.cells(), value);
    } catch (const std::bad_alloc&) {
        throw Error("There is not enough memory for a map of " + grouped(frame.columns) + " x " +
                    grouped(frame.rows) + " cells; take larger cells.");
    }
}

std::size_t Raster::count() const
{
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, m_values.size(), 1 << 16), std::size_t(0),
        [&](const auto& range, std::size_t n) {
            for (std::size_t i = range.begin(); i != range.end(); ++i) n += std::isnan(m_values[i]) ? 0 : 1;
            return n;
        },
        std::plus<>());
}

}  // namespace punctum
