// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"

#include <glm/vec3.hpp>

namespace punctum
{

class Progress;

/// Where those points of a cloud are that a view shows. Coordinates: world.
struct ShownExtent {
    WorldBounds all;        ///< of all of them; empty when there is none
    WorldBounds typical;    ///< without strays; the same as `all` when there are none
    PointIndex points = 0;  ///< how many are shown
    PointIndex strays = 0;  ///< how many of them are far away from all the others

    /// Of several clouds: what is a stray stays one.
    void include(const ShownExtent& other) noexcept;
};

/// The extent of the points of a cloud that are not in `hidden` (hiddenPoints(); null: none is hidden).
///
/// Strays are few points that would make a dot of the others in a picture of all: on each axis, the range of all
/// but 0.2 % of the points at each end is taken (of a sample of some ten thousand points, and at least one point);
/// the widest of the three is the size of the cloud, and what lies farther than that outside of the ranges is a
/// stray.
///
/// `readable`: raw bounds of the points that could be read; others are nowhere. `stretch`: view units of a world
/// unit along each axis, which makes the axes comparable. In parallel, three times through the coordinates at most;
/// takes cloud.mutex() shared. Throws Cancelled.
ShownExtent shownExtent(const PointCloud& cloud, const RawBounds& readable, const PointSet* hidden,
                        const glm::dvec3& stretch, Progress& progress);

}  // namespace punctum
