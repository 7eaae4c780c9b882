// SPDX-License-Identifier: MIT
#include "render/raster/cpu/CpuBackend.h"

#include "render/raster/LayerLookup.h"
#include "render/resolve/CpuResolve.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>

namespace punctum::render
{

namespace
{

constexpr std::uint64_t kEmpty = ~std::uint64_t(0);

/// Slots a task draws: long enough to hide scheduling, short enough to share a run among threads.
constexpr std::size_t kDrawGrain = 8192;
/// How far ahead memory is asked for: about the number of cache lines a core can wait for at once.
constexpr std::size_t kPrefetchAhead = 16;

void atomicMin(std::uint64_t& cell, std::uint64_t key) noexcept
{
    const std::atomic_ref<std::uint64_t> atomic(cell);
    std::uint64_t seen = atomic.load(std::memory_order_relaxed);
    while (key < seen && !atomic.compare_exchange_weak(seen, key, std::memory_order_relaxed)) {
    }
}

/// Everything a splat needs to know of the target and the layer.
struct Splat {
    std::uint64_t* cells;
    int width, height, samples;
    float half;  ///< of the point size, px
    const std::uint8_t* classes;
    const bool* classVisible;  ///< null: all are
};

/// Splats of one pixel at one sample a pixel, by far the commonest: kept points lie inside the picture.
void splatPixels(const Splat& s, const ProjectedBlock& block, std::size_t kept, const PointId* ids, PointId firstId)
{
    std::size_t at[kProjectBlock];
    std::uint64_t key[kProjectBlock];
    std::size_t n = 0;
    for (std::size_t k = 0; k < kept; ++k) {
        const PointId id = ids[block.index[k]];
        at[n] = std::size_t(int(block.y[k])) * std::size_t(s.width) + std::size_t(int(block.x[k]));
        key[n] = std::uint64_t(block.depth[k]) << 32 | id;
        n += s.classVisible == nullptr || s.classVisible[s.classes[id - firstId]];
    }
    for (std::size_t k = 0; k < std::min(n, kPrefetchAhead); ++k) __builtin_prefetch(s.cells + at[k], 1);
    for (std::size_t k = 0; k < n; ++k) {
        if (k + kPrefetchAhead < n) __builtin_prefetch(s.cells + at[k + kPrefetchAhead], 1);
        atomicMin(s.cells[at[k]], key[k]);
    }
}

/// Splats of any size at 1 or 4 samples: squares, tested at each sample's place.
void splatSquares(const Splat& s, const ProjectedBlock& block, std::size_t kept, const PointId* ids,
                  PointId firstId)
{
    for (std::size_t k = 0; k < kept; ++k) {
        const PointId id = ids[block.index[k]];
        if (s.classVisible != nullptr && !s.classVisible[s.classes[id - firstId]]) continue;
        const std::uint64_t key = std::uint64_t(block.depth[k]) << 32 | id;
        for (int sample = 0; sample < s.samples; ++sample) {
            const float ox = s.samples == 1 ? 0.5f : kSamples4[std::size_t(sample)][0];
            const float oy = s.samples == 1 ? 0.5f : kSamples4[std::size_t(sample)][1];
            const int x0 = std::max(0, int(std::floor(block.x[k] - s.half - ox)) + 1);
            const int x1 = std::min(s.width - 1, int(std::floor(block.x[k] + s.half - ox)));
            const int y0 = std::max(0, int(std::floor(block.y[k] - s.half - oy)) + 1);
            const int y1 = std::min(s.height - 1, int(std::floor(block.y[k] + s.half - oy)));
            for (int y = y0; y <= y1; ++y)
                for (int x = x0; x <= x1; ++x)
                    atomicMin(
                        s.cells[(std::size_t(y) * std::size_t(s.width) + std::size_t(x)) * std::size_t(s.samples) +
                                std::size_t(sample)],
                        key);
        }
    }
}

struct Drawing {
    ProjectArguments arguments;
    Splat splat;
    bool pixels;  ///< splatPixels serves
};

Drawing prepare(const FrameScene& scene, std::size_t layer, const TargetSize& size, std::uint64_t* cells)
{
    const Layer& l = scene.layers[layer];
    const LayerProjection& p = l.projection;
    Drawing d{};
    d.pixels = size.samples == 1 && p.pointSize == 1.0f;
    for (int k = 0; k < 4; ++k) {
        d.arguments.rowX[k] = p.rowX[k];
        d.arguments.rowY[k] = p.rowY[k];
        d.arguments.rowD[k] = p.rowD[k];
    }
    for (int k = 0; k < 3; ++k) d.arguments.reference[k] = p.reference[k];
    d.arguments.perspective = p.perspective;
    d.arguments.nearDepth = p.nearDepth;
    const float margin = d.pixels ? 0.0f : p.pointSize / 2 + 1;
    d.arguments.lowX = d.arguments.lowY = -margin;
    d.arguments.highX = float(size.width) + margin;
    d.arguments.highY = float(size.height) + margin;
    d.splat = {cells,
               size.width,
               size.height,
               size.samples,
               p.pointSize / 2,
               l.store->classes().data(),
               scene.allClassesVisible ? nullptr : scene.classVisible.data()};
    return d;
}

void splat(const Drawing& d, const ProjectedBlock& block, std::size_t kept, const PointId* ids, PointId firstId)
{
    if (d.pixels)
        splatPixels(d.splat, block, kept, ids, firstId);
    else
        splatSquares(d.splat, block, kept, ids, firstId);
}

}  // namespace

CpuBackend::CpuBackend() : m_kernel(chooseKernel()) {}

std::string CpuBackend::description() const
{
    return "CPU, " + std::string(m_kernel.name) + ", " + std::to_string(tbb::info::default_concurrency()) +
           " threads";
}

void CpuBackend::setTarget(const TargetSize& size)
{
    m_size = size;
    const std::size_t bytes = std::size_t(size.width) * std::size_t(size.height) * std::size_t(size.samples) * 8;
    if (m_cells.size() != bytes) m_cells = Buffer(bytes);
    clear();
}

std::span<const std::uint64_t> CpuBackend::cells() const noexcept
{
    return {reinterpret_cast<const std::uint64_t*>(m_cells.data()), m_cells.size() / 8};
}

void CpuBackend::clear()
{
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, m_cells.size(), std::size_t(1) << 18),
                      [&](const auto& r) { std::memset(m_cells.data() + r.begin(), 0xFF, r.size()); });
}

