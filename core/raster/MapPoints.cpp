// SPDX-License-Identifier: MIT
#include "core/raster/MapPoints.h"

#include "core/Error.h"
#include "core/expression/Condition.h"
#include "core/task/Progress.h"

#include <shared_mutex>

namespace punctum
{

namespace
{

bool hasAttributeNamed(const PointCloud& cloud, std::string_view name)
{
    const std::shared_lock lock(cloud.mutex());
    return cloud.findAttribute(name) != nullptr;
}

}  // namespace

std::shared_ptr<const PointSet> pointsWhere(const PointCloud& cloud, const std::vector<std::string>& conditions,
                                            Progress& progress)
{
    std::string text;
    for (const std::string& condition : conditions) {
        if (condition.empty()) continue;
        // each for itself first: a mistake is told at its place in what the user wrote
        expression::Condition::check(condition);
        text += (text.empty() ? "(" : " and (") + condition + ")";
    }
    if (text.empty()) return nullptr;
    const auto select = [&](const std::string& condition) {
        return expression::select(cloud, expression::Condition(condition, cloud), progress);
    };
    const auto deleted = deletedPoints(cloud);
    const auto none = [&](const PointSet& points) {
        if (!deleted) return points.count() == 0;
        PointSet left = points;
        left.remove(*deleted);
        return left.count() == 0;
    };
    const std::string& wish = conditions.front();
    auto points = select(text);
    if (none(*points) && !wish.empty() && none(*select(wish)))
        throw Error("There is no point for which " + wish + " holds, so that there is nothing to make a map of.");
    return points;
}

std::string noNoise(const PointCloud& cloud)
{
    return hasAttributeNamed(cloud, "Classification") ? "not Classification in (7, 18)" : "";
}

std::string firstReturns(const PointCloud& cloud)
{
    return hasAttributeNamed(cloud, "ReturnNumber") ? "ReturnNumber <= 1" : "";
}

void checkMapped(const PointCloud& cloud)
{
    if (cloud.size() == 0) throw Error("There are no points to make a map of.");
    if (cloud.units().kind == CoordinateUnits::Kind::Geocentric)
        throw Error(
            "The coordinates are geocentric, so that no axis points up; convert the file to a projected "
            "system first.");
}

}  // namespace punctum
