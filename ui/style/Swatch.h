// SPDX-License-Identifier: MIT
#pragma once

#include "render/color/ColorMap.h"

#include <QIcon>

namespace punctum::ui
{

/// A class's color as the icon of an item in a list.
QIcon swatchIcon(render::Rgba8 color);

}  // namespace punctum::ui
