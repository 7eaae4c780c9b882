// SPDX-License-Identifier: MIT
#pragma once

#include "core/process/Step.h"

namespace punctum
{

/// thin method=grid cell=1 keep=middle, thin method=distance radius=1, thin method=number count=100000: keeps some
/// points (Choices.h), and deletes or marks the others.
///
/// Told which points it may change, it thins those as if there were no others.
class ThinStep final : public Step
{
public:
    const StepDescription& description() const override;

private:
    std::unique_ptr<Command> make(const PointCloud& cloud, const StepValues& values, const PointSet* within,
                                  Progress& progress) const override;
};

}  // namespace punctum
