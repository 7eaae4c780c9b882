// SPDX-License-Identifier: MIT
#pragma once

#include "resources.h"

#include <string>
#include <string_view>

namespace punctum::render
{

/// A shader that the OpenGL backends share, by its name in resources/shaders/gl/; empty when there is none.
inline std::string_view shader(std::string_view name)
{
    return resource("shaders/gl/" + std::string(name));
}

}  // namespace punctum::render
