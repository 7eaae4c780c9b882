// SPDX-License-Identifier: MIT
// Compiled with -mavx2; called only where the processor has it. Includes no header with inline code of ours or of
// the standard library's templates, so that no AVX2 version of a shared function can be linked.
#include "core/neighbors/LeafScan.h"

#if defined(__x86_64__)
#include <immintrin.h>

namespace punctum
{

namespace
{

/// For each of 256 masks the lanes that are set, a byte each, in rising order.
struct LaneLists {
    std::uint64_t lanes[256];
    constexpr LaneLists() : lanes()
    {
        for (unsigned mask = 0; mask < 256; ++mask) {
            unsigned at = 0;
            for (unsigned lane = 0; lane < 8; ++lane)
                if ((mask >> lane & 1) != 0) lanes[mask] |= std::uint64_t(lane) << (8 * at++);
        }
    }
};
constexpr LaneLists kLaneLists;

/// What is needed of a query, in all lanes.
struct QueryLanes {
    __m256i from[3];
    __m256 steps[3];
    explicit QueryLanes(const LeafScan& scan)
    {
        for (int a = 0; a < 3; ++a) {
            from[a] = _mm256_set1_epi32(scan.from[a]);
            steps[a] = _mm256_set1_ps(scan.steps[a]);
        }
    }
    __m256 squared(__m256i d0, __m256i d1, __m256i d2) const
    {
        const __m256 x = _mm256_cvtepi32_ps(d0), y = _mm256_cvtepi32_ps(d1), z = _mm256_cvtepi32_ps(d2);
        const __m256 xx = _mm256_mul_ps(_mm256_mul_ps(x, x), steps[0]);
        const __m256 yy = _mm256_mul_ps(_mm256_mul_ps(y, y), steps[1]);
        const __m256 zz = _mm256_mul_ps(_mm256_mul_ps(z, z), steps[2]);
        return _mm256_add_ps(_mm256_add_ps(xx, yy), zz);
    }
    __m256i outside(const std::int32_t* group, int axis) const
    {
        const __m256i min = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(group + 8 * axis));
        const __m256i max = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(group + 8 * (axis + 3)));
        const __m256i beyond =
            _mm256_max_epi32(_mm256_sub_epi32(min, from[axis]), _mm256_sub_epi32(from[axis], max));
        return _mm256_max_epi32(beyond, _mm256_setzero_si256());
    }
    /// A bit for each of the eight boxes that the limit reaches.
    unsigned boxesWithin(const std::int32_t* group, __m256 limit) const
    {
        const __m256 s = squared(outside(group, 0), outside(group, 1), outside(group, 2));
        return unsigned(_mm256_movemask_ps(_mm256_cmp_ps(s, limit, _CMP_LE_OQ)));
    }
    __m256 toPoints(const LeafScan& scan, std::uint32_t place) const
    {
        const auto d = [&](const std::int32_t* values, int axis) {
            return _mm256_sub_epi32(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(values + place)),
                                    from[axis]);
        };
        return squared(d(scan.x, 0), d(scan.y, 1), d(scan.z, 2));
    }
};

/// The first `count` of eight lanes.
unsigned firstLanes(std::size_t count)
{
    return count >= 8 ? 0xFFu : (1u << count) - 1;
}

unsigned within(__m256 squared, __m256 limit)
{
    return unsigned(_mm256_movemask_ps(_mm256_cmp_ps(squared, limit, _CMP_LE_OQ)));
}

/// place, place + 1, ..., with the lanes of the mask in front.
__m256i listed(unsigned mask)
{
    return _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(static_cast<long long>(kLaneLists.lanes[mask])));
}

