// SPDX-License-Identifier: MIT
#pragma once

#include "render/raster/Backend.h"

namespace punctum::render
{

/// The backend of Schuetz et al. 2019, section 3: GL_POINTS into a buffer of ids and depths, multisampled where
/// 4 samples are asked for. Needs a current OpenGL 4.3 core context, which must be current whenever a member is
/// called and when the backend is destroyed; it leaves the context's drawing state as it found it, but for
/// texture units 0 and 1 and the numbered storage and image bindings.
///
/// Differs from the CPU backend where two points of one sample are equally deep (the one drawn first stays, not the
/// smaller id), by last bits of float arithmetic, and for point sizes that are no multiples of 1/4 px, whose edges
/// the device rounds to 1/256 px or so. Points smaller than 1 px are drawn with 1 px.
///
/// `chunkSlots`: slots of one piece of device memory, a multiple of PointStore::kBlockSlots; 0: as many as the
/// driver's limits allow (tests ask for less). Throws Error when there is no such context.
std::unique_ptr<RasterBackend> makeGlPointsBackend(Slot chunkSlots = 0);

}  // namespace punctum::render
