// SPDX-License-Identifier: MIT
#pragma once

#include "core/process/Step.h"

namespace punctum
{

/// outliers k=8 deviations=3 class=7: classifies points that are further from their neighbors than is usual.
///
/// Rusu et al., Towards 3D Point Cloud Based Object Maps for Household Environments (2008), as PCL's
/// StatisticalOutlierRemoval does it, with the same result: the mean distance of each point to its k nearest
/// neighbors; outliers are those above mean + deviations * standard deviation of these distances over the cloud.
class OutliersStep final : public Step
{
public:
    std::string name() const override { return "outliers"; }
    std::string title() const override { return "Statistical outliers"; }
    std::string help() const override;
    std::vector<StepParameter> parameters() const override;
    std::unique_ptr<Command> run(const PointCloud& cloud, const StepValues& values,
                                 Progress& progress) const override;
};

}  // namespace punctum
