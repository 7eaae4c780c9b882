// SPDX-License-Identifier: MIT
#include "core/surface/HilbertOrder.h"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

namespace punctum
{

namespace
{

/// Place on the curve of a cell of 2^16 x 2^16.
std::uint32_t hilbertPlace(std::uint32_t x, std::uint32_t y) noexcept
{
    std::uint32_t place = 0;
    for (std::uint32_t side = 1u << 15; side != 0; side >>= 1) {
        const std::uint32_t right = (x & side) != 0, upper = (y & side) != 0;
        place = 4 * place + ((3 * right) ^ upper);
        if (upper == 0) {  // the curve in a lower quarter runs along a diagonal's other side
            if (right != 0) {
                x = ~x;
                y = ~y;
            }
            std::swap(x, y);
        }
    }
    return place;
}

}  // namespace

std::vector<std::uint32_t> hilbertOrder(std::span<const SurfacePoint> points)
{
    std::int64_t minX = INT32_MAX, maxX = INT32_MIN, minY = INT32_MAX, maxY = INT32_MIN;
    for (const SurfacePoint& p : points) {
        minX = std::min<std::int64_t>(minX, p.x);
        maxX = std::max<std::int64_t>(maxX, p.x);
        minY = std::min<std::int64_t>(minY, p.y);
        maxY = std::max<std::int64_t>(maxY, p.y);
    }
    const std::uint64_t side = points.empty() ? 0 : std::uint64_t(std::max(maxX - minX, maxY - minY));
    const int shift = std::max(0, int(std::bit_width(side)) - 16);

    // place in the upper half, number in the lower one
    std::vector<std::uint64_t> keys(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        const std::uint32_t x = std::uint32_t((points[i].x - minX) >> shift),
                            y = std::uint32_t((points[i].y - minY) >> shift);
        keys[i] = std::uint64_t(hilbertPlace(x, y)) << 32 | i;
    }
    if (keys.size() < 4096) {
        std::sort(keys.begin(), keys.end());
    } else {  // by digits, the last one first
        constexpr int kDigit = 11;
        std::vector<std::uint64_t> sorted(keys.size());
        for (int from = 32; from < 64; from += kDigit) {
            std::array<std::size_t, (1u << kDigit) + 1> starts{};
            const auto digit = [&](std::uint64_t key) { return (key >> from) & ((1u << kDigit) - 1); };
            for (const std::uint64_t key : keys) ++starts[digit(key) + 1];
            for (std::size_t d = 1; d < starts.size(); ++d) starts[d] += starts[d - 1];
            for (const std::uint64_t key : keys) sorted[starts[digit(key)]++] = key;
            keys.swap(sorted);
        }
    }
    std::vector<std::uint32_t> order(keys.size());
    std::transform(keys.begin(), keys.end(), order.begin(),
                   [](std::uint64_t key) { return std::uint32_t(key & UINT32_MAX); });
    return order;
}

}  // namespace punctum
