// SPDX-License-Identifier: MIT
// Compiled with -mavx2; called only where the processor has it. Includes no header with inline code of ours or of
// the standard library's templates, so that no AVX2 version of a shared function can be linked.
#include "core/cloud/LeastMost.h"

#if defined(__x86_64__)
#include <immintrin.h>

namespace punctum
{

LeastMost leastAndMostAvx2(const std::int32_t* values, std::size_t count) noexcept
{
    // Two of each: a minimum need not wait for the one before.
    __m256i least[2] = {_mm256_set1_epi32(INT32_MAX), _mm256_set1_epi32(INT32_MAX)};
    __m256i most[2] = {_mm256_set1_epi32(INT32_MIN), _mm256_set1_epi32(INT32_MIN)};
    std::size_t k = 0;
    for (; k + 16 <= count; k += 16)
        for (std::size_t half = 0; half < 2; ++half) {
            const __m256i v = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(values + k + 8 * half));
            least[half] = _mm256_min_epi32(least[half], v);
            most[half] = _mm256_max_epi32(most[half], v);
        }
    alignas(32) std::int32_t low[8], high[8];
    _mm256_store_si256(reinterpret_cast<__m256i*>(low), _mm256_min_epi32(least[0], least[1]));
    _mm256_store_si256(reinterpret_cast<__m256i*>(high), _mm256_max_epi32(most[0], most[1]));
    LeastMost found;
    for (std::size_t lane = 0; lane < 8; ++lane) {
        if (low[lane] < found.least) found.least = low[lane];
        if (high[lane] > found.most) found.most = high[lane];
    }
    for (; k < count; ++k) {
        if (values[k] < found.least) found.least = values[k];
        if (values[k] > found.most) found.most = values[k];
    }
    return found;
}

}  // namespace punctum
#endif
