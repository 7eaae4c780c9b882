// SPDX-License-Identifier: MIT
#pragma once

#include "core/process/Step.h"

namespace punctum
{

/// low step=2 depth=0.5 count=5 class=7 high=no: points far below all others around them, and, where that is
/// wanted, far above.
///
/// In each upright column of cells with the eight around it, points are looked at from the lowest up: up to `count`
/// of them with a gap of `depth` or more above them are low points, where more than `count` points lie above the
/// gap; those of the column in the middle are marked. So a group as large as `count` is found, as with the low
/// points of other programs, while the ground at the foot of a wall is not, as more points of it are near. The same
/// upside down, with a gap of `height`, finds birds and clouds. Columns go through the zero of the coordinates
/// (WorldGrid): the result does not depend on how a survey is cut. Points of the noise classes are left out.
class LowPointsStep final : public Step
{
public:
    const StepDescription& description() const override;

private:
    std::unique_ptr<Command> make(const PointCloud& cloud, const StepValues& values, const PointSet* within,
                                  Progress& progress) const override;
};

}  // namespace punctum
