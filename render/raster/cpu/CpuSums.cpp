// SPDX-License-Identifier: MIT
#include "render/raster/cpu/CpuSums.h"

#include "render/raster/cpu/splat.inl"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <cstring>

namespace punctum::render
{

namespace
{

constexpr std::uint32_t kMostPoints = 1u << 24;

}  // namespace

void CpuSums::clear()
{
    if (!m_any) return;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, m_sums.size(), 1 << 18),
                      [&](const auto& r) { std::memset(m_sums.data() + r.begin(), 0, r.size()); });
    m_any = false;
}

void CpuSums::reserve(std::size_t cells)
{
    if (m_sums.size() == cells * sizeof(Sum)) return;
    m_sums = Buffer();
    m_any = false;
    m_sums = Buffer(cells * sizeof(Sum));  // zeros
}

void CpuSums::add(const SplatTarget& target, const ProjectedBlock& block, std::size_t count, const Rgba8* colors)
{
    auto* const sums = reinterpret_cast<Sum*>(m_sums.data());
    m_any.store(true, std::memory_order_relaxed);
    const bool pixels = isSinglePixels(target);
    for (std::size_t k = 0; k < count; ++k) {
        const float depth = depthOf(block.depth[k]);
        const Rgba8 color = colors[k];
        const auto use = [&](std::size_t cell) {
            if (!(depth <= depthOf(highHalf(target.cells + cell)) * kAverageDepth)) return;
            std::atomic_ref<std::uint64_t> second(sums[cell].blueCount);
            if (std::uint32_t(second.load(std::memory_order_relaxed)) >= kMostPoints) return;
            std::atomic_ref<std::uint64_t> first(sums[cell].redGreen);
            first.fetch_add(std::uint64_t(color.r) << 32 | color.g, std::memory_order_relaxed);
            second.fetch_add(std::uint64_t(color.b) << 32 | 1u, std::memory_order_relaxed);
        };
        if (pixels)
            use(std::size_t(block.y[k]) * std::size_t(target.width) + std::size_t(block.x[k]));
        else
            forEachCovered(target, block.x[k], block.y[k], depth, use);
    }
}

}  // namespace punctum::render
