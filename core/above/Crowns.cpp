// SPDX-License-Identifier: MIT
#include "core/above/Crowns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace punctum
{

namespace
{

constexpr float kNoHeight = -1;           ///< height of a cell without points
constexpr std::size_t kFewAround = 4;     ///< neighbors with points from which a hole is filled
constexpr std::int32_t kMostWindow = 63;  ///< of a window or a blur, in cells: what CellGrid::beside() can tell

template <typename F>
void forCellsAround(const CellGrid& grid, std::size_t cell, std::int32_t reach, F&& f)
{
    for (std::int32_t dy = -reach; dy <= reach; ++dy)
        for (std::int32_t dx = -reach; dx <= reach; ++dx) {
            const std::size_t other = grid.beside(cell, dx, dy);
            if (other != CellGrid::kNone) f(other, dx, dy);
        }
}

/// Holes of single cells take the mean of what is around them; what is deep below all around it, too (pits, where a
/// beam went through a crown).
std::vector<float> withoutPits(const CellGrid& grid, const std::vector<float>& surface, Progress& progress)
{
    std::vector<float> filled(surface.size(), kNoHeight);
    grid.forCells(progress, [&](std::size_t cell) {
        std::array<float, 8> around;
        std::size_t count = 0;
        forCellsAround(grid, cell, 1, [&](std::size_t other, std::int32_t, std::int32_t) {
            if (other != cell && !std::isnan(surface[other])) around[count++] = surface[other];
        });
        const float own = surface[cell];
        filled[cell] = std::isnan(own) ? kNoHeight : own;
        if (count < kFewAround) return;
        std::sort(around.begin(), around.begin() + std::ptrdiff_t(count));
        const float middle = around[count / 2];
        if (std::isnan(own) || (count >= 6 && own < around[1] && own < middle * 0.7f)) filled[cell] = middle;
    });
    return filled;
}

std::vector<float> blurredSurface(const CellGrid& grid, const std::vector<float>& surface, double deviation,
                                  Progress& progress)
{
    const double cells = deviation / grid.size();
    const std::int32_t reach = std::min(kMostWindow, std::int32_t(std::ceil(2 * cells)));
    if (cells < 0.2) return surface;
    std::vector<float> weights;
    for (std::int32_t d = -reach; d <= reach; ++d)
        weights.push_back(float(std::exp(-double(d * d) / (2 * cells * cells))));
    std::vector<float> result(surface.size(), kNoHeight);
    grid.forCells(progress, [&](std::size_t cell) {
        if (surface[cell] < 0) return;
        float sum = 0, weight = 0;
        forCellsAround(grid, cell, reach, [&](std::size_t other, std::int32_t dx, std::int32_t dy) {
            if (surface[other] < 0) return;
            const std::int32_t column = dx + reach, row = dy + reach;
            const float w = weights[std::size_t(column)] * weights[std::size_t(row)];
            sum += w * surface[other];
            weight += w;
        });
        result[cell] = sum / weight;
    });
    return result;
}

}  // namespace

Crowns findCrowns(const CellGrid& grid, const std::vector<float>& surface, const CrownOptions& options,
                  Progress& progress)
{
    progress.begin("Finding tops", 3 * grid.cells());
    const std::vector<float> height =
        blurredSurface(grid, withoutPits(grid, surface, progress), options.smoothing, progress);
    progress.add(grid.cells());
    const auto higher = [&](std::size_t a, std::size_t b) {
        return height[a] != height[b] ? height[a] > height[b] : grid.place(a) < grid.place(b);
    };
    const auto least = float(options.leastHeight);

    // Where each cell leads: to its highest neighbor; from the highest one around, to the highest of the window;
    // from a top nowhere.
    std::vector<std::size_t> upward(grid.cells(), CellGrid::kNone);
    grid.forCells(progress, [&](std::size_t cell) {
        if (height[cell] < least) return;
        std::size_t best = cell;
        forCellsAround(grid, cell, 1, [&](std::size_t other, std::int32_t, std::int32_t) {
            if (height[other] >= least && higher(other, best)) best = other;
        });
        if (best == cell) {
            const double radius = (options.window + options.windowGrowth * double(height[cell])) / grid.size();
            const std::int32_t reach = std::min(kMostWindow, std::int32_t(radius));
            forCellsAround(grid, cell, reach, [&](std::size_t other, std::int32_t dx, std::int32_t dy) {
                if (double(dx * dx + dy * dy) <= radius * radius && height[other] >= least && higher(other, best))
                    best = other;
            });
        }
        upward[cell] = best;
    });
    progress.add(grid.cells());

    Crowns crowns;
    for (std::size_t cell = 0; cell < grid.cells(); ++cell) {
        if (cell % (1 << 20) == 0) progress.check();
        if (upward[cell] == cell) crowns.tops.push_back(cell);
    }
    std::sort(crowns.tops.begin(), crowns.tops.end(), [&](std::size_t a, std::size_t b) {
        const auto pa = grid.place(a), pb = grid.place(b);
        return std::array{pa[1], pa[0]} < std::array{pb[1], pb[0]};
    });
    crowns.crownOf.assign(grid.cells(), kNoCrown);
    for (std::size_t k = 0; k < crowns.tops.size(); ++k) crowns.crownOf[crowns.tops[k]] = std::uint32_t(k);
    std::vector<std::uint32_t> found(grid.cells(), kNoCrown);
    grid.forCells(progress, [&](std::size_t cell) {
        if (upward[cell] == CellGrid::kNone) return;
        std::size_t top = cell;
        while (upward[top] != top) top = upward[top];
        const auto a = grid.place(cell), b = grid.place(top);
        const double dx = double(a[0] - b[0]) * grid.size(), dy = double(a[1] - b[1]) * grid.size();
        if (dx * dx + dy * dy > options.widest * options.widest) return;
        if (double(height[cell]) < options.leastShare * double(height[top])) return;
        found[cell] = crowns.crownOf[top];
    });
    crowns.crownOf = std::move(found);
    progress.add(grid.cells());
    return crowns;
}

}  // namespace punctum
