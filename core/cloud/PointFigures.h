// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"

#include <array>
#include <cstdint>
#include <optional>
#include <utility>

namespace punctum
{

class Progress;
class PointSet;

/// What all points of a cloud come to, counted from the points themselves: what `info`, the File panel and the
/// doctor tell. Lengths and areas are in units of `world`.
struct PointFigures {
    std::uint64_t points = 0;
    RawBounds bounds;

    std::array<std::uint64_t, 256> classes{};
    std::array<std::uint64_t, 16> returns{};  ///< points by return number
    std::array<std::uint64_t, 16> pulses{};   ///< points by number of returns
    std::array<std::uint64_t, 4> channels{};  ///< points by scanner channel
    std::uint64_t lastReturns = 0;            ///< return number = number of returns
    std::uint64_t returnsAbove = 0;           ///< return number above the number of returns, which is not 0
    std::uint64_t noReturns = 0;              ///< number of returns 0
    std::uint64_t synthetic = 0, keyPoint = 0, withheld = 0, overlap = 0, scanDirection = 0, edgeOfFlightLine = 0;

    std::optional<std::pair<double, double>> gpsTime;  ///< first and last; nothing without GPS times
    std::uint32_t colorBits = 0;                       ///< all bits that Red, Green and Blue have set anywhere
    double scanAngleMost = 0.0;                        ///< largest magnitude, degrees

    /// A box without points far away: that of the middle 99 % of a sample, widened by its size on each side.
    WorldBounds common;
    std::uint64_t strays = 0;   ///< farther away than 20 times the extent of the middle
    double area = 0.0;          ///< on which there are points, from above
    double density = 0.0;       ///< points on a square unit of it; 0 where it cannot be told
    double pulseDensity = 0.0;  ///< last returns on a square unit
    double spacing = 0.0;       ///< typical distance of neighbors from above: one over the root of the density
};

/// Counts in parallel. `leftOut`: points that do not count (deleted, or unreadable); null: none. Holds
/// cloud.mutex() shared for some 20 ms at a time. Throws Cancelled.
PointFigures computePointFigures(const PointCloud& cloud, const PointSet* leftOut, Progress& progress);

}  // namespace punctum
