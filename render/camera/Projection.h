// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Visibility.h"
#include "render/camera/Camera.h"
#include "render/scene/LayerClip.h"
#include "render/scene/LayerProjection.h"
#include "render/scene/TargetSize.h"
#include "render/store/PointStore.h"

namespace punctum::render
{

/// Which part of a larger picture is drawn: large pictures are made tile by tile.
struct PicturePart {
    int x = 0, y = 0;           ///< px of the part's top left corner
    int width = 0, height = 0;  ///< of the whole picture
    friend bool operator==(const PicturePart&, const PicturePart&) = default;
};

/// What a point looks like.
struct PointStyle {
    double px = 1.0;               ///< width; the least where `size` is not 0
    double size = 0.0;             ///< width in view units (Camera); 0: the width is `px` everywhere
    bool round = false;            ///< a circle instead of a square
    double most = kMostGrownSize;  ///< px, where `size` is not 0
};

/// How a camera maps a store's local integers to the picture. Computed in double; the reference is the point of the
/// integer grid nearest to the eye, so that float keeps its digits where one looks from, at any distance from the
/// origin of the CRS.
///
/// `scene`: the box (world) of all that the picture shows. Seen in parallel, depths are told from a place before
/// it, so that those of several stores compare; empty: the store is all there is.
LayerProjection makeProjection(const Camera& camera, const PointStore& store, const PicturePart& part,
                               const PointStyle& style = {}, const WorldBounds& scene = {});
/// What of a store lies inside; `reference`: of its projection. At most kMostClipPlanes planes count.
LayerClip makeClip(const Clip& clip, const PointStore& store, const glm::ivec3& reference);
inline LayerProjection makeProjection(const Camera& camera, const PointStore& store, const TargetSize& size,
                                      const PointStyle& style = {})
{
    return makeProjection(camera, store, PicturePart{0, 0, size.width, size.height}, style);
}

}  // namespace punctum::render
