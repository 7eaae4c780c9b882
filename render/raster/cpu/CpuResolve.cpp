// SPDX-License-Identifier: MIT
#include "render/raster/cpu/CpuResolve.h"

#include "render/resolve/Background.h"
#include "render/resolve/EyeDome.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cstdint>
#include <vector>

namespace punctum::render
{

namespace
{

constexpr std::size_t kWordsAhead = 64;

Rgba8 average(const Rgba8* colors, std::uint32_t count) noexcept
{
    std::uint32_t r = 0, g = 0, b = 0, a = 0;
    for (std::uint32_t k = 0; k < count; ++k) {
        r += colors[k].r * std::uint32_t(colors[k].a);
        g += colors[k].g * std::uint32_t(colors[k].a);
        b += colors[k].b * std::uint32_t(colors[k].a);
        a += colors[k].a;
    }
    if (a == 0) return {0, 0, 0, 0};
    return {std::uint8_t((r + a / 2) / a), std::uint8_t((g + a / 2) / a), std::uint8_t((b + a / 2) / a),
            std::uint8_t((a + count / 2) / count)};
}

Rgba8 mean(const CpuSums::Sum& sum) noexcept
{
    const std::uint64_t count = std::uint32_t(sum.blueCount);
    const auto part = [count](std::uint64_t total) { return std::uint8_t((total + count / 2) / count); };
    return {part(sum.redGreen >> 32), part(std::uint32_t(sum.redGreen)), part(sum.blueCount >> 32), 255};
}

}  // namespace

void resolveCells(std::span<const std::uint64_t> cells, std::span<const CpuSums::Sum> sums, const TargetSize& size,
                  const FrameScene& scene, const ResolveSettings& settings, Image& out)
{
    out.resize(size.width, size.height);
    const auto samples = std::size_t(size.samples);
    const std::size_t rowCells = std::size_t(size.width) * samples;
    std::vector<const std::uint32_t*> words;  // of each layer
    for (const Layer& layer : scene.layers) words.push_back(layer.store->words().data());
    const EyeDomeShades shades(cells, size, settings.eyeDome);
    tbb::parallel_for(tbb::blocked_range<int>(0, size.height, 8), [&](const tbb::blocked_range<int>& rows) {
        std::vector<Rgba8> colors(samples > 1 ? rowCells : 0);
        std::vector<float> shade;
        for (int y = rows.begin(); y != rows.end(); ++y) {
            const std::uint64_t* const row = cells.data() + std::size_t(y) * rowCells;
            Rgba8* const pixels = &out.pixels[std::size_t(y) * std::size_t(size.width)];
            const CpuSums::Sum* const rowSums = sums.empty() ? nullptr : sums.data() + std::size_t(y) * rowCells;
            Rgba8* const target = samples == 1 ? pixels : colors.data();
            const Rgba8 background = backgroundOf(y, size.height, settings);
            if (scene.layers.empty()) {
                std::fill_n(pixels, size.width, background);
                continue;
            }
            for (std::size_t k = 0; k < rowCells; ++k) {
                if (k + kWordsAhead < rowCells) {
                    if (const auto next = scene.ids.find(PointId(row[k + kWordsAhead])))
                        __builtin_prefetch(words[next->layer] + next->slot);
                }
                const auto place = scene.ids.find(PointId(row[k]));
                if (!place) {
                    target[k] = background;
                    continue;
                }
                if (rowSums != nullptr && rowSums[k].blueCount != 0) {
                    target[k] = mean(rowSums[k]);
                    continue;
                }
                target[k] = colorOf(words[place->layer][place->slot], settings.layers[place->layer], settings);
            }
            if (!shades.empty()) {
                shades.shadesOf(y, shade);
                for (std::size_t k = 0; k < rowCells; ++k)
                    if (PointId(row[k]) != kNoPoint) target[k] = dimmed(target[k], shade[k]);
            }
            if (samples > 1)
                for (std::size_t x = 0; x < std::size_t(size.width); ++x)
                    pixels[x] = average(colors.data() + x * samples, std::uint32_t(samples));
        }
    });
}

}  // namespace punctum::render
