// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"
#include "core/select/ScreenMask.h"

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <array>
#include <limits>
#include <memory>

namespace punctum
{

class KdOrder;
class Progress;

/// How a picture shows a cloud, for raw coordinates q = raw - base:
///     depth = dot(rowD.xyz, q) + rowD.w   along the view, from the eye; in px space w = perspective ? depth : 1
///     x_px  = (dot(rowX.xyz, q) + rowX.w) / w, y_px likewise, from the top left corner
/// Points nearer than nearDepth are not shown. render::selectionProjection() makes it for a camera.
struct PictureProjection {
    glm::dvec3 base{0.0};
    glm::dvec4 rowX{0.0}, rowY{0.0}, rowD{0.0};
    bool perspective = true;
    double nearDepth = 0.0;
};

/// A part of the space that a picture shows: what lies behind marked px, between two depths (world units).
struct Region {
    ScreenMask mask;
    PictureProjection projection;
    double nearest = -std::numeric_limits<double>::infinity();
    double furthest = std::numeric_limits<double>::infinity();
};

/// Which points may be touched at all: not those of classes that are hidden or locked, and not those hidden
/// otherwise.
struct Touchable {
    std::array<bool, 256> classes{};         ///< may be touched
    std::shared_ptr<const PointSet> hidden;  ///< may not; null: none
    Touchable() { classes.fill(true); }
};

/// The points that lie in the region and may be touched. Parallel; some 3 ns a point and core, for points of those
/// stretches of the file alone whose box the region meets. Takes cloud.mutex() shared for some 20 ms at a time.
/// Throws Cancelled.
PointSet pointsIn(const Region& region, const PointCloud& cloud, const Touchable& touchable, Progress& progress);

/// Takes the points that may not be touched out of the set.
void keepTouchable(PointSet& points, const PointCloud& cloud, const Touchable& touchable, Progress& progress);

/// How what a tool found changes the selection.
enum class SelectMode { Replace, Add, Subtract, Intersect };
/// `selection` becomes the new one. Both are of the same cloud.
void combine(PointSet& selection, const PointSet& found, SelectMode mode);
/// Members of `a` that are not in `b`.
PointIndex countWithout(const PointSet& a, const PointSet& b);

/// The points not further than `distance` (KdOrder::lengths()) from a member of the set, with the set.
/// Throws Cancelled.
PointSet grown(const PointSet& points, const KdOrder& order, double distance, Progress& progress);
/// The members that have no point outside of the set within `distance`.
PointSet shrunk(const PointSet& points, const KdOrder& order, double distance, Progress& progress);
/// All points that can be reached from the set in steps of at most `distance`.
PointSet connected(const PointSet& points, const KdOrder& order, double distance, Progress& progress);

}  // namespace punctum
