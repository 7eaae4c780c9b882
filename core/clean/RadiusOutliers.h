// SPDX-License-Identifier: MIT
#pragma once

#include "core/process/Step.h"

namespace punctum
{

/// radius-outliers radius=2 neighbors=2 class=7: classifies points with few others near them.
///
/// As PCL's RadiusOutlierRemoval does it, with the same result: outliers have fewer than `neighbors` other points
/// not further than `radius`.
class RadiusOutliersStep final : public Step
{
public:
    const StepDescription& description() const override;

private:
    std::unique_ptr<Command> make(const PointCloud& cloud, const StepValues& values, const PointSet* within,
                                  Progress& progress) const override;
};

}  // namespace punctum
