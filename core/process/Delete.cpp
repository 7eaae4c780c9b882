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

std::string DeleteStep::help() const
{
    return "Deletes the points for which a condition holds: no later step sees them, and the file that is written "
           "lacks them.";
}

std::vector<StepParameter> DeleteStep::parameters() const
{
    return {{.key = "where",
             .label = "Condition",
             .help = "Which points, such as Classification == 7 or Z > 120; the user guide tells the language.",
             .type = StepParameter::Type::Condition}};
}

std::unique_ptr<Command> DeleteStep::run(const PointCloud& cloud, const StepValues& values,
                                         Progress& progress) const
{
    const std::string where = completeValues(*this, values).at("where");
    return deleting("Delete where " + where, cloud,
                    expression::select(cloud, expression::Condition(where, cloud), progress));
}

std::unique_ptr<Command> DeleteStep::runWithin(const PointCloud& cloud, const StepValues&, const PointSet& within,
                                               Progress&) const
{
    return deleting("Delete", cloud, std::make_shared<PointSet>(within));
}

std::string RestoreStep::help() const
{
    return "Takes back all points that were deleted.";
}

std::unique_ptr<Command> RestoreStep::run(const PointCloud& cloud, const StepValues& values, Progress&) const
{
    completeValues(*this, values);
    auto deleted = deletedPoints(cloud);
    return deleted ? std::make_unique<DeleteCommand>("Restore deleted points", std::move(deleted)) : nullptr;
}

}  // namespace punctum
