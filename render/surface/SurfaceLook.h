// SPDX-License-Identifier: MIT
#pragma once

namespace punctum::render
{

/// How the ground surface is colored.
enum class SurfaceLook {
    None,     ///< it is not drawn
    Gray,     ///< shaded relief
    Heights,  ///< shaded relief, tinted by height
};

}  // namespace punctum::render
