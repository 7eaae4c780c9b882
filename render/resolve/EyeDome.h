// SPDX-License-Identifier: MIT
#pragma once

#include "render/resolve/Image.h"

#include <span>

namespace punctum::render
{

/// Darkens each pixel by how far it lies behind its neighbors, so that shapes show without normals: eye-dome
/// lighting (C. Boucheny, "Interactive scientific visualization of large datasets", PhD thesis, Grenoble 2009).
///
/// The depth that makes a pixel dark is a share of the depth range in the picture (2nd to 98th percentile of the
/// logarithm in perspective, of the depth itself in an orthographic view): a room and a mountain look alike.
///
/// `depths`: of each pixel, along the view direction, rows from the top; infinity where there is no point. Those
/// pixels keep their color. `strength`: 0 for none, 1 as usual. `pointSize`: px, as far away neighbors are looked
/// for. In parallel; the result depends on nothing but the arguments.
void shadeEyeDome(std::span<const float> depths, bool perspective, float strength, double pointSize, Image& image);

}  // namespace punctum::render
