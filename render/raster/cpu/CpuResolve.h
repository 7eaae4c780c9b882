// SPDX-License-Identifier: MIT
#pragma once

#include "render/raster/cpu/CpuSums.h"
#include "render/scene/FrameScene.h"
#include "render/scene/Image.h"
#include "render/scene/ResolveSettings.h"
#include "render/scene/TargetSize.h"

#include <cstdint>
#include <span>

namespace punctum::render
{

/// Turns a CPU visibility buffer (CpuBackend::cells()) into a picture, in parallel. Samples of a pixel are
/// lit and then averaged by alpha, so that a transparent background does not darken edges. A sample that has a sum
/// shows its mean; `sums`: one for each cell, or none. Holes are not closed here.
void resolveCells(std::span<const std::uint64_t> cells, std::span<const CpuSums::Sum> sums, const TargetSize& size,
                  const FrameScene& scene, const ResolveSettings& settings, Image& out);

}  // namespace punctum::render
