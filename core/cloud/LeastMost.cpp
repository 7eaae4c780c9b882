// SPDX-License-Identifier: MIT
#include "core/cloud/LeastMost.h"

#include <algorithm>

namespace punctum
{

LeastMost leastAndMostBaseline(const std::int32_t* values, std::size_t count) noexcept
{
    LeastMost found;
    for (std::size_t k = 0; k < count; ++k) {
        found.least = std::min(found.least, values[k]);
        found.most = std::max(found.most, values[k]);
    }
    return found;
}

LeastMost leastAndMost(const std::int32_t* values, std::size_t count) noexcept
{
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx2")) return leastAndMostAvx2(values, count);
#endif
    return leastAndMostBaseline(values, count);
}

}  // namespace punctum
