// SPDX-License-Identifier: MIT
#pragma once

#include "core/process/Step.h"

namespace punctum
{

/// duplicates same=place do=delete: all but the first of points at the same X, Y and Z, to the step of the
/// coordinates; `same` asks for the same GPS time, return or values of all fields as well.
///
/// First is what comes first in the survey, in the order of its files and of the points in them. Exact: points are
/// compared as they are stored, not by a tolerance.
class DuplicatesStep final : public Step
{
public:
    const StepDescription& description() const override;

private:
    std::unique_ptr<Command> make(const PointCloud& cloud, const StepValues& values, const PointSet* within,
                                  Progress& progress) const override;
};

}  // namespace punctum
