// SPDX-License-Identifier: MIT
#pragma once

#include "render/scene/Image.h"

#include <vector>

namespace punctum::render
{

/// Closes holes of up to 2 * kHoleReach px in a picture that is not finished: a pixel that shows nothing, or
/// something far behind, while most of its neighbors show one surface in front, takes that surface's color. For
/// frames in motion; what it paints is a guess, and finished pictures do without.
///
/// `depths`: of each pixel, as VisibilityBuffer::depths() gives them; filled pixels get their neighbor's. In
/// parallel; depends on nothing but the arguments. Returns how many pixels were filled.
std::size_t fillHoles(std::vector<float>& depths, Image& image);

constexpr int kHoleReach = 2;  ///< px that a surface grows into a hole

}  // namespace punctum::render
