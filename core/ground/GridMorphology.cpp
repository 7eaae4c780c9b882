// SPDX-License-Identifier: MIT
#include "core/ground/GridMorphology.h"

#include "core/task/Progress.h"

#include <utility>

namespace punctum
{

namespace
{

struct LowerHeight {
    static float of(float a, float b) noexcept { return b < a ? b : a; }
};
struct HigherHeight {
    static float of(float a, float b) noexcept { return b > a ? b : a; }
};

/// Each cell gets the extreme of itself and its four or (`square`) eight neighbors.
template <typename Extreme>
void stepGridTo(HeightGrid& to, const HeightGrid& from, bool square)
{
    const int w = from.width, h = from.height;
    forRows(w, h, [&](int first, int last) {
        std::vector<float> upright(std::size_t(w), 0.0f);
        for (int y = first; y < last; ++y) {
            const float* const mid = from.row(y);
            const float* const below = from.row(std::max(0, y - 1));
            const float* const above = from.row(std::min(h - 1, y + 1));
            float* const out = to.row(y);
            float* const column = upright.data();
            for (int x = 0; x < w; ++x) column[x] = Extreme::of(mid[x], Extreme::of(below[x], above[x]));
            const float* const side = square ? column : mid;
            for (int x = 1; x < w - 1; ++x) out[x] = Extreme::of(column[x], Extreme::of(side[x - 1], side[x + 1]));
            out[0] = w > 1 ? Extreme::of(column[0], side[1]) : column[0];
            if (w > 1) out[w - 1] = Extreme::of(column[w - 1], side[w - 2]);
        }
    });
}

template <typename Extreme>
void growGridBy(HeightGrid& grid, HeightGrid& spare, int radius, const Progress& progress)
{
    for (int step = 0; step < radius; ++step) {
        progress.check();
        stepGridTo<Extreme>(spare, grid, step % 2 == 1);
        std::swap(spare.z, grid.z);
    }
}

}  // namespace

HeightGrid openedBy(const HeightGrid& grid, int radius, const Progress& progress)
{
    HeightGrid result = grid, spare = grid;
    growGridBy<LowerHeight>(result, spare, radius, progress);
    growGridBy<HigherHeight>(result, spare, radius, progress);
    return result;
}

HeightGrid closedBy(const HeightGrid& grid, int radius, const Progress& progress)
{
    HeightGrid result = grid, spare = grid;
    growGridBy<HigherHeight>(result, spare, radius, progress);
    growGridBy<LowerHeight>(result, spare, radius, progress);
    return result;
}

}  // namespace punctum
