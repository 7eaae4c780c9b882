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
    const StepDescription& description() const override;

private:
    std::unique_ptr<Command> make(const PointCloud& cloud, const StepValues& values, const PointSet* within,
                                  Progress& progress) const override;
};

}  // namespace punctum
