// SPDX-License-Identifier: MIT
#include "render/progressive/DisplaySettings.h"

namespace punctum::render
{

DisplaySettings::DisplaySettings()
{
    const auto& classes = asprsClasses();
    for (std::size_t k = 0; k < palette.size(); ++k) palette[k] = classes[k].color;
    classVisible.fill(true);
}

}  // namespace punctum::render
