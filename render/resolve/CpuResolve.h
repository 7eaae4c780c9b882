// SPDX-License-Identifier: MIT
#pragma once

#include "render/raster/Backend.h"

namespace punctum::render
{

/// The background of a row: the gradient's colour, the same for all of the row.
Rgba8 backgroundOf(int row, int height, const ResolveSettings& settings) noexcept;

/// Turns a CPU visibility buffer (CpuBackend::cells()) into a picture, in parallel. Samples of a pixel are
/// averaged by alpha, so that a transparent background does not darken edges.
void resolveCells(std::span<const std::uint64_t> cells, const TargetSize& size, const FrameScene& scene,
                  const ResolveSettings& settings, Image& out);

}  // namespace punctum::render
