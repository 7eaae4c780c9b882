// SPDX-License-Identifier: MIT
#include "render/resolve/HoleFill.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <limits>

namespace punctum::render
{

namespace
{

constexpr float kNone = std::numeric_limits<float>::infinity();
/// Neighbors up to so much farther than the nearest one belong to its surface; what lies farther is behind it.
constexpr float kSurface = 1.02f;
/// Of eight neighbors. Straight edges have three, corners of a hole five: so surfaces do not grow outward.
constexpr int kMostOf = 5;

struct Fill {
    std::size_t pixel, from;
};

}  // namespace

std::size_t fillHoles(std::vector<float>& depths, Image& image)
{
    const auto width = std::size_t(std::max(image.width, 0)), height = std::size_t(std::max(image.height, 0));
    if (width < 3 || height < 3 || depths.size() != width * height) return 0;
    std::size_t filled = 0;
    tbb::enumerable_thread_specific<std::vector<Fill>> found;
    for (int pass = 0; pass < kHoleReach; ++pass) {
        for (auto& list : found) list.clear();
        tbb::parallel_for(tbb::blocked_range<std::size_t>(1, height - 1, 16), [&](const auto& rows) {
            std::vector<Fill>& list = found.local();
            std::vector<float> nearest(width, kNone);
            for (std::size_t y = rows.begin(); y != rows.end(); ++y) {
                const float* const row = depths.data() + y * width;
                // A plain loop over the columns, which the compiler makes vectors of, finds the few candidates.
                for (std::size_t x = 0; x < width; ++x)
                    nearest[x] = std::min(std::min(row[x - width], row[x]), row[x + width]);
                for (std::size_t x = 1; x + 1 < width; ++x) {
                    const float front = std::min(std::min(nearest[x - 1], nearest[x + 1]),
                                                 std::min(row[x - width], row[x + width])) *
                                        kSurface;
                    if (!(front < row[x])) continue;
                    const std::size_t at = y * width + x;
                    const std::array<std::size_t, 8> around{at - width,     at - 1,         at + 1,
                                                            at + width,     at - width - 1, at - width + 1,
                                                            at + width - 1, at + width + 1};
                    int near = 0;
                    std::size_t from = at;
                    for (const std::size_t k : around) {
                        if (!(depths[k] <= front)) continue;
                        if (near++ == 0) from = k;
                    }
                    if (near >= kMostOf) list.push_back({at, from});
                }
            }
        });
        for (const auto& list : found) {
            for (const Fill& fill : list) {
                // `from` was not filled in this pass: a pixel that is filled lies behind, and would not be in
                // front.
                image.pixels[fill.pixel] = image.pixels[fill.from];
                depths[fill.pixel] = depths[fill.from];
            }
            filled += list.size();
        }
    }
    return filled;
}

}  // namespace punctum::render
