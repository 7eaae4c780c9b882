// SPDX-License-Identifier: MIT
#pragma once

#include "core/process/Step.h"

namespace punctum
{

/// rename attribute=OLD to=NEW: an attribute that is no field of the standard gets another name.
class RenameStep final : public Step
{
public:
    std::string name() const override { return "rename"; }
    std::string title() const override { return "Rename attribute"; }
    std::string help() const override;
    std::vector<StepParameter> parameters() const override;
    std::unique_ptr<Command> run(const PointCloud& cloud, const StepValues& values,
                                 Progress& progress) const override;
};

/// remove attribute=NAME: an attribute that is no field of the standard goes, with its values.
class RemoveStep final : public Step
{
public:
    std::string name() const override { return "remove"; }
    std::string title() const override { return "Remove attribute"; }
    std::string help() const override;
    std::vector<StepParameter> parameters() const override;
    std::unique_ptr<Command> run(const PointCloud& cloud, const StepValues& values,
                                 Progress& progress) const override;
};

}  // namespace punctum
