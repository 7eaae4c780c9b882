// SPDX-License-Identifier: MIT
#pragma once

#include "core/process/Step.h"

namespace punctum
{

/// clusters tolerance=1 points=10: gives points that hang together a number, ClusterId, from 1 for the cluster of
/// most points (of equally many: that of the first point); 0 where a cluster would have fewer points. With `within`
/// numbers go on from those of the other points (firstNumber()).
///
/// Two points hang together when they are not further apart than the tolerance: Euclidean clusters (Rusu, Semantic
/// 3D Object Maps for Everyday Manipulation in Human Living Environments, 2009, section 6.2), the same as PCL's
/// EuclideanClusterExtraction finds, by joining sets in parallel. With `within`, those points alone are looked at.
class ClustersStep final : public Step
{
public:
    const StepDescription& description() const override;

private:
    std::unique_ptr<Command> make(const PointCloud& cloud, const StepValues& values, const PointSet* within,
                                  Progress& progress) const override;
};

}  // namespace punctum
