// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace punctum
{

/// The coordinates of one file of a survey, for choosing those of all.
struct GridOfPart {
    CoordinateScale coordinates;
    WorldBounds bounds;  ///< a first idea of the extent; empty: none
    PointIndex points = 0;
};

/// Coordinates in which the points of several files are kept together.
struct CommonGrid {
    CoordinateScale coordinates;
    /// Files whose coordinates are not whole steps of it: they are shown to within half a step.
    std::vector<std::size_t> rounded;
};

/// A grid in which the coordinates of as many points as can be are whole: with the steps of one of the files, made
/// ten to a thousand times finer where that makes more of them whole, and coarser where the extent asks for it.
/// `parts` has one at least.
CommonGrid commonGrid(std::span<const GridOfPart> parts);

/// From the raw integers of one grid to those of another, axis by axis.
class GridChange
{
public:
    GridChange() = default;
    GridChange(const CoordinateScale& from, const CoordinateScale& to);

    /// Whether nothing changes.
    bool same() const noexcept { return m_same; }
    /// Whether every coordinate of the one is exactly one of the other.
    bool exact() const noexcept { return m_whole[0] && m_whole[1] && m_whole[2]; }
    /// Nearest coordinates. What lies beyond 32 bits is put at the edge; how many coordinates did.
    std::size_t operator()(int axis, std::span<const std::int32_t> from, std::int32_t* to) const noexcept;

private:
    bool m_same = true;
    std::array<bool, 3> m_whole{true, true, true};
    std::array<std::int64_t, 3> m_factor{1, 1, 1}, m_shift{};
    std::array<double, 3> m_ratio{1, 1, 1}, m_offset{};
};

}  // namespace punctum
