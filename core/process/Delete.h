// SPDX-License-Identifier: MIT
#pragma once

#include "core/process/Step.h"

namespace punctum
{

/// delete where=CONDITION: the points for which it holds are deleted (DeleteCommand); saving leaves them out.
class DeleteStep final : public Step
{
public:
    std::string name() const override { return "delete"; }
    std::string title() const override { return "Delete"; }
    std::string help() const override;
    std::vector<StepParameter> parameters() const override;
    std::unique_ptr<Command> run(const PointCloud& cloud, const StepValues& values,
                                 Progress& progress) const override;
    /// Without a condition: all of these points.
    std::unique_ptr<Command> runWithin(const PointCloud& cloud, const StepValues& values, const PointSet& within,
                                       Progress& progress) const override;
};

/// restore: points that were deleted are there again.
class RestoreStep final : public Step
{
public:
    std::string name() const override { return "restore"; }
    std::string title() const override { return "Restore deleted"; }
    std::string help() const override;
    std::vector<StepParameter> parameters() const override { return {}; }
    std::unique_ptr<Command> run(const PointCloud& cloud, const StepValues& values,
                                 Progress& progress) const override;
};

}  // namespace punctum