void CpuBackend::visibleIds(std::vector<PointId>& out)
{
    tbb::enumerable_thread_specific<std::vector<PointId>> parts;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, cells().size(), 1 << 15), [&](const auto& r) {
        auto& part = parts.local();
        PointId last = kNoPoint;
        for (std::size_t k = r.begin(); k != r.end(); ++k) {
            const auto id = PointId(cells()[k]);
            if (id != last && id != kNoPoint) part.push_back(id);
            last = id;
        }
    });
    out.clear();
    for (const auto& part : parts) out.insert(out.end(), part.begin(), part.end());
}

void CpuBackend::reproject(const FrameScene& scene)
{
    // One pass takes the ids out and leaves the buffer empty; ids of a layer stay together.
    using Lists = std::vector<std::vector<PointId>>;
    tbb::enumerable_thread_specific<Lists> parts([&] { return Lists(scene.layers.size()); });
    std::uint64_t* const cell = cellData();
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, cells().size(), 1 << 15), [&](const auto& r) {
        Lists& lists = parts.local();
        LayerLookup lookup(scene);
        PointId last = kNoPoint;
        for (std::size_t k = r.begin(); k != r.end(); ++k) {
            const auto id = PointId(cell[k]);
            cell[k] = kEmpty;
            if (id == last || id == kNoPoint) continue;
            last = id;
            lists[lookup.layerOf(id)].push_back(id);
        }
    });
    for (std::size_t layer = 0; layer < scene.layers.size(); ++layer)
        for (const Lists& lists : parts) drawIds(scene, layer, lists[layer]);
}

