// SPDX-License-Identifier: MIT
#pragma once

#include "core/process/Step.h"

namespace punctum
{

/// ground cell=1 slope=0.15 window=18 threshold=0.45: finds the ground; its points get class 2, others that had
/// it 1.
///
/// The simple morphological filter (Pingel, Clarke, McBride 2013) on a grid of lowest points, with two more passes
/// above the trend of what the one before left: BareSurface.h tells how. Looks at last returns, or at all points
/// where the file has no returns, and at no class but noise and those that are kept; withheld points are left out
/// and stay as they are.
class GroundStep final : public Step
{
public:
    const StepDescription& description() const override;

private:
    std::unique_ptr<Command> make(const PointCloud& cloud, const StepValues& values, const PointSet* within,
                                  Progress& progress) const override;
};

}  // namespace punctum
