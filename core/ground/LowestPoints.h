// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"
#include "core/cloud/Units.h"
#include "core/ground/HeightGrid.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

namespace punctum
{

class Progress;

/// Cells of the ground's grid: multiples of the cell's side in `world` coordinates, so that the files that the
/// points are in do not move it. In squares of kSide cells, of which only those that hold points are there: a point
/// far away costs one square.
///
/// Coordinates never change, so that nothing is locked; deleted points must not be among `used`.
class LowestPoints
{
public:
    static constexpr int kSide = 32;

    struct Square {
        std::int64_t x = 0, y = 0;  ///< in squares
        friend bool operator==(const Square&, const Square&) = default;
        friend bool operator<(const Square& a, const Square& b) noexcept
        {
            return std::tie(a.x, a.y) < std::tie(b.x, b.y);
        }
    };
    /// Where a point is in the grid.
    struct Place {
        std::int64_t x = 0, y = 0;  ///< cell
        double u = 0, v = 0;        ///< from the middle of the square's first cell, in cells
    };

    /// Of which points: `used`; the squares that they need are made. `cell`: in units of length. Throws Error when
    /// they lie too far apart for it, Cancelled.
    LowestPoints(const PointCloud& cloud, const PointSet& used, const TrueLengths& lengths, double cell,
                 Progress& progress);

    const std::vector<Square>& squares() const noexcept { return m_squares; }
    /// The square at a place; squares().size() when it is not there.
    std::size_t find(Square square) const noexcept;
    Place place(PointIndex i) const noexcept
    {
        // A point on the edge of a cell belongs to the upper one, though its coordinate be rounded down.
        constexpr double kOnEdge = 1e-6;
        const double u = double(m_x[i]) * m_scale[0] + m_offset[0], v = double(m_y[i]) * m_scale[1] + m_offset[1];
        const double x = std::floor(u + kOnEdge), y = std::floor(v + kOnEdge);
        Place at{std::int64_t(x), std::int64_t(y), 0, 0};
        at.u = u - double(squareOf(at.x) * kSide) - 0.5;
        at.v = v - double(squareOf(at.y) * kSide) - 0.5;
        return at;
    }
    static std::int64_t squareOf(std::int64_t cell) noexcept { return cell >> 5; }
    static Square squareOf(const Place& at) noexcept { return {squareOf(at.x), squareOf(at.y)}; }
    /// Of a point above base(), in units of length.
    float height(PointIndex i) const noexcept { return float(double(m_z[i]) * m_scale[2] + m_offset[2]); }

    /// The lowest heights of cells in a window; empty cells are NaN. `x`, `y`: its first cell.
    HeightGrid window(std::int64_t x, std::int64_t y, int width, int height) const;

private:
    std::span<const std::int32_t> m_x, m_y, m_z;
    std::array<double, 3> m_scale{}, m_offset{};  ///< raw -> cells, cells, heights
    std::vector<Square> m_squares;                ///< sorted
    std::vector<std::uint32_t> m_table;           ///< open addressing: a square's number + 1; 0: none
    std::vector<std::int32_t> m_lowest;           ///< raw Z of each cell of each square; INT32_MAX: none
};

}  // namespace punctum
