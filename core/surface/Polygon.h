// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec2.hpp>

#include <span>
#include <vector>

namespace punctum
{

/// Corners of a closed line, in either direction; the first one is there once.
using Ring = std::vector<glm::dvec2>;

/// Whether a place is inside of a ring; where the ring crosses itself, every other part is inside. Of places on the
/// ring itself some are.
bool isInside(const Ring& ring, const glm::dvec2& place) noexcept;
/// The same of several: holes are rings inside of others.
bool isInside(std::span<const Ring> rings, const glm::dvec2& place) noexcept;

/// Positive when counterclockwise. From the first corner, so that large coordinates keep their digits.
double signedArea(const Ring& ring) noexcept;

/// What part of each cell of a lattice lies inside of rings, row by row. What a row has in all is exact, but for
/// rows in which edges cross; how it is shared among cells comes of eight lines a row and more. A value for one
/// thread.
///
/// Example, a rectangle of a lattice whose cells are dx by dy:
///     CellCover cover(rings, minY, maxY);
///     for (int j = 0; j < rows; ++j)
///         for (const CellCover::Part& part : cover.row(minX, dx, columns, minY + j * dy, dy))
///             area += part.share * dx * dy;
class CellCover
{
public:
    /// Rows will lie between two heights.
    CellCover(std::span<const Ring> rings, double minY, double maxY);

    struct Part {
        double share = 0;  ///< of the cell, 0 to 1
        double x = 0;      ///< the middle of what is covered; only where some is
        double y = 0;
    };
    /// Of the cells of a row from x and y on.
    std::span<const Part> row(double x, double dx, int cells, double y, double dy);

private:
    void addSpan(double from, double to, double dx, double line, double part);

    struct Edge {
        glm::dvec2 a, b;
    };
    std::vector<Edge> m_edges;  ///< that are somewhere between those heights
    std::vector<double> m_heights, m_crossings;
    std::vector<Part> m_row;
};

/// Area inside of rings: exact, but where they cross each other or themselves.
double areaInside(std::span<const Ring> rings);

}  // namespace punctum
