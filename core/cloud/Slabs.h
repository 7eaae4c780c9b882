// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>

namespace punctum
{

class PointCloud;
class Progress;

/// Words of a PointSet that one task takes at a time: 65,536 points.
inline constexpr std::size_t kTaskWords = 1024;

/// Calls task(firstWord, lastWord) for all words of a set over the cloud, in parallel, kTaskWords at most in each
/// call and each call beginning at a multiple of that. Holds cloud.mutex() shared, and lets go of it between slabs
/// of some 20 ms, so that an edit need not wait for the whole. Counts points in `progress`, whose stage the caller
/// has begun. Throws Cancelled.
void forEachSlab(const PointCloud& cloud, Progress& progress,
                 const std::function<void(std::size_t firstWord, std::size_t lastWord)>& task);

/// 64 bytes of 0 or 1 -> 64 bits, the first byte the lowest bit.
inline std::uint64_t packFlags(const std::uint8_t* flags) noexcept
{
    std::uint64_t word = 0;
    for (unsigned b = 0; b < 8; ++b) {
        std::uint64_t eight;
        std::memcpy(&eight, flags + 8 * b, sizeof eight);
        // the product's top byte gathers the low bit of each of the eight bytes
        word |= ((eight * 0x0102040810204080u) >> 56) << (8 * b);
    }
    return word;
}

}  // namespace punctum
