// SPDX-License-Identifier: MIT
#include "core/above/Height.h"

#include "core/above/GroundHeights.h"
#include "core/cloud/Units.h"
#include "core/process/FilledAttribute.h"
#include "core/task/Progress.h"

#include <limits>

namespace punctum
{

const StepDescription& HeightStep::description() const
{
    using Type = StepParameter::Type;
    static const StepDescription about{
        .name = "height",
        .title = "Height above ground",
        .group = StepGroup::Ground,
        .help =
            "Measures how high each point is above the ground below it, and keeps it as HeightAboveGround. "
            "Outside the ground's rim the nearest point of the ground counts.",
        .source = "Delaunay 1934; Shepard 1968",
        .parameters =
            {{.key = "method",
              .label = "Between points",
              .help =
                  "What the ground is between its points: flat triangles (Delaunay), or the mean of the nearest "
                  "points.",
              .type = Type::Choice,
              .preset = "triangulated",
              .choices = {"triangulated", "nearest"}},
             {.key = "neighbors",
              .label = "Nearest points",
              .help = "How many points of the ground the mean is taken of.",
              .type = Type::Integer,
              .preset = std::to_string(kGroundNeighbors),
              .min = 1,
              .max = 100,
              .when = {"method", "nearest"}},
             groundParameter("The classes that are ground.")},
        .shows = kHeightName};
    return about;
}

std::unique_ptr<Command> HeightStep::make(const PointCloud& cloud, const StepValues& values, const PointSet* within,
                                          Progress& progress) const
{
    if (cloud.size() == 0) return nullptr;
    FilledAttribute heights(cloud, {.name = kHeightName,
                                    .description = "height above the ground",
                                    .unit = trueLengths(cloud).unit,
                                    .unset = std::numeric_limits<double>::quiet_NaN()});
    const GroundTree ground = groundOf(cloud, classesValue(values, "ground"), "height", progress);
    const bool nearest = textValue(values, "method") == "nearest";
    measureHeights(cloud, ground, nearest ? GroundModel::Nearest : GroundModel::Triangulated,
                   std::size_t(*integerValue(values, "neighbors")), within, progress,
                   [&](PointIndex i, double height) { heights.set(i, height); });
    // Nor do deleted points keep heights of another ground (GroundHeights.cpp).
    if (const auto deleted = deletedPoints(cloud); deleted && isFloating(heights.attribute().type()))
        deleted->forEach([&](PointIndex i) { heights.set(i, std::numeric_limits<double>::quiet_NaN()); });
    return std::make_unique<AttributesCommand>("Height above ground", std::vector{heights.attribute()});
}

}  // namespace punctum
