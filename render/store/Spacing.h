// SPDX-License-Identifier: MIT
#pragma once

#include "render/store/PointStore.h"

namespace punctum::render
{

/// Typical distance between neighboring points of a cloud that covers surfaces, in view units (Camera::stretch); 0
/// when there are too few points to tell.
///
/// The median distance to the nearest neighbor among some thousand points, which stand for all: on a surface,
/// distances go with the root of the density, and a random pattern of one point a unit of area has a median of
/// sqrt(ln 2 / pi). Some milliseconds, in parallel; reads columns: hold the cloud's mutex() shared.
double pointSpacing(const PointStore& store, const glm::dvec3& stretch);

}  // namespace punctum::render
