// SPDX-License-Identifier: MIT
#pragma once

#include "render/raster/Backend.h"

namespace punctum::render
{

/// How much is done at once. The defaults suit every device; tests ask for less, to have many pieces of little.
struct GlPointsLimits {
    Slot chunkSlots = 0;                             ///< slots of one piece of device memory, a multiple of
                                                     ///< PointStore::kBlockSlots; 0: what the driver allows
    std::size_t blocksAFrame = 64;                   ///< changed blocks of words (256 KiB) sent in one frame
    std::size_t bandSamples = std::size_t(1) << 24;  ///< samples whose ids are listed in one buffer (64 MiB)
};

/// The backend of Schuetz et al. 2019, section 3: GL_POINTS into a buffer of ids and depths, multisampled where
/// 4 samples are asked for. Needs a current OpenGL 4.3 core context, which must be current whenever a member is
/// called and when the backend is destroyed; it leaves the context's drawing state as it found it, but for
/// texture units 0 and 1 and the numbered storage and image bindings.
///
/// Differs from the CPU backend where two points of one sample are equally deep (the one drawn first stays, not the
/// smaller id), and by last bits of float arithmetic. Points smaller than 1 px are drawn with 1 px, and points
/// larger than the device can draw (255 px and more) with its largest size.
///
/// Throws Error when there is no such context.
std::unique_ptr<RasterBackend> makeGlPointsBackend(const GlPointsLimits& limits = {});

}  // namespace punctum::render
