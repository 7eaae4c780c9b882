// SPDX-License-Identifier: MIT
#pragma once

#include "core/neighbors/KdOrder.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace punctum
{

/// What flat regions are found by. Lengths in units of length.
struct PlaneOptions {
    std::size_t neighbors = 0;  ///< that a point's plane is fitted to, itself among them
    double tolerance = 0;       ///< the furthest that points may be from their plane
    double cosine = 0;          ///< of the largest angle between normals of one plane
    double cell = 0;            ///< side of the cells in which flat patches are found first
    std::size_t points = 0;     ///< the fewest of a plane
};

/// The plane of a point's neighborhood, in 4 bytes: the direction of its normal, which has no side, to a hundredth
/// of a degree, and how far neighbors are from it, in 63 levels. 0: it has none.
class PackedPlane
{
public:
    PackedPlane() = default;
    explicit PackedPlane(std::uint32_t bits) : m_bits(bits) {}
    /// `deviation`: from 0 to 1.
    PackedPlane(const std::array<double, 3>& normal, double deviation);

    std::uint32_t bits() const noexcept { return m_bits; }
    std::uint32_t level() const noexcept { return m_bits & 63u; }  ///< 0: no plane; then rising with the deviation
    std::array<double, 3> normal() const noexcept;

private:
    std::uint32_t m_bits = 0;
};

/// For each of `points` of the cloud the bits of its PackedPlane; 0 also where it is not in the order.
///
/// By least squares over the nearest neighbors; those as far as the last one are left out all together, and sums
/// are over whole steps of the coordinates, so that a plane depends on places alone, to its last bit, and not on
/// how points are dealt out to files. There is none where neighbors leave it by more than the tolerance (as a
/// standard deviation), fill space, or are on a line. Throws Cancelled.
std::vector<std::uint32_t> planesOfPoints(const KdOrder& order, std::size_t points, const PlaneOptions& options,
                                          Progress& progress);

}  // namespace punctum
