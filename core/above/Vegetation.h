// SPDX-License-Identifier: MIT
#pragma once

#include "core/process/Step.h"

namespace punctum
{

/// vegetation low=0.5 medium=2 high=5: classes 3, 4 and 5 by the height above ground, of points that are nothing
/// else yet.
class VegetationStep final : public Step
{
public:
    const StepDescription& description() const override;

private:
    std::unique_ptr<Command> make(const PointCloud& cloud, const StepValues& values, const PointSet* within,
                                  Progress& progress) const override;
};

}  // namespace punctum
