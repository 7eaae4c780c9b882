// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"

#include <array>
#include <cstdint>
#include <memory>

namespace punctum
{

/// A cell of a WorldGrid: how many cells it lies behind the grid's first one along each axis.
using CellKey = std::array<std::uint32_t, 3>;

/// Cubes (or, of two axes, upright columns) of one size in true lengths, whose faces go through the zero of the
/// world's coordinates, so that the cell of a place does not depend on what else the cloud holds.
///
/// A cell holds its lower faces. Coordinates are decimals that binary numbers only come near, so that what lies
/// within a millionth of a cell below a face counts as on it. Coordinates never change, so nothing is locked after
/// construction; every call may come from any thread.
class WorldGrid
{
public:
    /// Cells that are smaller than a step of the coordinates are as large as one: each place has its own then.
    /// Takes cloud.mutex() shared for a moment.
    WorldGrid(const PointCloud& cloud, double size, int axes = 3);

    PointIndex points() const noexcept { return m_points; }
    const TrueLengths& lengths() const noexcept { return m_lengths; }
    const std::array<double, 3>& scale() const noexcept { return m_scale; }  ///< units of length of a raw step
    std::array<std::int32_t, 3> raw(std::size_t point) const noexcept
    {
        return {m_raw[0][point], m_raw[1][point], m_raw[2][point]};
    }
    CellKey cellOf(std::size_t point) const noexcept
    {
        CellKey key{};
        for (std::size_t a = 0; a < 3; ++a) {
            const double place = double(m_raw[a][point]) * m_factor[a] + m_shift[a];
            key[a] = std::uint32_t(std::int64_t(place));  // never negative
        }
        return key;
    }
    /// Where the point is in a cell, from 0 to 1 inside of it.
    std::array<double, 3> placeIn(std::size_t point, const CellKey& key) const noexcept
    {
        std::array<double, 3> place{};
        for (std::size_t a = 0; a < 3; ++a)
            place[a] = double(m_raw[a][point]) * m_factor[a] + m_shift[a] - double(key[a]);
        return place;
    }
    /// From the middle of its cell, in units of length, squared; to the last bits the same in every cloud.
    double squaredFromMiddle(std::size_t point, const CellKey& key) const noexcept;
    /// Which cell of the world it is: what random choices go by.
    std::array<std::int64_t, 3> absolute(const CellKey& key) const noexcept
    {
        return {m_first[0] + key[0], m_first[1] + key[1], m_first[2] + key[2]};
    }
    /// The place of a point in whole steps of the coordinates, from the world's zero: the same number for the same
    /// place in clouds of one step, whatever their offsets.
    std::array<std::int64_t, 3> worldSteps(std::size_t point) const noexcept
    {
        return {m_zero[0] + m_raw[0][point], m_zero[1] + m_raw[1][point], m_zero[2] + m_raw[2][point]};
    }
    double squaredDistance(const std::array<std::int32_t, 3>& a,
                           const std::array<std::int32_t, 3>& b) const noexcept
    {
        double sum = 0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double d = double(std::int64_t(a[axis]) - b[axis]) * m_scale[axis];
            sum += d * d;
        }
        return sum;
    }

private:
    PointIndex m_points = 0;
    TrueLengths m_lengths;
    std::array<std::shared_ptr<const Column>, 3> m_columns;
    std::array<const std::int32_t*, 3> m_raw{};
    std::array<double, 3> m_scale{}, m_size{};        ///< units of length: of a raw step, of a cell
    std::array<double, 3> m_factor{}, m_shift{};      ///< raw -> cells behind the first one
    std::array<std::int64_t, 3> m_first{}, m_zero{};  ///< cell before the first one; steps from the world's zero
    std::array<double, 3> m_rest{};                   ///< part of a step that m_zero leaves out
};

/// Well mixed bits of whole numbers, the same everywhere.
inline std::uint64_t mixedBits(std::uint64_t value) noexcept
{
    value = (value ^ (value >> 30)) * 0xBF58476D1CE4E5B9u;
    value = (value ^ (value >> 27)) * 0x94D049BB133111EBu;
    return value ^ (value >> 31);
}
template <typename Number>
std::uint64_t mixedBits(const std::array<Number, 3>& three) noexcept
{
    std::uint64_t bits = 0x9E3779B97F4A7C15u;
    for (const Number number : three) bits = mixedBits(bits + std::uint64_t(number) * 0x9E3779B97F4A7C15u);
    return bits;
}

}  // namespace punctum
