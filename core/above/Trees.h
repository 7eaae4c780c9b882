// SPDX-License-Identifier: MIT
#pragma once

#include "core/process/Step.h"

namespace punctum
{

/// trees height=2 cell=0.5 window=1.5: adds TreeId, the number of the tree that a point is of; 0: of none.
///
/// On the highest points of cells (canopy-height model): Crowns.h has the method.
class TreesStep final : public Step
{
public:
    const StepDescription& description() const override;

private:
    std::unique_ptr<Command> make(const PointCloud& cloud, const StepValues& values, const PointSet* within,
                                  Progress& progress) const override;
};

}  // namespace punctum
