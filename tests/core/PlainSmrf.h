// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace punctum
{

/// The simple morphological filter as its paper has it, to compare with: Pingel, Clarke, McBride, An improved
/// simple morphological filter for the terrain classification of airborne LIDAR data (2013). No net over large
/// roofs, since its one set of parameters has none. Plain loops in one thread.
namespace plain_smrf
{

struct Settings {
    double cell = 1, slope = 0.15, window = 18, threshold = 0.5, scalar = 1.25;  // meters
};

struct Grid {
    int width = 0, height = 0;
    std::vector<float> z;  ///< NaN: none
    float& at(int x, int y) { return z[std::size_t(y) * std::size_t(width) + std::size_t(x)]; }
    float at(int x, int y) const { return z[std::size_t(y) * std::size_t(width) + std::size_t(x)]; }
};

/// Springs between neighboring cells hold up what is empty: coarse grids first, then each value is the mean of its
/// four neighbors, again and again.
inline void inpaint(Grid& grid)
{
    const std::vector<float> given = grid.z;
    if (grid.width > 1 || grid.height > 1) {
        Grid half{(grid.width + 1) / 2, (grid.height + 1) / 2, {}};
        half.z.assign(std::size_t(half.width) * std::size_t(half.height), 0);
        std::vector<int> counts(half.z.size());
        for (int y = 0; y < grid.height; ++y)
            for (int x = 0; x < grid.width; ++x)
                if (!std::isnan(grid.at(x, y))) {
                    half.at(x / 2, y / 2) += grid.at(x, y);
                    ++counts[std::size_t(y / 2) * std::size_t(half.width) + std::size_t(x / 2)];
                }
        bool any = false;
        for (std::size_t k = 0; k < counts.size(); ++k) {
            half.z[k] = counts[k] > 0 ? half.z[k] / float(counts[k]) : std::numeric_limits<float>::quiet_NaN();
            any = any || counts[k] > 0;
        }
        if (!any) return;
        inpaint(half);
        for (int y = 0; y < grid.height; ++y)
            for (int x = 0; x < grid.width; ++x)
                if (std::isnan(grid.at(x, y))) grid.at(x, y) = half.at(x / 2, y / 2);
    }
    for (int round = 0; round < 24; ++round)
        for (int y = 0; y < grid.height; ++y)
            for (int x = 0; x < grid.width; ++x) {
                if (!std::isnan(given[std::size_t(y) * std::size_t(grid.width) + std::size_t(x)])) continue;
                float sum = 0;
                int n = 0;
                for (int k = 0; k < 4; ++k) {
                    const int u = x + (k == 0) - (k == 1), v = y + (k == 2) - (k == 3);
                    if (u < 0 || v < 0 || u >= grid.width || v >= grid.height) continue;
                    sum += grid.at(u, v);
                    ++n;
                }
                if (n > 0) grid.at(x, y) = sum / float(n);
            }
}

/// The least (sign 1) or greatest (sign -1) values in a disk.
inline Grid extreme(const Grid& from, int radius, float sign)
{
    Grid to = from;
    for (int dy = -radius; dy <= radius; ++dy) {
        const int half = int(std::sqrt(double(radius * radius - dy * dy)));
        for (int y = 0; y < from.height; ++y) {
            if (y + dy < 0 || y + dy >= from.height) continue;
            // monotone queue along the row
            std::vector<int> queue;
            std::size_t head = 0;
            int next = 0;
            for (int x = 0; x < from.width; ++x) {
                for (; next <= std::min(from.width - 1, x + half); ++next) {
                    while (queue.size() > head &&
                           sign * from.at(queue.back(), y + dy) >= sign * from.at(next, y + dy))
                        queue.pop_back();
                    queue.push_back(next);
                }
                while (queue[head] < x - half) ++head;
                const float value = from.at(queue[head], y + dy);
                if (sign * value < sign * to.at(x, y)) to.at(x, y) = value;
            }
        }
    }
    return to;
}

inline std::vector<char> progressive(Grid surface, double slope, int radius, double cell)
{
    std::vector<char> object(surface.z.size());
    for (int r = 1; r <= radius; ++r) {
        const Grid opened = extreme(extreme(surface, r, 1), r, -1);
        for (std::size_t k = 0; k < object.size(); ++k)
            if (surface.z[k] - opened.z[k] > float(slope * r * cell)) object[k] = 1;
        surface = opened;
    }
    return object;
}

/// Which of the points (coordinates in meters; `used`: null, or those that are looked at) are ground.
inline std::vector<char> classify(const std::vector<double>& x, const std::vector<double>& y,
                                  const std::vector<double>& z, const Settings& s = {},
                                  const std::vector<char>* used = nullptr)
{
    std::vector<char> ground(x.size());
    if (x.empty()) return ground;
    const double left = std::floor(*std::min_element(x.begin(), x.end()) / s.cell) * s.cell;
    const double bottom = std::floor(*std::min_element(y.begin(), y.end()) / s.cell) * s.cell;
    Grid low{int((*std::max_element(x.begin(), x.end()) - left) / s.cell) + 1,
             int((*std::max_element(y.begin(), y.end()) - bottom) / s.cell) + 1,
             {}};
    low.z.assign(std::size_t(low.width) * std::size_t(low.height), std::numeric_limits<float>::quiet_NaN());
    const double base = z[0];
    for (std::size_t i = 0; i < x.size(); ++i) {
        if (used != nullptr && !(*used)[i]) continue;
        float& cell = low.at(int((x[i] - left) / s.cell), int((y[i] - bottom) / s.cell));
        if (!(cell <= float(z[i] - base))) cell = float(z[i] - base);
    }
    Grid surface = low;
    inpaint(surface);
    Grid turned = surface;
    for (float& v : turned.z) v = -v;
    const std::vector<char> lows = progressive(turned, 5, 1, s.cell);
    const std::vector<char> objects = progressive(surface, s.slope, int(std::ceil(s.window / s.cell)), s.cell);
    for (std::size_t k = 0; k < low.z.size(); ++k)
        if (lows[k] || objects[k]) low.z[k] = std::numeric_limits<float>::quiet_NaN();
    inpaint(low);
    Grid steep = low;
    for (int v = 0; v < low.height; ++v)
        for (int u = 0; u < low.width; ++u) {
            const int l = std::max(0, u - 1), r = std::min(low.width - 1, u + 1), b = std::max(0, v - 1),
                      t = std::min(low.height - 1, v + 1);
            const double gx = r > l ? double(low.at(r, v) - low.at(l, v)) / (r - l) / s.cell : 0;
            const double gy = t > b ? double(low.at(u, t) - low.at(u, b)) / (t - b) / s.cell : 0;
            steep.at(u, v) = float(std::sqrt(gx * gx + gy * gy));
        }
    const auto between = [&](const Grid& grid, double px, double py) {
        const double u = std::clamp((px - left) / s.cell - 0.5, 0.0, double(grid.width - 1));
        const double v = std::clamp((py - bottom) / s.cell - 0.5, 0.0, double(grid.height - 1));
        const int a = std::min(int(u), std::max(0, grid.width - 2)),
                  b = std::min(int(v), std::max(0, grid.height - 2));
        const int c = std::min(a + 1, grid.width - 1), d = std::min(b + 1, grid.height - 1);
        const double fu = u - a, fv = v - b;
        return (1 - fv) * ((1 - fu) * double(grid.at(a, b)) + fu * double(grid.at(c, b))) +
               fv * ((1 - fu) * double(grid.at(a, d)) + fu * double(grid.at(c, d)));
    };
    for (std::size_t i = 0; i < x.size(); ++i) {
        if (used != nullptr && !(*used)[i]) continue;
        const double away = std::abs(z[i] - base - between(low, x[i], y[i]));
        ground[i] = away <= s.threshold + s.scalar * between(steep, x[i], y[i]);
    }
    return ground;
}

}  // namespace plain_smrf

}  // namespace punctum
