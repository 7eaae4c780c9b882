// SPDX-License-Identifier: MIT
#pragma once

#include "core/process/Step.h"

namespace punctum
{

/// isolated step=4 isolated=5 do=class class=7: points whose cell, with the 26 cells around it, holds at most so
/// many other points.
///
/// What lasnoise of LAStools and the isolated voxel filter of lasR do. Cells are cubes whose faces go through the
/// zero of the coordinates (WorldGrid), so that the result does not depend on how a survey is cut into files.
/// Points of the noise classes are no company, and are left as they are.
class IsolatedStep final : public Step
{
public:
    const StepDescription& description() const override;

private:
    std::unique_ptr<Command> make(const PointCloud& cloud, const StepValues& values, const PointSet* within,
                                  Progress& progress) const override;
};

}  // namespace punctum
