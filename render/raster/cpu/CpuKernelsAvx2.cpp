// SPDX-License-Identifier: MIT
// Compiled with -mavx2 -mfma; called only where the processor has both. Includes no header with inline code of
// ours or of the standard library's templates, so that no AVX2 version of a shared function can be linked.
#include "render/raster/cpu/CpuKernels.h"

#if defined(__x86_64__)
#include "render/raster/cpu/splat.inl"

#include <immintrin.h>

namespace punctum::render
{

namespace
{

/// For each mask of 8 lanes: the lanes that are set, packed to the front.
struct PackTable {
    alignas(32) std::uint32_t lanes[256][8];

    constexpr PackTable() : lanes{}
    {
        for (unsigned mask = 0; mask < 256; ++mask) {
            unsigned n = 0;
            for (unsigned lane = 0; lane < 8; ++lane)
                if ((mask >> lane) & 1u) lanes[mask][n++] = lane;
        }
    }
};
constexpr PackTable kPack;

/// Bytes that positions are asked for ahead. The processor's own guesses end at each page, and the atomic
/// operations between two blocks keep it from running ahead. 512 to 4096 measured; past the end it does no harm.
constexpr int kAhead = 1536;

inline __m256i loadHalves(const std::int32_t* low, const std::int32_t* high)
{
    return _mm256_inserti128_si256(_mm256_castsi128_si256(_mm_loadu_si128(reinterpret_cast<const __m128i*>(low))),
                                   _mm_loadu_si128(reinterpret_cast<const __m128i*>(high)), 1);
}

template <int Control>
inline __m256i pick(__m256i a, __m256i b)
{
    return _mm256_castps_si256(_mm256_shuffle_ps(_mm256_castsi256_ps(a), _mm256_castsi256_ps(b), Control));
}

inline __m256 row(const float* r, __m256 x, __m256 y, __m256 z)
{
    return _mm256_fmadd_ps(
        _mm256_set1_ps(r[0]), x,
        _mm256_fmadd_ps(_mm256_set1_ps(r[1]), y, _mm256_fmadd_ps(_mm256_set1_ps(r[2]), z, _mm256_set1_ps(r[3]))));
}

}  // namespace

std::size_t projectAvx2(const std::int32_t* positions, std::size_t count, std::uint32_t firstId,
                        const ProjectArguments& a, ProjectedBlock& out)
{
    const __m256i refX = _mm256_set1_epi32(a.reference[0]), refY = _mm256_set1_epi32(a.reference[1]),
                  refZ = _mm256_set1_epi32(a.reference[2]);
    const __m256 near = _mm256_set1_ps(a.nearDepth);
    const __m256 lowX = _mm256_set1_ps(a.lowX), highX = _mm256_set1_ps(a.highX);
    const __m256 lowY = _mm256_set1_ps(a.lowY), highY = _mm256_set1_ps(a.highY);
    const __m256 one = _mm256_set1_ps(1.0f);
    const __m256i eight = _mm256_set1_epi32(8);
    __m256i id = _mm256_add_epi32(_mm256_set1_epi32(int(firstId)), _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7));
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; i += 8, id = _mm256_add_epi32(id, eight)) {
        // Eight x y z triples to three vectors: m0 = x0 y0 z0 x1 | x4 .., m1 = y1 z1 x2 y2 | .., m2 = z2 x3 y3 z3 |
        // ..
        const std::int32_t* p = positions + 3 * i;
        _mm_prefetch(reinterpret_cast<const char*>(p) + kAhead, _MM_HINT_T0);
        _mm_prefetch(reinterpret_cast<const char*>(p) + kAhead + 64, _MM_HINT_T0);
        const __m256i m0 = loadHalves(p, p + 12), m1 = loadHalves(p + 4, p + 16), m2 = loadHalves(p + 8, p + 20);
        const __m256i xy = pick<_MM_SHUFFLE(2, 1, 3, 2)>(m1, m2);  // x2 y2 x3 y3
        const __m256i yz = pick<_MM_SHUFFLE(1, 0, 2, 1)>(m0, m1);  // y0 z0 y1 z1
        const __m256i ix = pick<_MM_SHUFFLE(2, 0, 3, 0)>(m0, xy);  // x0 x1 x2 x3
        const __m256i iy = pick<_MM_SHUFFLE(3, 1, 2, 0)>(yz, xy);  // y0 y1 y2 y3
        const __m256i iz = pick<_MM_SHUFFLE(3, 0, 3, 1)>(yz, m2);  // z0 z1 z2 z3
        const __m256 x = _mm256_cvtepi32_ps(_mm256_sub_epi32(ix, refX));
        const __m256 y = _mm256_cvtepi32_ps(_mm256_sub_epi32(iy, refY));
        const __m256 z = _mm256_cvtepi32_ps(_mm256_sub_epi32(iz, refZ));
        const __m256 depth = row(a.rowD, x, y, z);
        __m256 px = row(a.rowX, x, y, z), py = row(a.rowY, x, y, z);
        if (a.perspective) {
            const __m256 inverse = _mm256_div_ps(one, depth);
            px = _mm256_mul_ps(px, inverse);
            py = _mm256_mul_ps(py, inverse);
        }
        __m256 keep = _mm256_cmp_ps(depth, near, _CMP_GE_OQ);
        keep = _mm256_and_ps(keep, _mm256_cmp_ps(px, lowX, _CMP_GE_OQ));
        keep = _mm256_and_ps(keep, _mm256_cmp_ps(px, highX, _CMP_LT_OQ));
        keep = _mm256_and_ps(keep, _mm256_cmp_ps(py, lowY, _CMP_GE_OQ));
        keep = _mm256_and_ps(keep, _mm256_cmp_ps(py, highY, _CMP_LT_OQ));
        const __m256i empty = _mm256_cmpeq_epi32(ix, _mm256_setzero_si256());
        keep = _mm256_andnot_ps(_mm256_castsi256_ps(empty), keep);
        unsigned mask = unsigned(_mm256_movemask_ps(keep));
        if (count - i < 8) mask &= (1u << (count - i)) - 1u;
        if (mask == 0) continue;
        const __m256i pack = _mm256_load_si256(reinterpret_cast<const __m256i*>(kPack.lanes[mask]));
        _mm256_storeu_ps(out.x + kept, _mm256_permutevar8x32_ps(px, pack));
        _mm256_storeu_ps(out.y + kept, _mm256_permutevar8x32_ps(py, pack));
        _mm256_storeu_si256(reinterpret_cast<__m256i*>(out.depth + kept),
                            _mm256_permutevar8x32_epi32(_mm256_castps_si256(depth), pack));
        _mm256_storeu_si256(reinterpret_cast<__m256i*>(out.id + kept), _mm256_permutevar8x32_epi32(id, pack));
        kept += unsigned(__builtin_popcount(mask));
    }
    return kept;
}

std::size_t splatAvx2(const SplatTarget& target, const ProjectedBlock& block, std::size_t count,
                      std::uint32_t* hidden)
{
    return splatBlock(target, block, count, hidden);
}

}  // namespace punctum::render

#else

namespace punctum::render
{

std::size_t projectAvx2(const std::int32_t* positions, std::size_t count, std::uint32_t firstId,
                        const ProjectArguments& a, ProjectedBlock& out)
{
    return baselineKernel().project(positions, count, firstId, a, out);
}

std::size_t splatAvx2(const SplatTarget& target, const ProjectedBlock& block, std::size_t count,
                      std::uint32_t* hidden)
{
    return baselineKernel().splat(target, block, count, hidden);
}

}  // namespace punctum::render

#endif
