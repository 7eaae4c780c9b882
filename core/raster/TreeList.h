// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"
#include "core/raster/MapLines.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace punctum
{

class Progress;

/// A tree as inventories list it.
struct TreeRecord {
    std::int64_t id = 0;
    glm::dvec3 top{0.0};   ///< `world`: the point that is highest above the ground, by Z where that is not known
    double height = 0;     ///< of the top above the ground, units of length; NaN: the ground is not known
    double crownArea = 0;  ///< of the convex hull of its points seen from above, square units of length
    std::uint64_t points = 0;
};

/// Which trees, and by what they are told from each other.
struct TreeListRequest {
    std::string id;            ///< the attribute that numbers the trees, above 0; empty: TreeId, in any case
    std::string where;         ///< condition; empty: all points
    std::string ground = "2";  ///< classes of the ground, as steps name them
};

/// The trees of a cloud.
struct TreeList {
    std::vector<TreeRecord> trees;  ///< by id
    std::string unit;               ///< of lengths; empty when unknown
    std::string finding;            ///< a sentence: what heights are of; may be empty
};

/// The attribute TreeId of these, in capitals or not; null: there is none.
const Attribute* treeIdsOf(const std::vector<Attribute>& attributes) noexcept;

/// Lists the trees that the step trees, or another program, has numbered. In parallel, the same on any number of
/// threads and in whatever order the points come (of tops that are equally high the one with the least X, then Y,
/// then Z). Deleted points are left out. Throws Cancelled, and Error where no point is of a tree.
TreeList listTrees(const PointCloud& cloud, const TreeListRequest& request, Progress& progress);

/// The list as a table: id, x, y, z, height, crown_area, points.
MapTable treeTable(const TreeList& list);

}  // namespace punctum
