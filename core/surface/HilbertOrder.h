// SPDX-License-Identifier: MIT
#pragma once

#include "core/surface/Delaunay.h"

#include <cstdint>
#include <span>
#include <vector>

namespace punctum
{

/// The points along a Hilbert curve through the square about them, of 2^16 places a side; those of one place as
/// they come.
std::vector<std::uint32_t> hilbertOrder(std::span<const SurfacePoint> points);

}  // namespace punctum
