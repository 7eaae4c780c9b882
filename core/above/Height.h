// SPDX-License-Identifier: MIT
#pragma once

#include "core/process/Step.h"

namespace punctum
{

/// height ground=2 method=triangulated neighbors=3: adds HeightAboveGround, the height of each point above the
/// ground below it.
///
/// The ground between its points is their Delaunay triangulation, or the mean of the nearest ones' heights by the
/// inverse of their distances (Shepard 1968), as PDAL's filters.hag_delaunay and filters.hag_nn have it.
class HeightStep final : public Step
{
public:
    const StepDescription& description() const override;

private:
    std::unique_ptr<Command> make(const PointCloud& cloud, const StepValues& values, const PointSet* within,
                                  Progress& progress) const override;
};

}  // namespace punctum
