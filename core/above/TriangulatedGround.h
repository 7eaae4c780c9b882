// SPDX-License-Identifier: MIT
#pragma once

#include "core/above/GroundHeights.h"

namespace punctum
{

/// measureHeights() with GroundModel::Triangulated.
///
/// The ground is triangulated piece by piece (some thousand of its points and a margin), so that memory is bounded.
/// A triangle counts where the circle through its corners lies in the piece: it is then one of the triangulation of
/// the whole, which is unique; where it does not, the piece is taken larger. At the rim and over large holes of the
/// ground, where circles know no bounds, the second try counts.
void measureTriangulated(const PointCloud& cloud, const GroundTree& ground, const PointSet* within,
                         Progress& progress, const HeightVisitor& visit);

}  // namespace punctum
