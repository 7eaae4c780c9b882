// SPDX-License-Identifier: MIT
#include "core/clean/RadiusOutliers.h"

#include "core/edit/ClassCommand.h"
#include "core/neighbors/Neighbors.h"
#include "core/process/Values.h"
#include "core/task/Progress.h"

namespace punctum
{

const StepDescription& RadiusOutliersStep::description() const
{
    using Type = StepParameter::Type;
    static const StepDescription about{
        .name = "radius-outliers",
        .title = "Radius outliers",
        .group = StepGroup::Cleaning,
        .help =
            "Classifies points that have fewer neighbors than wanted within a radius (as PCL's radius outlier "
            "removal).",
        .source = "Rusu and Cousins 2011",
        .parameters = {{.key = "radius",
                        .label = "Radius",
                        .help = "How far neighbors may be.",
                        .fit = {.spacings = 4},
                        .min = 1e-9,
                        .max = 1e9,
                        .unit = StepParameter::Unit::Length},
                       {.key = "neighbors",
                        .label = "Neighbors",
                        .help = "A point with fewer other points within the radius is an outlier.",
                        .type = Type::Integer,
                        .preset = "2",
                        .min = 1,
                        .max = 1000000},
                       {.key = "class",
                        .label = "Class",
                        .help = "The class outliers get.",
                        .type = Type::ClassCode,
                        .preset = "7"}},
        .shows = "Classification"};
    return about;
}

std::unique_ptr<Command> RadiusOutliersStep::make(const PointCloud& cloud, const StepValues& values,
                                                  const PointSet* within, Progress& progress) const
{
    const auto enough = std::size_t(*integerValue(values, "neighbors")) + 1;  // with the point itself
    const auto code = std::uint32_t(*integerValue(values, "class"));
    const Attribute classes = classAttribute(cloud, code);
    if (cloud.size() == 0) return nullptr;
    auto lonely = std::make_shared<PointSet>(cloud.size());
    const auto places = KdOrder::of(cloud, progress);
    forEachCount(
        *places, *realValue(values, "radius"), enough, "Counting neighbors", progress,
        [&](std::uint32_t point, std::size_t count) {
            if (count < enough) lonely->insertShared(point);
        },
        within);
    progress.begin("Telling outliers", cloud.size());
    leaveOutValue(*lonely, cloud, classes, code, progress);
    return makeClassCommand("Radius outliers to " + classLabel(code), classes, std::move(lonely), code);
}

}  // namespace punctum
