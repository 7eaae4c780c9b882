// SPDX-License-Identifier: MIT
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

namespace punctum
{

/// Heights of square cells, row by row; NaN: none. A plain value.
struct HeightGrid {
    int width = 0, height = 0;
    std::vector<float> z{};

    static constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

    HeightGrid() = default;
    HeightGrid(int w, int h, float value) : width(w), height(h), z(std::size_t(w) * std::size_t(h), value) {}
    std::size_t index(int x, int y) const noexcept { return std::size_t(y) * std::size_t(width) + std::size_t(x); }
    float* row(int y) noexcept { return z.data() + index(0, y); }
    const float* row(int y) const noexcept { return z.data() + index(0, y); }
    float& at(int x, int y) noexcept { return z[index(x, y)]; }
    float at(int x, int y) const noexcept { return z[index(x, y)]; }
};

/// Calls f(first, last) for rows, in parallel, some thousands of cells at a time.
template <typename F>
void forRows(int width, int height, const F& f)
{
    const int rows = std::max(1, 16384 / std::max(1, width));
    const int bands = (height + rows - 1) / rows;
    tbb::parallel_for(0, bands, [&](int band) { f(band * rows, std::min(height, (band + 1) * rows)); });
}

}  // namespace punctum
