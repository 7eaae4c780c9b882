// SPDX-License-Identifier: MIT
#include "core/process/Delete.h"

#include "core/Error.h"
#include "core/edit/DeleteCommand.h"
#include "core/expression/Condition.h"
#include "core/process/Values.h"
#include "core/task/Progress.h"

namespace punctum
{

namespace
{

/// Null when none of them is left to delete.
std::unique_ptr<Command> deleting(std::string name, const PointCloud& cloud, std::shared_ptr<PointSet> points)
{
    if (const auto deleted = deletedPoints(cloud)) points->remove(*deleted);
    if (points->count() == 0) return nullptr;
    return std::make_unique<DeleteCommand>(std::move(name), std::move(points));
}

}  // namespace

const StepDescription& DeleteStep::description() const
{
    static const StepDescription about{
        .name = "delete",
        .title = "Delete",
        .group = StepGroup::Points,
        .help =
            "Deletes the points for which a condition holds: no later step sees them, and the file that is "
            "written lacks them.",
        .parameters = {{.key = "where",
                        .label = "Condition",
                        .help = "Which points, such as Classification == 7 or Z > 120; the user guide tells the "
                                "language.",
                        .type = StepParameter::Type::Condition,
                        .wholeOnly = true}}};
    return about;
}

std::unique_ptr<Command> DeleteStep::make(const PointCloud& cloud, const StepValues& values, const PointSet* within,
                                          Progress& progress) const
{
    const std::string where = textValue(values, "where");
    if (where.empty()) return deleting("Delete", cloud, std::make_shared<PointSet>(*within));
    const auto points = expression::select(cloud, expression::Condition(where, cloud), progress);
    if (within != nullptr) points->intersect(*within);
    return deleting("Delete where " + where, cloud, points);
}

const StepDescription& RestoreStep::description() const
{
    static const StepDescription about{.name = "restore",
                                       .title = "Restore deleted",
                                       .group = StepGroup::Points,
                                       .help = "Takes back all points that were deleted.",
                                       .narrows = false};
    return about;
}

std::unique_ptr<Command> RestoreStep::make(const PointCloud& cloud, const StepValues&, const PointSet*,
                                           Progress&) const
{
    auto deleted = deletedPoints(cloud);
    return deleted ? std::make_unique<DeleteCommand>("Restore deleted points", std::move(deleted)) : nullptr;
}

}  // namespace punctum
