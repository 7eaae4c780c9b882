// SPDX-License-Identifier: MIT
#include "render/store/SlotElements.h"

#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include <cstring>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace punctum::render
{

namespace
{

/// Elements of `count` points by 32-bit differences, if they are right, that is, all points are inside a frame of
/// this origin (without shift), as they nearly always are. False, with elements of no meaning, when one is not.
bool makeElementsInside(const glm::i64vec3& origin, const std::int32_t* const axes[3], const std::uint32_t* words,
                        std::size_t count, Element* elements)
{
    const glm::i64vec3 first = origin + std::int64_t(1), last = origin + std::int64_t(INT32_MAX - 1);
    const glm::i64vec3 least(INT32_MIN), most(INT32_MAX);
    if (glm::any(glm::greaterThan(first, most)) || glm::any(glm::lessThan(last, least))) return false;
    const glm::ivec3 low(glm::max(first, least)), high(glm::min(last, most));
    int outside = 0;
    std::size_t k = 0;
#if defined(__SSE2__)
    const auto load = [](const void* p) { return _mm_loadu_si128(static_cast<const __m128i*>(p)); };
    __m128i beyond = _mm_setzero_si128();
    const auto difference = [&](int a, __m128i v) {
        beyond = _mm_or_si128(beyond, _mm_or_si128(_mm_cmplt_epi32(v, _mm_set1_epi32(low[a])),
                                                   _mm_cmpgt_epi32(v, _mm_set1_epi32(high[a]))));
        return _mm_sub_epi32(v, _mm_set1_epi32(std::int32_t(std::uint32_t(origin[a]))));
    };
    for (; k + 4 <= count; k += 4) {
        const __m128i x = difference(0, load(axes[0] + k)), y = difference(1, load(axes[1] + k));
        const __m128i z = difference(2, load(axes[2] + k)), word = load(words + k);
        const __m128i xy01 = _mm_unpacklo_epi32(x, y), zw01 = _mm_unpacklo_epi32(z, word);
        const __m128i xy23 = _mm_unpackhi_epi32(x, y), zw23 = _mm_unpackhi_epi32(z, word);
        auto* const to = reinterpret_cast<__m128i*>(elements + k);
        _mm_store_si128(to, _mm_unpacklo_epi64(xy01, zw01));
        _mm_store_si128(to + 1, _mm_unpackhi_epi64(xy01, zw01));
        _mm_store_si128(to + 2, _mm_unpacklo_epi64(xy23, zw23));
        _mm_store_si128(to + 3, _mm_unpackhi_epi64(xy23, zw23));
    }
    outside = _mm_movemask_epi8(beyond);
#endif
    for (; k < count; ++k) {
        std::int32_t local[3];
        for (int a = 0; a < 3; ++a) {
            const std::int32_t v = axes[a][k];
            outside |= int(v < low[a]) | int(v > high[a]);
            local[a] = std::int32_t(std::uint32_t(v) - std::uint32_t(origin[a]));
        }
        elements[k] = {local[0], local[1], local[2], words[k]};
    }
    return outside == 0;
}

}  // namespace

bool makeElements(const LocalFrame& frame, const std::int32_t* const axes[3], const std::uint32_t* words,
                  std::size_t count, Element* elements)
{
    const glm::i64vec3 o = frame.origin;
    if (frame.shift == 0 && makeElementsInside(o, axes, words, count, elements)) return true;
    bool inside = true;
    const auto fits = [](std::int64_t v) { return v > 0 && v < INT32_MAX; };
    for (std::size_t k = 0; k < count; ++k) {
        const std::int64_t lx = (axes[0][k] - o.x) >> frame.shift, ly = (axes[1][k] - o.y) >> frame.shift,
                           lz = (axes[2][k] - o.z) >> frame.shift;
        const bool in = fits(lx) & fits(ly) & fits(lz);
        elements[k] = {in ? std::int32_t(lx) : 0, in ? std::int32_t(ly) : 0, in ? std::int32_t(lz) : 0, words[k]};
        inside &= in;
    }
    return inside;
}

void storeLines(const Element* const* members, std::int32_t* positions, std::uint32_t* words)
{
#if defined(__SSE2__)
    auto* p = reinterpret_cast<__m128i*>(positions);
    auto* w = reinterpret_cast<__m128i*>(words);
    for (std::uint32_t k = 0; k < kLineSlots; k += 4, p += 3, ++w) {
        const __m128 a = _mm_load_ps(reinterpret_cast<const float*>(members[k]));  // x y z word, as bits
        const __m128 b = _mm_load_ps(reinterpret_cast<const float*>(members[k + 1]));
        const __m128 c = _mm_load_ps(reinterpret_cast<const float*>(members[k + 2]));
        const __m128 d = _mm_load_ps(reinterpret_cast<const float*>(members[k + 3]));
        const auto bits = [](__m128 v) { return _mm_castps_si128(v); };
        const __m128 firstPairs = _mm_shuffle_ps(a, b, _MM_SHUFFLE(0, 0, 2, 2));
        const __m128 secondPairs = _mm_shuffle_ps(c, d, _MM_SHUFFLE(0, 0, 2, 2));
        _mm_stream_si128(p, bits(_mm_shuffle_ps(a, firstPairs, _MM_SHUFFLE(2, 0, 1, 0))));       // ax ay az bx
        _mm_stream_si128(p + 1, bits(_mm_shuffle_ps(b, c, _MM_SHUFFLE(1, 0, 2, 1))));            // by bz cx cy
        _mm_stream_si128(p + 2, bits(_mm_shuffle_ps(secondPairs, d, _MM_SHUFFLE(2, 1, 2, 0))));  // cz dx dy dz
        const __m128 ab = _mm_unpackhi_ps(a, b), cd = _mm_unpackhi_ps(c, d);                     // z z word word
        _mm_stream_si128(w, bits(_mm_shuffle_ps(ab, cd, _MM_SHUFFLE(3, 2, 3, 2))));
    }
#else
    for (std::uint32_t k = 0; k < kLineSlots; ++k) {
        std::memcpy(positions + 3 * k, members[k], sizeof(LocalPosition));
        words[k] = members[k]->word;
    }
#endif
}

}  // namespace punctum::render
