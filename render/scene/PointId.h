// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace punctum::render
{

/// Slot of one layer, in the numbering of the whole view: Layer::firstId + slot.
using PointId = std::uint32_t;
constexpr PointId kNoPoint = 0xFFFFFFFFu;

}  // namespace punctum::render
