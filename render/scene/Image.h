// SPDX-License-Identifier: MIT
#pragma once

#include "render/color/Rgba8.h"

#include <cstddef>
#include <vector>

namespace punctum::render
{

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
