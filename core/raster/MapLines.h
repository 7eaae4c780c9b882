// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <string>
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

/// Places on a map, and what is told of each: the columns of a table beside X and Y.
struct MapTable {
    struct Column {
        std::string name;  ///< "crown_area": letters, digits and _
        int decimals = 0;  ///< at most
    };
    struct Row {
        glm::dvec3 place{0.0};       ///< `world`
        std::vector<double> values;  ///< one for each column; NaN: none
    };
    std::vector<Column> columns;
    std::vector<Row> rows;
    std::string layer;  ///< of DXF: "TREE"
};

}  // namespace punctum
