// SPDX-License-Identifier: MIT
#pragma once

#include "render/store/LocalFrame.h"

#include <cstddef>
#include <cstdint>

namespace punctum::render
{

/// Position and word of a point side by side: one load fetches it.
struct alignas(16) Element {
    std::int32_t x, y, z;
    std::uint32_t word;
};

/// Slots that fill whole cache lines of positions and words.
constexpr std::uint32_t kLineSlots = 16;

/// Elements of `count` points from their raw coordinates, axis by axis, and words. False when a point is outside
/// the frame: its position is that of an empty slot then.
bool makeElements(const LocalFrame& frame, const std::int32_t* const axes[3], const std::uint32_t* words,
                  std::size_t count, Element* elements);

/// Writes kLineSlots slots past the caches: nobody reads them soon, and lines written whole need not be fetched
/// first. `positions` and `words` are aligned to cache lines. Nobody may be told of them before a store fence.
void storeLines(const Element* const* members, std::int32_t* positions, std::uint32_t* words);

}  // namespace punctum::render
