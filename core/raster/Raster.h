// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec2.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace punctum
{

struct WorldBounds;

/// Where the cells of a raster lie: squares in the plane of X and Y whose corners are at multiples of their size,
/// so that rasters of neighboring surveys fit together. Rows are counted from north to south. A cell holds the
/// points of its western and southern edge.
struct RasterFrame {
    double cell = 1.0;      ///< side of a cell, units of `world` X and Y
    std::int64_t left = 0;  ///< of the western edge, in cells from X = 0
    std::int64_t top = 0;   ///< of the northern edge, in cells from Y = 0
    std::size_t columns = 0;
    std::size_t rows = 0;

    std::size_t cells() const noexcept { return columns * rows; }
    /// Western edge of a column, northern edge of a row, `world`.
    double west(std::size_t column) const noexcept { return double(left + std::int64_t(column)) * cell; }
    double north(std::size_t row) const noexcept { return double(top - std::int64_t(row)) * cell; }
    /// Middle of a cell, `world`.
    glm::dvec2 middle(std::size_t column, std::size_t row) const noexcept
    {
        return {(double(left + std::int64_t(column)) + 0.5) * cell, (double(top - std::int64_t(row)) - 0.5) * cell};
    }
    /// A place in cells from 0. What rounding put a last bit below a multiple of the cell is on it.
    static double inCells(double world, double cell) noexcept
    {
        const double q = world / cell;
        return q + std::abs(q) * kRounding;
    }
    friend bool operator==(const RasterFrame&, const RasterFrame&) = default;

    static constexpr double kRounding = 4.5e-16;  ///< of a coordinate and a division, as a share
    /// Cells that a raster may have: 1 GB.
    static constexpr std::size_t kMostCells = 250'000'000;
};

/// The frame of cells that holds all of a box. Throws Error when `cell` is no length, or when there would be more
/// cells than kMostCells.
RasterFrame rasterFrame(const WorldBounds& bounds, double cell);
/// The same with so many cells more on each side.
RasterFrame widened(const RasterFrame& frame, std::size_t cells);

/// A grid of numbers with its place in the world: row after row from north to south, NaN where there is none. A
/// value type.
class Raster
{
public:
    static constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

    Raster() = default;
    /// Throws Error when the memory cannot be had.
    explicit Raster(const RasterFrame& frame, float value = kNone);

    const RasterFrame& frame() const noexcept { return m_frame; }
    std::size_t columns() const noexcept { return m_frame.columns; }
    std::size_t rows() const noexcept { return m_frame.rows; }
    float at(std::size_t column, std::size_t row) const noexcept
    {
        return m_values[row * m_frame.columns + column];
    }
    float& at(std::size_t column, std::size_t row) noexcept { return m_values[row * m_frame.columns + column]; }
    std::span<float> row(std::size_t row) noexcept { return {&m_values[row * m_frame.columns], m_frame.columns}; }
    std::span<const float> row(std::size_t row) const noexcept
    {
        return {&m_values[row * m_frame.columns], m_frame.columns};
    }
    std::span<const float> values() const noexcept { return m_values; }
    std::span<float> values() noexcept { return m_values; }
    /// Cells that have a value.
    std::size_t count() const;

private:
    RasterFrame m_frame;
    std::vector<float> m_values;
};

}  // namespace punctum
