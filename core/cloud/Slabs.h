// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointSet.h"

#include <algorithm>
#include <bit>
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

/// The points that some words of a set over `points` points stand for.
inline PointRange pointsOfWords(PointIndex points, std::size_t firstWord, std::size_t lastWord) noexcept
{
    return {PointIndex(firstWord) * 64, std::min(points, PointIndex(lastWord) * 64)};
}

/// The points of a word of a set over `points` points that are not in `hidden`; null: none is.
inline std::uint64_t shownBits(PointIndex points, const PointSet* hidden, std::size_t word) noexcept
{
    const PointIndex rest = points - PointIndex(word) * 64;
    const std::uint64_t all = rest >= 64 ? ~std::uint64_t(0) : (std::uint64_t(1) << rest) - 1;
    return hidden == nullptr ? all : all & ~hidden->words()[word];
}

/// How many there are in some words.
inline PointIndex shownIn(PointIndex points, const PointSet* hidden, std::size_t firstWord,
                          std::size_t lastWord) noexcept
{
    if (hidden == nullptr) return pointsOfWords(points, firstWord, lastWord).size();
    PointIndex shown = 0;
    for (std::size_t w = firstWord; w != lastWord; ++w)
        shown += PointIndex(std::popcount(shownBits(points, hidden, w)));
    return shown;
}

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
