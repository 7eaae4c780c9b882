// SPDX-License-Identifier: MIT
#pragma once

#include "core/process/Step.h"

namespace punctum
{

/// features k=16, or features radius=1: what the neighborhood of each point looks like, in one pass.
///
/// From the eigenvalues l1 >= l2 >= l3 of the neighbors' covariance (the point itself among them): Linearity (l1 -
/// l2) / l1, Planarity (l2 - l3) / l1, Sphericity l3 / l1, Anisotropy (l1 - l3) / l1, Omnivariance, the cube root
/// of the product of their shares, Curvature l3 / (l1 + l2 + l3) (Weinmann, Jutzi, Hinz, Mallet, Semantic point
/// cloud interpretation based on optimal neighborhoods, relevant features and efficient classifiers, 2015,
/// section 3.2); Verticality 1 - |nz| of the plane's normal; Roughness, the distance from that plane; Density,
/// neighbors by the area of the circle that holds them. Points whose neighbors are all in one place get 0.
class FeaturesStep final : public Step
{
public:
    const StepDescription& description() const override;

private:
    std::unique_ptr<Command> make(const PointCloud& cloud, const StepValues& values, const PointSet* within,
                                  Progress& progress) const override;
};

/// splat-radius k=16: adds SplatRadius, how large a disk at each point must be that a surface of disks has no
/// holes.
///
/// 2 sqrt(r^2 / k), r being the radius that holds the k nearest neighbors (equation 3.8 of a thesis of 2018 on
/// rendering point clouds as splats, after Preiner et al., Auto Splats: Dynamic Point Cloud Visualization on the
/// GPU, 2012).
class SplatRadiusStep final : public Step
{
public:
    const StepDescription& description() const override;

private:
    std::unique_ptr<Command> make(const PointCloud& cloud, const StepValues& values, const PointSet* within,
                                  Progress& progress) const override;
};

}  // namespace punctum
