// SPDX-License-Identifier: MIT
#pragma once

#include "render/camera/Camera.h"
#include "render/raster/Backend.h"

namespace punctum::render
{

/// How a camera maps a store's local integers to the picture. Computed in double; the reference is the point of the
/// integer grid nearest to the eye, so that float keeps its digits where one looks from, at any distance from the
/// origin of the CRS.
LayerProjection makeProjection(const Camera& camera, const PointStore& store, const TargetSize& size,
                               double pointSizePx);

}  // namespace punctum::render
