// SPDX-License-Identifier: MIT
#include "core/ground/GridFilling.h"

#include "core/task/Progress.h"

#include <cmath>
#include <cstdint>

namespace punctum
{

namespace
{

constexpr int kRelaxingRounds = 10;      ///< on each scale; more change nothing that a classification sees
constexpr float kOverRelaxation = 1.4f;  ///< between 1 (plain) and 2 (unstable)
constexpr std::size_t kHolesAtOnce = 8192;

template <typename F>
void forHoles(const std::vector<std::uint32_t>& holes, const F& f)
{
    const std::size_t pieces = (holes.size() + kHolesAtOnce - 1) / kHolesAtOnce;
    tbb::parallel_for(std::size_t(0), pieces, [&](std::size_t piece) {
        const std::size_t last = std::min(holes.size(), (piece + 1) * kHolesAtOnce);
        for (std::size_t k = piece * kHolesAtOnce; k < last; ++k) f(holes[k]);
    });
}

/// Means of two by two cells.
HeightGrid halvedGrid(const HeightGrid& grid)
{
    HeightGrid half((grid.width + 1) / 2, (grid.height + 1) / 2, HeightGrid::kNone);
    forRows(half.width, half.height, [&](int first, int last) {
        for (int y = first; y < last; ++y)
            for (int x = 0; x < half.width; ++x) {
                float sum = 0;
                int count = 0;
                for (int v = 2 * y; v < std::min(2 * y + 2, grid.height); ++v)
                    for (int u = 2 * x; u < std::min(2 * x + 2, grid.width); ++u)
                        if (!std::isnan(grid.at(u, v))) {
                            sum += grid.at(u, v);
                            ++count;
                        }
                if (count > 0) half.at(x, y) = sum / float(count);
            }
    });
    return half;
}

/// The height of a coarse grid at a cell of the fine one.
float fromHalf(const HeightGrid& half, int x, int y)
{
    const float u = std::clamp((float(x) - 0.5f) / 2, 0.0f, float(half.width - 1));
    const float v = std::clamp((float(y) - 0.5f) / 2, 0.0f, float(half.height - 1));
    const int a = int(u), b = int(v), c = std::min(a + 1, half.width - 1), d = std::min(b + 1, half.height - 1);
    const float fu = u - float(a), fv = v - float(b);
    return (1 - fv) * ((1 - fu) * half.at(a, b) + fu * half.at(c, b)) +
           fv * ((1 - fu) * half.at(a, d) + fu * half.at(c, d));
}

/// A cell that has not all four neighbors.
void relaxAtRim(HeightGrid& grid, std::uint32_t k)
{
    const auto width = std::uint32_t(grid.width), height = std::uint32_t(grid.height);
    const std::uint32_t x = k % width, y = k / width;
    float sum = 0;
    int count = 0;
    if (x > 0) sum += grid.z[k - 1], ++count;
    if (x + 1 < width) sum += grid.z[k + 1], ++count;
    if (y > 0) sum += grid.z[k - width], ++count;
    if (y + 1 < height) sum += grid.z[k + width], ++count;
    grid.z[k] += kOverRelaxation * (sum / float(count) - grid.z[k]);
}

}  // namespace

void fillHoles(HeightGrid& grid, const Progress& progress)
{
    progress.check();
    const auto width = std::uint32_t(grid.width), height = std::uint32_t(grid.height);
    // Cells of one color of a chess board have neighbors of the other alone, so that order and threads do not
    // matter.
    std::vector<std::uint32_t> inside[2], rim[2];
    std::size_t count = 0;
    for (std::uint32_t y = 0, k = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x, ++k) {
            if (!std::isnan(grid.z[k])) continue;
            const bool within = x > 0 && y > 0 && x + 1 < width && y + 1 < height;
            (within ? inside : rim)[(x + y) % 2].push_back(k);
            ++count;
        }
    if (count == grid.z.size() || count == 0) return;
    HeightGrid half = halvedGrid(grid);
    fillHoles(half, progress);
    forRows(grid.width, grid.height, [&](int first, int last) {
        for (int y = first; y < last; ++y)
            for (int x = 0; x < grid.width; ++x)
                if (std::isnan(grid.at(x, y))) grid.at(x, y) = fromHalf(half, x, y);
    });
    for (int round = 0; round < kRelaxingRounds; ++round) {
        progress.check();
        for (int color = 0; color < 2; ++color) {
            forHoles(inside[color], [&](std::uint32_t k) {
                float* const z = grid.z.data() + k;
                const float sum = z[-1] + z[1] + *(z - width) + z[width];
                *z += kOverRelaxation * (sum / 4 - *z);
            });
            forHoles(rim[color], [&](std::uint32_t k) { relaxAtRim(grid, k); });
        }
    }
}

HeightGrid slopesOf(const HeightGrid& grid, float cell)
{
    HeightGrid slopes(grid.width, grid.height, 0);
    forRows(grid.width, grid.height, [&](int first, int last) {
        for (int y = first; y < last; ++y) {
            const int below = std::max(0, y - 1), above = std::min(grid.height - 1, y + 1);
            for (int x = 0; x < grid.width; ++x) {
                const int left = std::max(0, x - 1), right = std::min(grid.width - 1, x + 1);
                const float along =
                    right > left ? (grid.at(right, y) - grid.at(left, y)) / (float(right - left) * cell) : 0;
                const float across =
                    above > below ? (grid.at(x, above) - grid.at(x, below)) / (float(above - below) * cell) : 0;
                slopes.at(x, y) = std::sqrt(along * along + across * across);
            }
        }
    });
    return slopes;
}

void blurGrid(HeightGrid& grid, int reach, const Progress& progress)
{
    if (reach < 1) return;
    HeightGrid spare = grid;
    const int w = grid.width, h = grid.height;
    for (int round = 0; round < 3; ++round) {
        progress.check();
        forRows(w, h, [&](int first, int last) {
            for (int y = first; y < last; ++y) {
                const float* const from = grid.row(y);
                float* const to = spare.row(y);
                double sum = 0;  // a running sum; doubles forget nothing of it
                int count = 0;
                for (int x = -reach; x < w; ++x) {
                    if (x + reach < w) sum += double(from[x + reach]), ++count;
                    if (x - reach - 1 >= 0) sum -= double(from[x - reach - 1]), --count;
                    if (x >= 0) to[x] = float(sum / count);
                }
            }
        });
        progress.check();
        // columns in stripes of neighboring ones, so that the cache helps
        constexpr int kStripe = 64;
        tbb::parallel_for(0, (w + kStripe - 1) / kStripe, [&](int stripe) {
            const int left = stripe * kStripe, width = std::min(kStripe, w - left);
            std::vector<double> sums(std::size_t(width), 0.0);
            int count = 0;
            for (int y = -reach; y < h; ++y) {
                if (y + reach < h) {
                    const float* const row = spare.row(y + reach) + left;
                    for (int x = 0; x < width; ++x) sums[std::size_t(x)] += double(row[x]);
                    ++count;
                }
                if (y - reach - 1 >= 0) {
                    const float* const row = spare.row(y - reach - 1) + left;
                    for (int x = 0; x < width; ++x) sums[std::size_t(x)] -= double(row[x]);
                    --count;
                }
                if (y < 0) continue;
                float* const out = grid.row(y) + left;
                for (int x = 0; x < width; ++x) out[x] = float(sums[std::size_t(x)] / count);
            }
        });
    }
}

}  // namespace punctum
