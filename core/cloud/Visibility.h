// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"

#include <array>
#include <memory>
#include <optional>
#include <vector>

namespace punctum
{

class Progress;

/// Half of space, in `world`: the points p with dot(normal, p) >= distance. The normal need not have length 1.
struct ClipPlane {
    glm::dvec3 normal{0, 0, 1};
    double distance = 0;
    friend bool operator==(const ClipPlane&, const ClipPlane&) = default;
};

/// The part of space that a view shows: what lies in the box, faces included, and on the kept side of all planes.
struct Clip {
    std::optional<WorldBounds> box;
    std::vector<ClipPlane> planes;

    bool any() const noexcept { return box || !planes.empty(); }
    friend bool operator==(const Clip& a, const Clip& b) noexcept
    {
        return a.planes == b.planes && a.box.has_value() == b.box.has_value() &&
               (!a.box || (a.box->min == b.box->min && a.box->max == b.box->max));
    }
};

/// The raw integers inside a box of the world. Faces may be off by a millionth of a step of the grid, so that a
/// number that was written in decimals means the integer that it stands for.
RawBounds rawInside(const WorldBounds& box, const CoordinateScale& coordinates) noexcept;

/// What a view hides of a cloud. Edits by hand must not touch hidden points.
struct Visibility {
    std::array<bool, 256> classVisible{};
    Clip clip;
    std::shared_ptr<const PointSet> filtered;  ///< hidden by a filter: expression::selectOthers(); null: none

    Visibility() { classVisible.fill(true); }
};

/// All points that it hides, and those that are deleted, in parallel; null when there are none. Of stretches of the
/// file that lie on one side of the clip with their boxes no coordinates are looked at. Takes cloud.mutex() shared
/// for some 20 ms at a time. Throws Cancelled. `among`: only points near these are looked at, and others may be
/// missing; null: all.
std::shared_ptr<PointSet> hiddenPoints(const PointCloud& cloud, const Visibility& visibility, Progress& progress,
                                       const PointSet* among = nullptr);

}  // namespace punctum