void CpuBackend::drawIds(const FrameScene& scene, std::size_t layer, std::span<const PointId> ids)
{
    const Drawing d = prepare(scene, layer, m_size, cellData());
    const LocalPosition* const positions = scene.layers[layer].store->positions().data();
    const PointId firstId = scene.layers[layer].firstId;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, ids.size(), kDrawGrain), [&](const auto& r) {
        ProjectedBlock block;
        LocalPosition gathered[kProjectBlock + 8];
        for (std::size_t at = r.begin(); at < r.end(); at += kProjectBlock) {
            const std::size_t count = std::min(kProjectBlock, r.end() - at);
            for (std::size_t k = 0; k < count; ++k) {
                if (at + k + kPrefetchAhead < r.end())
                    __builtin_prefetch(positions + (ids[at + k + kPrefetchAhead] - firstId));
                gathered[k] = positions[ids[at + k] - firstId];
            }
            const std::size_t kept = m_kernel.project(&gathered[0].x, count, d.arguments, block);
            splat(d, block, kept, ids.data() + at, firstId);
        }
    });
}

void CpuBackend::draw(const FrameScene& scene, std::size_t layer, SlotRange slots)
{
    const Drawing d = prepare(scene, layer, m_size, cellData());
    const LocalPosition* const positions = scene.layers[layer].store->positions().data();
    const PointId firstId = scene.layers[layer].firstId;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(slots.first, slots.last, kDrawGrain), [&](const auto& r) {
        ProjectedBlock block;
        PointId ids[kProjectBlock];
        for (std::size_t at = r.begin(); at < r.end(); at += kProjectBlock) {
            const std::size_t count = std::min(kProjectBlock, r.end() - at);
            for (std::size_t k = 0; k < count; ++k) ids[k] = firstId + PointId(at + k);
            const std::size_t kept = m_kernel.project(&positions[at].x, count, d.arguments, block);
            splat(d, block, kept, ids, firstId);
        }
    });
}

void CpuBackend::resolve(const FrameScene& scene, const ResolveSettings& settings, Image& out)
{
    resolveCells(cells(), m_size, scene, settings, out);
}

std::optional<RasterBackend::Hit> CpuBackend::pick(int x, int y, int radius)
{
    std::optional<Hit> best;
    int bestDistance = radius * radius + 1;
    std::uint64_t bestCell = kEmpty;
    for (int py = std::max(0, y - radius); py <= std::min(m_size.height - 1, y + radius); ++py)
        for (int px = std::max(0, x - radius); px <= std::min(m_size.width - 1, x + radius); ++px) {
            const int distance = (px - x) * (px - x) + (py - y) * (py - y);
            if (distance > radius * radius || distance > bestDistance) continue;
            for (int s = 0; s < m_size.samples; ++s) {
                const std::uint64_t cell = cells()[(std::size_t(py) * std::size_t(m_size.width) + std::size_t(px)) *
                                                       std::size_t(m_size.samples) +
                                                   std::size_t(s)];
                if (cell == kEmpty || (distance == bestDistance && cell >= bestCell)) continue;
                bestDistance = distance;
                bestCell = cell;
                best = Hit{PointId(cell), std::bit_cast<float>(std::uint32_t(cell >> 32))};
            }
        }
    return best;
}

double CpuBackend::coveredShare()
{
    const std::size_t pixels = std::size_t(m_size.width) * std::size_t(m_size.height);
    const auto samples = std::size_t(m_size.samples);
    if (pixels == 0) return 0.0;
    const std::size_t covered = tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, pixels, 1 << 15), std::size_t(0),
        [&](const auto& r, std::size_t n) {
            for (std::size_t p = r.begin(); p != r.end(); ++p) {
                const auto pixel = cells().subspan(p * samples, samples);
                n += std::any_of(pixel.begin(), pixel.end(), [](std::uint64_t c) { return c != kEmpty; });
            }
            return n;
        },
        std::plus<>());
    return double(covered) / double(pixels);
}

}  // namespace punctum::render
