// SPDX-License-Identifier: MIT
#pragma once

#include "render/progressive/DisplaySettings.h"
#include "render/store/PointStore.h"

#include <cstddef>
#include <vector>

namespace punctum::render
{

/// Adds values of an attribute of up to `most` points of a store that the display shows, spread evenly over these:
/// of no deleted ones, none of hidden classes, none outside of the clip, none that were not read yet. Of a large
/// store that shows next to nothing, some million slots are looked at. Values that are no numbers are left out.
///
/// Render thread; hold the cloud's mutex() shared.
void addShownValues(const PointStore& store, const Attribute& attribute, const DisplaySettings& display,
                    std::size_t most, std::vector<double>& values);

}  // namespace punctum::render
