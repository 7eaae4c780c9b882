// SPDX-License-Identifier: MIT
#include "render/camera/Projection.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace punctum::render
{

namespace
{

/// The least and the largest depth (view units along the view direction) that points of the box have.
std::pair<double, double> depthsOf(const Camera& camera, const WorldBounds& box)
{
    const glm::dvec3 forward = camera.forward() * camera.stretch;
    double least = 0.0, largest = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
        const double a = (box.min[axis] - camera.eye[axis]) * forward[axis];
        const double b = (box.max[axis] - camera.eye[axis]) * forward[axis];
        least += std::min(a, b);
        largest += std::max(a, b);
    }
    return {least, largest};
}

/// What is added to depths that are seen in parallel, so that all of them are positive wherever zooming has put the
/// eye. As little as can be, since what is a share of a depth (the front that is averaged, the surface that grows
/// into holes) is to mean about what it means in perspective.
double liftOf(const Camera& camera, const WorldBounds& scene)
{
    constexpr double kSlack = 0.1;  // of the range: more points may come than the header said
    if (scene.empty()) return camera.pivotDepth();
    const auto [least, largest] = depthsOf(camera, scene);
    return std::max(camera.pivotDepth(), (largest - least) * kSlack) - least;
}

}  // namespace

LayerProjection makeProjection(const Camera& camera, const PointStore& store, const PicturePart& part,
                               const PointStyle& style, const WorldBounds& scene)
{
    const CoordinateScale& grid = store.cloud().coordinates();
    const LocalFrame& frame = store.frame();
    const glm::dvec3 unit = grid.scale * camera.stretch * double(1 << frame.shift);  // view units of one local unit
    const glm::dvec3 eyeLocal = frame.toLocal(grid.toRaw(camera.eye));
    const glm::dvec3 reference = glm::round(glm::clamp(eyeLocal, glm::dvec3(0.0), glm::dvec3(double(INT32_MAX))));
    const glm::dvec3 toReference = (reference - eyeLocal) * unit;  // view units, from the eye

    const glm::dvec3 right = camera.right(), up = camera.up(), forward = camera.forward();
    const double focal = part.height / 2.0 / std::tan(camera.fovY / 2);  // px
    const double centerX = part.width / 2.0 - part.x, centerY = part.height / 2.0 - part.y;

    const auto row = [&](const glm::dvec3& axis, double constant) {
        return glm::vec4(glm::vec3(axis * unit), float(glm::dot(axis, toReference) + constant));
    };
    LayerProjection p;
    p.reference = glm::ivec3(reference);
    p.perspective = !camera.orthographic;
    p.pointSize = float(style.px);
    p.round = style.round;
    p.mostSize = float(std::max(style.px, style.most));
    if (p.perspective) {
        p.rowX = row(right * focal + forward * centerX, 0.0);
        p.rowY = row(forward * centerY - up * focal, 0.0);
        p.rowD = row(forward, 0.0);
        p.nearDepth = float(camera.nearDepth());
        p.sizeOverDepth = float(style.size * focal);
        // From so far that the nearest point has the least size all have: that is drawn fastest.
        const WorldBounds box = grid.toWorld(store.bounds());
        if (style.size > 0 && !box.empty()) {
            const double nearest = depthsOf(camera, box).first;
            const double steps = style.size * focal / nearest * kSampleSteps;
            if (nearest > 0 && steps <= double(p.sizeInSteps())) p.sizeOverDepth = 0.0f;
        }
    } else {
        const double scale = focal / camera.pivotDepth();  // px of a view unit
        p.rowX = row(right * scale, centerX);
        p.rowY = row(-up * scale, centerY);
        p.rowD = row(forward, liftOf(camera, scene.empty() ? grid.toWorld(store.bounds()) : scene));
        p.nearDepth = 1e-30f;
        if (style.size > 0)
            p.pointSize = float(std::clamp(style.size * scale, style.px, std::max(style.px, style.most)));
    }
    return p;
}

LayerClip makeClip(const Clip& clip, const PointStore& store, const glm::ivec3& reference)
{
    LayerClip result;
    result.on = clip.any();
    const CoordinateScale& grid = store.cloud().coordinates();
    const LocalFrame& frame = store.frame();
    if (clip.box) {
        const RawBounds raw = rawInside(*clip.box, grid);
        const std::int64_t step = std::int64_t(1) << frame.shift;
        for (int axis = 0; axis < 3; ++axis) {
            const auto local = [&](std::int64_t v) {
                return std::int32_t(std::clamp<std::int64_t>(v, INT32_MIN, INT32_MAX));
            };
            // Where a local integer stands for several raw ones, the first of them decides.
            result.low[axis] = local((raw.min[axis] - frame.origin[axis] + step - 1) >> frame.shift);
            result.high[axis] = local((raw.max[axis] - frame.origin[axis]) >> frame.shift);
        }
    }
    const glm::dvec3 unit = grid.scale * double(1 << frame.shift);
    const glm::dvec3 at = grid.toWorld(frame.toRaw(glm::dvec3(reference)));
    for (const ClipPlane& plane : clip.planes) {
        if (result.planeCount == kMostClipPlanes) break;
        // Divided by its largest part, so that float holds it whatever the units.
        const glm::dvec3 row = plane.normal * unit;
        const double largest = std::max({std::abs(row.x), std::abs(row.y), std::abs(row.z), 1e-300});
        result.planes[result.planeCount++] =
            glm::vec4(glm::vec3(row / largest), float((glm::dot(plane.normal, at) - plane.distance) / largest));
    }
    return result;
}

}  // namespace punctum::render
