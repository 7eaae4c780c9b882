// SPDX-License-Identifier: MIT
#include "core/raster/TreeList.h"

#include "core/Error.h"
#include "core/above/GroundHeights.h"
#include "core/above/PointClasses.h"
#include "core/cloud/Slabs.h"
#include "core/cloud/Units.h"
#include "core/raster/MapPoints.h"
#include "core/surface/Delaunay.h"
#include "core/task/Progress.h"

#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <shared_mutex>
#include <tuple>

namespace punctum
{

namespace
{

constexpr const char* kTreeIds = "TreeId";

bool isSameWord(std::string_view a, std::string_view b)
{
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
}

/// The attribute that numbers trees; a copy keeps it alive.
Attribute treeIds(const PointCloud& cloud, const std::string& name)
{
    const std::shared_lock lock(cloud.mutex());
    const Attribute* const found = name.empty() ? treeIdsOf(cloud.attributes()) : cloud.findAttribute(name);
    if (found == nullptr)
        throw Error("There is no attribute " + (name.empty() ? kTreeIds : name) +
                    ", which numbers the trees; run the step trees first, or name another attribute.");
    if (found->components != 1 || found->columns[0]->components() != 1 || found->kind == AttributeKind::Opaque)
        throw Error("The attribute " + name + " is no number, so that it numbers no trees.");
    return *found;
}

/// A point, in raw steps, and how high it is.
struct TreeTop {
    double height = -std::numeric_limits<double>::infinity();
    std::int32_t x = 0, y = 0, z = 0;

    bool isAbove(const TreeTop& other) const noexcept
    {
        return std::tuple(-height, x, y, z) < std::tuple(-other.height, other.x, other.y, other.z);
    }
};

/// What is known of a tree, of some of its points.
struct PartOfTree {
    TreeTop top;
    std::uint64_t points = 0;
    std::vector<SurfacePoint> hull;

    void include(const TreeTop& point)
    {
        if (points == 0 || point.isAbove(top)) top = point;
        ++points;
        hull.push_back({point.x, point.y});
    }
    void merge(PartOfTree&& other)
    {
        if (points == 0 || other.top.isAbove(top)) top = other.top;
        points += other.points;
        hull.insert(hull.end(), other.hull.begin(), other.hull.end());
    }
};

using PartsOfTrees = std::map<std::int64_t, PartOfTree>;

/// In square raw steps; from the first corner, so that large coordinates keep their digits.
double areaOfHull(const std::vector<SurfacePoint>& hull)
{
    double twice = 0;
    for (std::size_t k = 1; k + 1 < hull.size(); ++k) {
        const double ax = double(hull[k].x) - hull[0].x, ay = double(hull[k].y) - hull[0].y;
        const double bx = double(hull[k + 1].x) - hull[0].x, by = double(hull[k + 1].y) - hull[0].y;
        twice += ax * by - ay * bx;
    }
    return std::fabs(twice) / 2;
}

/// Heights above the ground where they can be known.
PointHeights heightsOfTrees(const PointCloud& cloud, const std::string& classes, Progress& progress)
{
    const auto ground = parseClasses(classes);
    if (!ground) throw Error("\"" + classes + "\" is no list of classes, such as 2,9.");
    if (hasHeightsAbove(cloud, *ground, progress) ||
        (!noNoise(cloud).empty() && pointsOfClasses(cloud, *ground, progress).count() != 0))
        return heightsAboveGround(cloud, *ground, "the list of trees", progress);
    return {{}, "No point is of the ground, so the heights of the trees are not known."};
}

PartsOfTrees partsOfTrees(const PointCloud& cloud, const Attribute& ids, const PointSet* where,
                          const std::vector<float>& heights, Progress& progress)
{
    PartsOfTrees all;
    std::mutex mutex;
    progress.begin("Listing trees", cloud.size());
    forEachSlab(cloud, progress, [&](std::size_t firstWord, std::size_t lastWord) {
        const PointRange range = pointsOfWords(cloud.size(), firstWord, lastWord);
        std::vector<double> numbers(range.size());
        ids.read(range, numbers.data());
        const auto x = cloud.rawX(), y = cloud.rawY(), z = cloud.rawZ();
        PartsOfTrees mine;
        for (std::size_t w = firstWord; w < lastWord; ++w) {
            std::uint64_t bits = shownBits(cloud.size(), cloud.deleted().get(), w);
            if (where != nullptr) bits &= where->words()[w];
            for (; bits != 0; bits &= bits - 1) {
                const PointIndex i = PointIndex(w) * 64 + PointIndex(std::countr_zero(bits));
                const double number = numbers[i - range.first];
                if (!(number >= 1) || number > 9e15) continue;
                mine[std::int64_t(number)].include({heights.empty() ? double(z[i]) : heights[i], x[i], y[i], z[i]});
            }
        }
        for (auto& [id, part] : mine) part.hull = convexHull(std::move(part.hull));
        const std::lock_guard lock(mutex);
        for (auto& [id, part] : mine) all[id].merge(std::move(part));
    });
    return all;
}

}  // namespace

const Attribute* treeIdsOf(const std::vector<Attribute>& attributes) noexcept
{
    const Attribute* found = nullptr;
    for (const Attribute& attribute : attributes)
        if (isSameWord(attribute.name, kTreeIds) && (found == nullptr || attribute.name == kTreeIds))
            found = &attribute;
    return found;
}

TreeList listTrees(const PointCloud& cloud, const TreeListRequest& request, Progress& progress)
{
    checkMapped(cloud);
    const Attribute ids = treeIds(cloud, request.id);
    const auto where = pointsWhere(cloud, {request.where}, progress);
    const PointHeights heights = heightsOfTrees(cloud, request.ground, progress);
    PartsOfTrees parts = partsOfTrees(cloud, ids, where.get(), heights.values, progress);
    if (parts.empty()) throw Error("No point is of a tree: " + ids.name + " is not above 0 anywhere.");
    const TrueLengths lengths = trueLengths(cloud);
    const CoordinateScale& steps = cloud.coordinates();
    const double square = std::fabs(steps.scale.x * lengths.stretch.x * steps.scale.y * lengths.stretch.y);
    TreeList list{{}, lengths.unit, heights.finding};
    list.trees.reserve(parts.size());
    for (auto& [id, part] : parts) {
        progress.check();
        const TreeTop& top = part.top;
        list.trees.push_back({id,
                              {steps.steps(0)(top.x), steps.steps(1)(top.y), steps.steps(2)(top.z)},
                              heights.values.empty() ? std::numeric_limits<double>::quiet_NaN() : top.height,
                              square * areaOfHull(convexHull(std::move(part.hull))),
                              part.points});
    }
    return list;
}

MapTable treeTable(const TreeList& list)
{
    MapTable table;
    table.columns = {{"id", 0}, {"z", 3}, {"height", 3}, {"crown_area", 3}, {"points", 0}};
    table.layer = "TREE";
    for (const TreeRecord& tree : list.trees)
        table.rows.push_back(
            {tree.top, {double(tree.id), tree.top.z, tree.height, tree.crownArea, double(tree.points)}});
    return table;
}

}  // namespace punctum
