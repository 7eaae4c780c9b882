// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

namespace punctum
{

/// The least and the greatest of some values; least > most when there is none.
struct LeastMost {
    std::int32_t least = INT32_MAX;
    std::int32_t most = INT32_MIN;
};

/// Of `count` values; with AVX2 where the processor has it. Any thread.
LeastMost leastAndMost(const std::int32_t* values, std::size_t count) noexcept;

/// The same for any processor, and for those that have AVX2 only.
LeastMost leastAndMostBaseline(const std::int32_t* values, std::size_t count) noexcept;
LeastMost leastAndMostAvx2(const std::int32_t* values, std::size_t count) noexcept;

}  // namespace punctum
