// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Buffer.h"
#include "render/color/Rgba8.h"
#include "render/raster/cpu/CpuKernels.h"

#include <atomic>
#include <cstdint>
#include <span>

namespace punctum::render
{

/// Sums of the colors of all points near the front of a sample: high-quality shading (Schuetz, Kerbl, Wimmer 2022,
/// section 3.6). Integer sums do not depend on the order of drawing. Beyond 2^24 points in one sample, which is
/// when 32 bits are full, further ones are left out.
class CpuSums
{
public:
    struct Sum {
        std::uint64_t redGreen = 0;   ///< red in the high half
        std::uint64_t blueCount = 0;  ///< blue in the high half, number of points in the low half
    };
    void clear();
    /// Has room for so many cells from now on. Throws Error (memory).
    void reserve(std::size_t cells);
    /// None while nothing was added.
    std::span<const Sum> sums() const noexcept
    {
        return m_any ? std::span(reinterpret_cast<const Sum*>(m_sums.data()), m_sums.size() / sizeof(Sum))
                     : std::span<const Sum>();
    }
    /// Adds a color for each of the first `count` points of a block to the samples that it covers and whose nearest
    /// point, as SplatTarget::cells has it, is at most kAverageDepth nearer. Any number of threads.
    void add(const SplatTarget& target, const ProjectedBlock& block, std::size_t count, const Rgba8* colors);

private:
    Buffer m_sums;
    std::atomic<bool> m_any{false};
};

}  // namespace punctum::render
