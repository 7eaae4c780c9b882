// SPDX-License-Identifier: MIT
#pragma once

#include "render/scene/Image.h"

#include <filesystem>
#include <string>

namespace CLI
{
class App;
}

namespace punctum::app
{

/// Writes a picture as PNG (8 bits a channel, with alpha), whole or not at all. Throws Error.
void writePng(const render::Image& image, const std::filesystem::path& path);

/// Of a picture, in px.
struct PictureSize {
    int width = 1280;
    int height = 800;
};
/// "1280x800", each 1 to 16384. Throws std::invalid_argument with a sentence.
PictureSize parseSize(const std::string& text);
/// "1280x800"
std::string sizeText(PictureSize size);
/// Adds --size.
void addSize(CLI::App& command, PictureSize& size);

/// What is behind the points, from the top of the picture to its bottom.
struct Background {
    render::Rgba8 top{38, 44, 52, 255};
    render::Rgba8 bottom{16, 18, 22, 255};
};
/// "white", "#202830", "transparent" or "TOP:BOTTOM". Throws std::invalid_argument with a sentence.
Background parseBackground(const std::string& text);

}  // namespace punctum::app
