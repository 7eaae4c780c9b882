// SPDX-License-Identifier: MIT
#pragma once

#include "render/store/PointStore.h"

#include <cstddef>

namespace punctum::render
{

/// Typical distance between neighboring points of a cloud that covers surfaces, in view units (Camera::stretch); 0
/// when there are too few points to tell.
///
/// The median distance to the nearest neighbor among some thousand points, which stand for all: on a surface,
/// distances go with the root of the density, and a random pattern of one point a unit of area has a median of
/// sqrt(ln 2 / pi). Some milliseconds, in parallel; reads columns: hold the cloud's mutex() shared.
///
/// `clouds`: how many are drawn together. Of many, fewer points of each are looked at, so that all of them together
/// take about as long as one.
double pointSpacing(const PointStore& store, const glm::dvec3& stretch, std::size_t clouds = 1);

}  // namespace punctum::render
