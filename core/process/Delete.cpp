// SPDX-License-Identifier: MIT
#include "core/process/Delete.h"

#include "core/Error.h"
#include "core/edit/DeleteCommand.h"
#include "core/expression/Condition.h"
#include "core/process/Values.h"
#include "core/task/Progress.h"

namespace punctum
{

std::string DeleteStep::help() const
{
    return "Deletes the points for which a condition holds: no later step sees them, and the file that is written "
           "lacks them.";
}

std::vector<StepParameter> DeleteStep::parameters() const
{
    std::vector<StepParameter> p(1);
    p[0].key = "where";
    p[0].label = "Condition";
    p[0].help = "Which points, such as Classification == 7 or Z > 120; the user guide tells the language.";
    p[0].type = StepParameter::Type::Condition;
    return p;
}

std::unique_ptr<Command> DeleteStep::run(const PointCloud& cloud, const StepValues& values,
                                         Progress& progress) const
{
    const std::string where = completeValues(*this, values).at("where");
    auto points = expression::select(cloud, expression::Condition(where, cloud), progress);
    if (const auto deleted = deletedPoints(cloud)) points->remove(*deleted);
    if (points->count() == 0) return nullptr;
    return std::make_unique<DeleteCommand>("Delete where " + where, std::move(points));
}

std::unique_ptr<Command> DeleteStep::runWithin(const PointCloud& cloud, const StepValues&, const PointSet& within,
                                               Progress&) const
{
    auto points = std::make_shared<PointSet>(within);
    if (const auto deleted = deletedPoints(cloud)) points->remove(*deleted);
    if (points->count() == 0) return nullptr;
    return std::make_unique<DeleteCommand>("Delete", std::move(points));
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