std::size_t scanLeavesAvx2(const LeafScan& scan, float limit, float* squared, std::uint32_t* places) noexcept
{
    const QueryLanes query(scan);
    const __m256 limits = _mm256_set1_ps(limit);
    std::size_t found = 0;
    for (std::size_t leaf = 0; leaf < scan.leaves; leaf += 8) {
        unsigned near = query.boxesWithin(scan.boxes + leaf * 6, limits) & firstLanes(scan.leaves - leaf);
        for (; near != 0; near &= near - 1) {
            const std::size_t at = leaf + unsigned(__builtin_ctz(near));
            const std::uint32_t first = scan.firsts[at], count = scan.counts[at];
            for (std::uint32_t k = 0; k < count; k += 8) {
                const __m256 s = query.toPoints(scan, first + k);
                const unsigned mask = within(s, limits) & firstLanes(count - k);
                const __m256i lanes = listed(mask);
                _mm256_storeu_ps(squared + found, _mm256_permutevar8x32_ps(s, lanes));
                _mm256_storeu_si256(reinterpret_cast<__m256i*>(places + found),
                                    _mm256_add_epi32(lanes, _mm256_set1_epi32(int(first + k))));
                found += unsigned(__builtin_popcount(mask));
            }
        }
    }
    return found;
}

std::size_t countInLeavesAvx2(const LeafScan& scan, float sure, float limit, std::size_t enough,
                              std::uint32_t* places, std::size_t* looks) noexcept
{
    const QueryLanes query(scan);
    const __m256 limits = _mm256_set1_ps(limit), sures = _mm256_set1_ps(sure);
    std::size_t found = 0, open = 0;
    for (std::size_t leaf = 0; leaf < scan.leaves && found < enough; leaf += 8) {
        unsigned near = query.boxesWithin(scan.boxes + leaf * 6, limits) & firstLanes(scan.leaves - leaf);
        for (; near != 0 && found < enough; near &= near - 1) {
            const std::size_t at = leaf + unsigned(__builtin_ctz(near));
            const std::uint32_t first = scan.firsts[at], count = scan.counts[at];
            for (std::uint32_t k = 0; k < count; k += 8) {
                const __m256 s = query.toPoints(scan, first + k);
                const unsigned valid = firstLanes(count - k);
                const unsigned surely = within(s, sures) & valid;
                found += unsigned(__builtin_popcount(surely));
                for (unsigned rest = within(s, limits) & valid & ~surely; rest != 0; rest &= rest - 1)
                    places[open++] = first + k + unsigned(__builtin_ctz(rest));
            }
        }
    }
    *looks = open;
    return found;
}

/// Ranks of `vectors` times eight distances from `first` on, so that each other one is loaded once for all of them.
template <int vectors>
void rankTogether(const float* squared, std::size_t first, std::size_t count, std::uint32_t* ranks)
{
    __m256 own[vectors];
    __m256i smaller[vectors];
    for (int v = 0; v < vectors; ++v) {
        own[v] = _mm256_loadu_ps(squared + first + 8 * v);
        smaller[v] = _mm256_setzero_si256();
    }
    for (std::size_t j = 0; j < count; ++j) {
        const __m256 other = _mm256_broadcast_ss(squared + j);
        for (int v = 0; v < vectors; ++v)
            smaller[v] =
                _mm256_sub_epi32(smaller[v], _mm256_castps_si256(_mm256_cmp_ps(other, own[v], _CMP_LT_OQ)));
    }
    for (int v = 0; v < vectors; ++v)
        _mm256_storeu_si256(reinterpret_cast<__m256i*>(ranks + first + 8 * v), smaller[v]);
}

void rankAvx2(float* squared, std::size_t count, std::uint32_t* ranks) noexcept
{
    std::size_t i = 0;
    for (; i + 24 < count; i += 32) rankTogether<4>(squared, i, count, ranks);
    if (i + 16 < count)
        rankTogether<3>(squared, i, count, ranks);
    else if (i + 8 < count)
        rankTogether<2>(squared, i, count, ranks);
    else if (i < count)
        rankTogether<1>(squared, i, count, ranks);
}

}  // namespace

LeafFunctions leafFunctionsAvx2() noexcept
{
    return {scanLeavesAvx2, countInLeavesAvx2, rankAvx2};
}

}  // namespace punctum
#else
namespace punctum
{

LeafFunctions leafFunctionsAvx2() noexcept
{
    return {};
}

}  // namespace punctum
#endif
