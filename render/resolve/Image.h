// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

namespace punctum::render
{

/// 8 bits a channel, alpha not premultiplied; the layout of GL_RGBA / QImage::Format_RGBA8888.
struct Rgba8 {
    std::uint8_t r = 0, g = 0, b = 0, a = 255;
    friend bool operator==(const Rgba8&, const Rgba8&) = default;
};
static_assert(sizeof(Rgba8) == 4);

/// A picture: width x height, rows from the top, without padding.
struct Image {
    int width = 0;
    int height = 0;
    std::vector<Rgba8> pixels;

    void resize(int w, int h)
    {
        width = w;
        height = h;
        pixels.resize(std::size_t(w) * std::size_t(h));
    }
    Rgba8& at(int x, int y) { return pixels[std::size_t(y) * std::size_t(width) + std::size_t(x)]; }
    const Rgba8& at(int x, int y) const { return pixels[std::size_t(y) * std::size_t(width) + std::size_t(x)]; }
    friend bool operator==(const Image&, const Image&) = default;
};

}  // namespace punctum::render
