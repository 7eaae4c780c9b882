// SPDX-License-Identifier: MIT
#include "render/camera/Sight.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <utility>

namespace punctum::render
{

namespace
{

/// Whether all of a box lies beyond the plane.
bool cutOff(const WorldBounds& box, const ClipPlane& plane)
{
    glm::dvec3 best;  // the corner that is farthest on the side that is kept
    for (int axis = 0; axis < 3; ++axis) best[axis] = plane.normal[axis] > 0 ? box.max[axis] : box.min[axis];
    return glm::dot(plane.normal, best) < plane.distance;
}

}  // namespace

std::function<double(const WorldBounds&)> sightOf(const Camera& camera, const glm::dvec2& sizePx, Clip clip)
{
    return [camera, sizePx, clip = std::move(clip)](const WorldBounds& box) {
        WorldBounds part = box;
        if (clip.box) {
            part.min = glm::max(part.min, clip.box->min);
            part.max = glm::min(part.max, clip.box->max);
        }
        if (glm::any(glm::greaterThan(part.min, part.max)) ||
            std::any_of(clip.planes.begin(), clip.planes.end(),
                        [&](const ClipPlane& plane) { return cutOff(part, plane); }))
            return 0.0;
        return camera.seenSize(part, sizePx);
    };
}

}  // namespace punctum::render
