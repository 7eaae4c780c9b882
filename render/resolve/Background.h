// SPDX-License-Identifier: MIT
#pragma once

#include "render/scene/ResolveSettings.h"

namespace punctum::render
{

/// The background of a row: the gradient's color, the same for all of the row.
Rgba8 backgroundOf(int row, int height, const ResolveSettings& settings) noexcept;

}  // namespace punctum::render
