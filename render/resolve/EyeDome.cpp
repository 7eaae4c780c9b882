// SPDX-License-Identifier: MIT
#include "render/resolve/EyeDome.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace punctum::render
{

namespace
{

constexpr float kNone = std::numeric_limits<float>::infinity();
constexpr std::size_t kRangeSamples = 4096;
constexpr float kLowShare = 0.02f, kHighShare = 0.98f;
/// Darkness for a step of the whole depth range; what looks right on surveys, rooms and trees.
constexpr float kSteepness = 14.0f;
constexpr float kDarkest = 0.15f;

/// Eight neighbors, on a square.
constexpr std::array<std::array<int, 2>, 8> kNeighbors{
    {{-1, -1}, {0, -1}, {1, -1}, {-1, 0}, {1, 0}, {-1, 1}, {0, 1}, {1, 1}}};

/// Extent of the values in the picture without its outliers; 0 when there are none.
float robustExtent(std::span<const float> values)
{
    std::vector<float> sample;
    const std::size_t step = std::max<std::size_t>(1, values.size() / kRangeSamples);
    for (std::size_t k = 0; k < values.size(); k += step)
        if (values[k] != kNone) sample.push_back(values[k]);
    if (sample.size() < 2) return 0;
    const auto at = [&](float share) {
        const auto it = sample.begin() + std::ptrdiff_t(share * float(sample.size() - 1));
        std::nth_element(sample.begin(), it, sample.end());
        return *it;
    };
    const float low = at(kLowShare);
    return at(kHighShare) - low;
}

}  // namespace

void shadeEyeDome(std::span<const float> depths, bool perspective, float strength, double pointSize, Image& image)
{
    const int width = image.width, height = image.height;
    if (strength <= 0 || depths.size() != image.pixels.size() || depths.empty()) return;
    const int radius = std::max(1, int(std::lround(pointSize)));
    std::vector<float> levels(depths.begin(), depths.end());
    if (perspective)
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, levels.size(), 1 << 14), [&](const auto& r) {
            for (std::size_t k = r.begin(); k != r.end(); ++k)
                if (levels[k] != kNone) levels[k] = std::log2(std::max(levels[k], 1e-6f));
        });
    const float extent = robustExtent(levels);
    if (!(extent > 0)) return;
    const float scale = kSteepness * strength / (extent * float(2 * kNeighbors.size()));

    tbb::parallel_for(tbb::blocked_range<int>(0, height, 8), [&](const tbb::blocked_range<int>& rows) {
        for (int y = rows.begin(); y != rows.end(); ++y)
            for (int x = 0; x < width; ++x) {
                const std::size_t k = std::size_t(y) * std::size_t(width) + std::size_t(x);
                const float level = levels[k];
                if (level == kNone) continue;
                float behind = 0;
                for (const int reach : {radius, 2 * radius})  // edges near by, and shapes
                    for (const auto& [dx, dy] : kNeighbors) {
                        const int nx = x + dx * reach, ny = y + dy * reach;
                        if (nx < 0 || ny < 0 || nx >= width || ny >= height) continue;
                        const float other = levels[std::size_t(ny) * std::size_t(width) + std::size_t(nx)];
                        if (other < level) behind += std::min(level - other, extent);
                    }
                const float shade = kDarkest + (1 - kDarkest) * std::exp(-behind * scale);
                Rgba8& c = image.pixels[k];
                const auto dim = [shade](std::uint8_t v) { return std::uint8_t(float(v) * shade + 0.5f); };
                c = {dim(c.r), dim(c.g), dim(c.b), c.a};
            }
    });
}

}  // namespace punctum::render
