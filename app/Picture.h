// SPDX-License-Identifier: MIT
#pragma once

#include "render/resolve/Image.h"

#include <filesystem>
#include <string>
#include <utility>

namespace punctum::app
{

/// Writes a picture as PNG (8 bits a channel, with alpha), whole or not at all. Throws Error.
void writePng(const render::Image& image, const std::filesystem::path& path);

/// "1280x800" -> width and height in px, each 1 to 16384. Throws std::invalid_argument with a sentence.
std::pair<int, int> parseSize(const std::string& text);

/// What is behind the points, from the top of the picture to its bottom.
struct Background {
    render::Rgba8 top{38, 44, 52, 255};
    render::Rgba8 bottom{16, 18, 22, 255};
};
/// "white", "#202830", "transparent" or "TOP:BOTTOM". Throws std::invalid_argument with a sentence.
Background parseBackground(const std::string& text);

}  // namespace punctum::app
