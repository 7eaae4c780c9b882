// SPDX-License-Identifier: MIT
#pragma once

#include "render/camera/Camera.h"
#include "render/raster/Backend.h"

namespace punctum::render
{

/// Which part of a larger picture is drawn: large pictures are made tile by tile.
struct PicturePart {
    int x = 0, y = 0;           ///< px of the part's top left corner
    int width = 0, height = 0;  ///< of the whole picture
    friend bool operator==(const PicturePart&, const PicturePart&) = default;
};

/// How a camera maps a store's local integers to the picture. Computed in double; the reference is the point of the
/// integer grid nearest to the eye, so that float keeps its digits where one looks from, at any distance from the
/// origin of the CRS.
LayerProjection makeProjection(const Camera& camera, const PointStore& store, const PicturePart& part,
                               double pointSizePx);
inline LayerProjection makeProjection(const Camera& camera, const PointStore& store, const TargetSize& size,
                                      double pointSizePx)
{
    return makeProjection(camera, store, PicturePart{0, 0, size.width, size.height}, pointSizePx);
}

}  // namespace punctum::render
