// SPDX-License-Identifier: MIT
#include "core/ground/GroundSurface.h"

#include "core/task/Progress.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace punctum
{

namespace
{

constexpr std::int64_t kGroundWindow = 1024;  ///< cells that one window decides about, along a side
constexpr std::int64_t kGroundAtOnce = 1536;  ///< a survey that fits is one window

struct CellSpan {
    std::int64_t low = INT64_MAX, high = INT64_MIN;  ///< cells; high past the last
    void include(std::int64_t first, std::int64_t last)
    {
        low = std::min(low, first);
        high = std::max(high, last);
    }
    std::int64_t size() const { return high - low; }
};

/// The box of the squares that meet a box of cells, cut to it.
std::pair<CellSpan, CellSpan> squareBoxOf(const LowestPoints& lowest, const CellSpan& x, const CellSpan& y)
{
    constexpr std::int64_t side = LowestPoints::kSide;
    CellSpan across, up;
    const auto& squares = lowest.squares();
    const std::int64_t first = LowestPoints::squareOf(x.low), last = LowestPoints::squareOf(x.high - 1);
    for (auto s = std::lower_bound(squares.begin(), squares.end(), LowestPoints::Square{first, INT64_MIN});
         s != squares.end() && s->x <= last; ++s) {
        if ((s->y + 1) * side <= y.low || s->y * side >= y.high) continue;
        across.include(std::max(x.low, s->x * side), std::min(x.high, (s->x + 1) * side));
        up.include(std::max(y.low, s->y * side), std::min(y.high, (s->y + 1) * side));
    }
    return {across, up};
}

struct CellBox {
    int x = 0, y = 0, width = 0, height = 0;
};

/// Of the cells that have a height.
CellBox boxOfHeights(const HeightGrid& grid)
{
    int left = grid.width, right = -1, low = grid.height, high = -1;
    for (int y = 0; y < grid.height; ++y)
        for (int x = 0; x < grid.width; ++x) {
            if (std::isnan(grid.at(x, y))) continue;
            left = std::min(left, x);
            right = std::max(right, x);
            low = std::min(low, y);
            high = y;
        }
    return {left, low, right - left + 1, high - low + 1};
}

HeightGrid cutTo(const HeightGrid& grid, const CellBox& box)
{
    HeightGrid cut(box.width, box.height, 0);
    for (int y = 0; y < box.height; ++y)
        std::copy_n(grid.row(box.y + y) + box.x, std::size_t(box.width), cut.row(y));
    return cut;
}

std::int64_t windowOf(std::int64_t square)
{
    constexpr std::int64_t squares = kGroundWindow / LowestPoints::kSide;
    return square >= 0 ? square / squares : -((-square + squares - 1) / squares);
}

}  // namespace

GroundSurface::GroundSurface(const LowestPoints& lowest, const BareSurfaceSettings& settings, Progress& progress)
    : m_lowest(&lowest), m_values(lowest.squares().size() * 2 * kValues)
{
    constexpr std::int64_t side = LowestPoints::kSide;
    CellSpan x, y;
    for (const LowestPoints::Square& s : lowest.squares()) {
        x.include(s.x * side, (s.x + 1) * side);
        y.include(s.y * side, (s.y + 1) * side);
    }
    if (lowest.squares().empty()) return;
    if (x.size() <= kGroundAtOnce && y.size() <= kGroundAtOnce) {
        progress.begin("Finding the bare surface", 1);
        solve(x.low, y.low, kGroundAtOnce, settings, progress);
        return;
    }
    std::set<std::pair<std::int64_t, std::int64_t>> windows;
    for (const LowestPoints::Square& s : lowest.squares()) windows.emplace(windowOf(s.x), windowOf(s.y));
    progress.begin("Finding the bare surface", windows.size());
    for (const auto& [wx, wy] : windows) {
        solve(wx * kGroundWindow, wy * kGroundWindow, kGroundWindow, settings, progress);
        progress.add(1);
    }
}

void GroundSurface::solve(std::int64_t x, std::int64_t y, std::int64_t side, const BareSurfaceSettings& settings,
                          const Progress& progress)
{
    const std::int64_t reach = reachInCells(settings);
    auto [across, up] = squareBoxOf(*m_lowest, {x - reach, x + side + reach}, {y - reach, y + side + reach});
    if (across.size() <= 0) return;
    HeightGrid lowest = m_lowest->window(across.low, up.low, int(across.size()), int(up.size()));
    const CellBox box = boxOfHeights(lowest);
    if (box.width <= 0) return;
    // Beyond the outermost points there is nothing to be found; springs would carry roofs at the rim on there.
    lowest = cutTo(lowest, box);
    across.low += box.x;
    up.low += box.y;
    const std::int64_t firstColumn = across.low, firstRow = up.low;
    const int width = box.width, height = box.height;
    const BareSurface surface = bareSurface(std::move(lowest), settings, progress);
    const auto& squares = m_lowest->squares();
    tbb::parallel_for(std::size_t(0), squares.size(), [&](std::size_t k) {
        const std::int64_t left = squares[k].x * LowestPoints::kSide, low = squares[k].y * LowestPoints::kSide;
        if (left < x || left >= x + side || low < y || low >= y + side) return;
        float* const heights = m_values.data() + k * 2 * kValues;
        for (int v = 0; v < kWide; ++v)
            for (int u = 0; u < kWide; ++u) {
                const int gx = int(std::clamp<std::int64_t>(left - 1 + u - firstColumn, 0, width - 1));
                const int gy = int(std::clamp<std::int64_t>(low - 1 + v - firstRow, 0, height - 1));
                const std::size_t to = std::size_t(v) * std::size_t(kWide) + std::size_t(u);
                heights[to] = surface.heights.at(gx, gy);
                heights[kValues + to] = surface.tolerance.at(gx, gy);
            }
    });
}

bool GroundSurface::Asker::isGround(PointIndex point)
{
    const LowestPoints& lowest = *m_surface->m_lowest;
    const LowestPoints::Place at = lowest.place(point);
    const LowestPoints::Square square = LowestPoints::squareOf(at);
    if (!(square == m_square)) {
        m_square = square;
        m_values = m_surface->m_values.data() + lowest.find(square) * 2 * kValues;
    }
    const float u = float(at.u + 1), v = float(at.v + 1);  // in the square with its rim
    const int a = std::clamp(int(u), 0, kWide - 2), b = std::clamp(int(v), 0, kWide - 2);
    const float fu = u - float(a), fv = v - float(b);
    const float* const z = m_values + std::size_t(b) * std::size_t(kWide) + std::size_t(a);
    const auto between = [&](const float* f) {
        return (1 - fv) * ((1 - fu) * f[0] + fu * f[1]) + fv * ((1 - fu) * f[kWide] + fu * f[kWide + 1]);
    };
    return std::abs(lowest.height(point) - between(z)) <= between(z + kValues);
}

}  // namespace punctum
