// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec2.hpp>

#include <vector>

namespace punctum
{

/// A line of one height on a map.
struct ContourLine {
    double height = 0;
    bool index = false;              ///< one of those that are drawn stronger
    bool closed = false;             ///< the last point is joined to the first, which is there once
    std::vector<glm::dvec2> points;  ///< `world`; higher ground is on the left hand
};

/// An area on a map: its outer edge counterclockwise, holes clockwise; the first point of a ring is there once.
struct MapArea {
    std::vector<std::vector<glm::dvec2>> rings;
    double area = 0;  ///< square units of X and Y, without the holes
};

}  // namespace punctum
