// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <array>
#include <cstddef>
#include <cstdint>

namespace punctum::render
{

/// The most planes that cut a view: kMostCuts that the user may place, and the four sides of a section.
constexpr std::size_t kMostClipPlanes = 10;
constexpr std::size_t kMostCuts = 6;

/// Which part of a cloud is drawn, in its store's local integers: points with low <= local <= high, and for each
/// plane dot(plane.xyz, q) + plane.w >= 0, where q = float(local - reference) of the layer's projection.
struct LayerClip {
    bool on = false;
    glm::ivec3 low{INT32_MIN}, high{INT32_MAX};
    std::size_t planeCount = 0;
    std::array<glm::vec4, kMostClipPlanes> planes{};
};

}  // namespace punctum::render
