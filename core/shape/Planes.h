// SPDX-License-Identifier: MIT
#pragma once

#include "core/process/Step.h"

namespace punctum
{

/// planes tolerance=0.1 angle=15 points=100: gives points that lie in one plane the same number, PlaneId, from 1
/// for the plane of most points; 0 for points of none.
///
/// Region growing from the flattest places (Rabbani, van den Heuvel, Vosselman, Segmentation of point clouds using
/// smoothness constraint, 2006), over patches of cells instead of points, which are told apart in the end (Vo,
/// Truong-Hong, Laefer, Bertolotto, Octree-based region growing for point cloud segmentation, 2015): 1. each point
/// gets the plane of its nearest neighbors; 2. in each cell of a grid points whose planes agree are a patch; 3.
/// planes grow over patches of cells that touch each other; 4. each point gets the nearest of the planes about its
/// cell. Everything goes by places, so that the planes are the same on any number of threads and however a survey
/// is cut into files.
class PlanesStep final : public Step
{
public:
    const StepDescription& description() const override;

private:
    std::unique_ptr<Command> make(const PointCloud& cloud, const StepValues& values, const PointSet* within,
                                  Progress& progress) const override;
};

}  // namespace punctum
