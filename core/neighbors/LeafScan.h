// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

namespace punctum
{

/// Finds points near a place in a list of leaves, eight at once where the processor has AVX2. Private to
/// core/neighbors. Plain arrays and pointers alone: the file for AVX2 sees no inline code of others.
///
/// Distances are squared, in steps of the axis with the longest ones, and floats: differences of the raw integers,
/// which are exact, so that the relative error is below kLeafScanError however far the points are from 0. Both
/// versions compute in the same order, without fused operations: the same bits.
struct LeafScan {
    static constexpr std::size_t kTogether = 8;  ///< boxes of a group, points of a vector

    /// Boxes of the leaves in groups of eight: minX[8], minY[8], minZ[8], maxX[8], maxY[8], maxZ[8].
    const std::int32_t* boxes = nullptr;
    /// Of each leaf: place of its first point, a multiple of eight, and how many there are.
    const std::uint32_t* firsts = nullptr;
    const std::uint32_t* counts = nullptr;
    std::size_t leaves = 0;
    /// Coordinates by place, readable up to a multiple of eight.
    const std::int32_t* x = nullptr;
    const std::int32_t* y = nullptr;
    const std::int32_t* z = nullptr;
    float steps[3] = {1, 1, 1};  ///< squares of the axes' steps
    std::int32_t from[3] = {0, 0, 0};
};

/// Twice what sums of three squares of rounded differences can be off.
inline constexpr float kLeafScanError = 0x1p-20f;

/// Writes distance and place of each point not further than `limit` (squared), and returns how many. There must be
/// room for as many as the leaves hold, and eight more.
using LeafScanFunction = std::size_t (*)(const LeafScan& scan, float limit, float* squared,
                                         std::uint32_t* places) noexcept;
/// How many points are not further than `sure`; up to there and `limit` they are written down for a closer look,
/// and
/// `*looks` says how many. Stops at `enough`.
using LeafCountFunction = std::size_t (*)(const LeafScan& scan, float sure, float limit, std::size_t enough,
                                          std::uint32_t* places, std::size_t* looks) noexcept;
/// Writes the number of smaller ones of each of `count` distances; `squared` must have room for a multiple of
/// eight.
using RankFunction = void (*)(float* squared, std::size_t count, std::uint32_t* ranks) noexcept;

struct LeafFunctions {
    LeafScanFunction scan = nullptr;
    LeafCountFunction count = nullptr;
    RankFunction rank = nullptr;
};

/// Those for any processor.
LeafFunctions leafFunctionsBaseline() noexcept;
/// Those for AVX2; empty where the program was built without.
LeafFunctions leafFunctionsAvx2() noexcept;
/// The best ones for this processor.
LeafFunctions leafFunctions() noexcept;

}  // namespace punctum
