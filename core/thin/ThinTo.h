// SPDX-License-Identifier: MIT
#pragma once

#include "core/process/Step.h"

namespace punctum
{

/// thin-to method=normal-deviation count=100000: keeps exactly so many points, those that a surface needs.
///
/// Goswami, Erol, Mukhi, Pajarola, Gobbetti: An efficient multiresolution framework for high quality interactive
/// rendering of massive point clouds using multi-way kd-trees (2013), section 3.3. As there, the cloud is worked on
/// by nodes of a kd-tree. Points are chosen from the cloud where the paper makes new ones, and how many each node
/// keeps is found by holding the errors of all nodes against each other: between a quarter and four times of its
/// share. docs/dev/thinning.md compares the methods.
class ThinToStep final : public Step
{
public:
    const StepDescription& description() const override;

private:
    std::unique_ptr<Command> make(const PointCloud& cloud, const StepValues& values, const PointSet* within,
                                  Progress& progress) const override;
};

}  // namespace punctum
