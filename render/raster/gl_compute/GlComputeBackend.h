// SPDX-License-Identifier: MIT
#pragma once

#include "render/raster/gl/GlBackend.h"

namespace punctum::render
{

/// The rasterizer of Schuetz, Kerbl, Wimmer 2022 (section 3) for machines with a GPU: compute shaders in which each
/// work group draws a batch of points, by 64-bit atomic minima of (depth, id) where the driver has them, else by
/// 32-bit ones in two passes. GlBackend says which context it needs.
///
/// The least depth and at equal depth the least id win, whatever the order of drawing, so that the converged
/// picture equals the brute-force picture bit for bit. From the CPU backend it differs by last bits of float
/// arithmetic.
///
/// What is out of sight is left out by stretches of the file (VisibleStretches), not by batches as in the paper: a
/// run of slots is spread over the whole cloud.
struct GlComputeOptions {
    GlLimits limits;
    bool allowWide = true;  ///< false: two passes, even where there are 64-bit atomics
    bool allLoads = false;  ///< true: invocations read several points at once, even where that is slower
};

/// Throws Error when there is no such context.
std::unique_ptr<RasterBackend> makeGlComputeBackend(const GlComputeOptions& options = {});

}  // namespace punctum::render
