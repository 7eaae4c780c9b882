// SPDX-License-Identifier: MIT
#pragma once

#include "core/process/Step.h"

namespace punctum
{

/// normals k=16, or normals radius=0.5 (units of length): adds NormalX, NormalY, NormalZ (float32) and the vector
/// Normal.
///
/// The normal of the plane of least squares through a point's neighbors (itself among them, as PCL counts): the
/// eigenvector of the covariance's least eigenvalue (Hoppe et al. 1992, section 3.1). It is turned upward, so that
/// NormalZ is never negative; to a viewpoint; or so that neighbors agree (orientBySpanningTree()). A point with
/// fewer than three neighbors, or with all of them in one place or on a line, has no plane: its normal is (0, 0,
/// 0). No NaN is written. Where the file has normals already, under whatever names (NormalColumns), their values
/// are replaced in their type.
class NormalsStep final : public Step
{
public:
    const StepDescription& description() const override;

private:
    std::unique_ptr<Command> make(const PointCloud& cloud, const StepValues& values, const PointSet* within,
                                  Progress& progress) const override;
};

}  // namespace punctum
