// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace punctum::render
{

/// 8 bits a channel, alpha not premultiplied; the layout of GL_RGBA / QImage::Format_RGBA8888.
struct Rgba8 {
    std::uint8_t r = 0, g = 0, b = 0, a = 255;
    friend bool operator==(const Rgba8&, const Rgba8&) = default;
};
static_assert(sizeof(Rgba8) == 4);

}  // namespace punctum::render
