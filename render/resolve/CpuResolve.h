// SPDX-License-Identifier: MIT
#pragma once

#include "render/raster/Backend.h"
#include "render/raster/cpu/CpuSums.h"

namespace punctum::render
{

/// The background of a row: the gradient's color, the same for all of the row.
Rgba8 backgroundOf(int row, int height, const ResolveSettings& settings) noexcept;

/// Turns a CPU visibility buffer (CpuBackend::cells()) into a picture, in parallel. Samples of a pixel are
/// lit and then averaged by alpha, so that a transparent background does not darken edges. A sample that has a sum
/// shows its mean; `sums`: one for each cell, or none. Holes are not closed here.
void resolveCells(std::span<const std::uint64_t> cells, std::span<const CpuSums::Sum> sums, const TargetSize& size,
                  const FrameScene& scene, const ResolveSettings& settings, Image& out);

}  // namespace punctum::render
