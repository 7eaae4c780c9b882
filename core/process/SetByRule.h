// SPDX-License-Identifier: MIT
#pragma once

#include "core/process/Step.h"

namespace punctum
{

/// Sets an attribute by a rule over attributes: core/expression, told in docs/user.md, "Rules".
class SetByRuleStep final : public Step
{
public:
    std::string name() const override { return "set"; }
    std::string title() const override { return "Set by rule"; }
    std::string help() const override;
    std::vector<StepParameter> parameters() const override;
    std::unique_ptr<Command> run(const PointCloud& cloud, const StepValues& values,
                                 Progress& progress) const override;
    std::unique_ptr<Command> runWithin(const PointCloud& cloud, const StepValues& values, const PointSet& within,
                                       Progress& progress) const override;
};

}  // namespace punctum
