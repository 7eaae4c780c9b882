// SPDX-License-Identifier: MIT
#include "core/las/RecordBlocks.h"

#include <algorithm>
#include <bit>
#include <cstring>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace punctum::las
{

namespace
{

constexpr std::size_t kTransposedBytes = 16
                                         << 10;  ///< of records: with the columns' ends it fits a 32 KiB L1 cache

constexpr std::size_t kGroupBytes = 16;
constexpr std::size_t kTogether = 16;  ///< records: as many bytes as a vector has
#if defined(__SSE2__)
constexpr bool kTransposes = true;
#else
constexpr bool kTransposes = false;
#endif

template <std::size_t N>
void gather(const std::byte* from, std::size_t stride, std::size_t count, std::byte* to)
{
    for (std::size_t i = 0; i < count; ++i) std::memcpy(to + i * N, from + i * stride, N);
}

/// One field of `count` records.
void copyField(std::size_t bytes, const std::byte* from, std::size_t stride, std::size_t count, std::byte* to)
{
    switch (bytes) {
        case 1:
            return gather<1>(from, stride, count, to);
        case 2:
            return gather<2>(from, stride, count, to);
        case 4:
            return gather<4>(from, stride, count, to);
        case 8:
            return gather<8>(from, stride, count, to);
        default:
            for (std::size_t i = 0; i < count; ++i) std::memcpy(to + i * bytes, from + i * stride, bytes);
    }
}

template <std::size_t N>
void scatter(const std::byte* from, std::size_t stride, std::size_t count, std::byte* to)
{
    for (std::size_t i = 0; i < count; ++i) std::memcpy(to + i * stride, from + i * N, N);
}

}  // namespace

Deinterleaver::Deinterleaver(const RecordLayout& layout) : m_stride(layout.length)
{
    for (std::size_t k = 0; k < layout.fields.size(); ++k) {
        const std::size_t offset = layout.fields[k].offset, bytes = layout.fields[k].bytes();
        m_fields.push_back({offset, bytes});
        const bool sized = bytes == 8 || bytes == 4 || bytes == 2 || bytes == 1;
        if (sized && !m_groups.empty()) {
            const std::size_t at = offset - m_groups.back().offset;
            const bool inLane = at % 4 + bytes <= (bytes == 8 ? 8 : 4);
            if (at + bytes <= kGroupBytes && inLane) {
                m_groups.back().parts.push_back(
                    {std::uint8_t(at / 4), std::uint8_t(at % 4 * 8), std::uint8_t(bytes), k});
                continue;
            }
        }
        if (sized)
            m_groups.push_back({offset, {{0, 0, std::uint8_t(bytes), k}}});
        else
            m_alone.push_back(k);
    }
    std::erase_if(m_groups, [this](const Group& group) {
        if (kTransposes && group.parts.size() > 1) return false;
        for (const Part& part : group.parts) m_alone.push_back(part.column);
        return true;
    });
}

#if defined(__SSE2__)
/// The fields of kTogether records from `records` on, which are point `first` of the columns.
void Deinterleaver::gather(const Group& group, const std::byte* records, std::size_t stride, std::size_t first,
                           std::span<std::byte* const> columns)
{
    __m128i lanes[4][4];  // lane by lane: of four records in each vector
    for (std::size_t q = 0; q < 4; ++q) {
        const std::byte* const from = records + group.offset + 4 * q * stride;
        const auto row = [&](std::size_t r) {
            return _mm_loadu_si128(reinterpret_cast<const __m128i*>(from + r * stride));
        };
        const __m128i a = row(0), b = row(1), c = row(2), d = row(3);
        const __m128i ab01 = _mm_unpacklo_epi32(a, b), cd01 = _mm_unpacklo_epi32(c, d);
        const __m128i ab23 = _mm_unpackhi_epi32(a, b), cd23 = _mm_unpackhi_epi32(c, d);
        lanes[0][q] = _mm_unpacklo_epi64(ab01, cd01);
        lanes[1][q] = _mm_unpackhi_epi64(ab01, cd01);
        lanes[2][q] = _mm_unpacklo_epi64(ab23, cd23);
        lanes[3][q] = _mm_unpackhi_epi64(ab23, cd23);
    }
    for (const Part& part : group.parts) {
        if (columns[part.column] == nullptr) continue;
        auto* to = reinterpret_cast<__m128i*>(columns[part.column] + first * part.bytes);
        const __m128i* const v = lanes[part.lane];
        const __m128i shift = _mm_cvtsi32_si128(part.shift);
        if (part.bytes == 8) {
            const __m128i* const high = lanes[part.lane + 1];
            // Mostly GPS time, which nobody reads soon: past the caches, where lines need not be fetched first.
            const bool past = reinterpret_cast<std::uintptr_t>(to) % sizeof(__m128i) == 0;
            for (std::size_t q = 0; q < 4; ++q) {
                const __m128i front = _mm_unpacklo_epi32(v[q], high[q]), back = _mm_unpackhi_epi32(v[q], high[q]);
                if (past) {
                    _mm_stream_si128(to++, front);
                    _mm_stream_si128(to++, back);
                } else {
                    _mm_storeu_si128(to++, front);
                    _mm_storeu_si128(to++, back);
                }
            }
        } else if (part.bytes == 4) {
            for (std::size_t q = 0; q < 4; ++q) _mm_storeu_si128(to++, v[q]);
        } else if (part.bytes == 2) {
            // as signed numbers, because SSE2 packs no others without changing their bits
            const auto low = [&](__m128i lane) {
                return _mm_srai_epi32(_mm_slli_epi32(_mm_srl_epi32(lane, shift), 16), 16);
            };
            _mm_storeu_si128(to, _mm_packs_epi32(low(v[0]), low(v[1])));
            _mm_storeu_si128(to + 1, _mm_packs_epi32(low(v[2]), low(v[3])));
        } else {
            const __m128i byte = _mm_set1_epi32(255);
            const auto low = [&](__m128i lane) { return _mm_and_si128(_mm_srl_epi32(lane, shift), byte); };
            const __m128i front = _mm_packs_epi32(low(v[0]), low(v[1]));
            const __m128i back = _mm_packs_epi32(low(v[2]), low(v[3]));
            _mm_storeu_si128(to, _mm_packus_epi16(front, back));
        }
    }
}
#else
void Deinterleaver::gather(const Group&, const std::byte*, std::size_t, std::size_t, std::span<std::byte* const>) {}
#endif

void Deinterleaver::operator()(const std::byte* records, std::size_t count,
                               std::span<std::byte* const> columns) const
{
    const auto copy = [&](std::size_t column, std::size_t first, std::size_t last) {
        if (columns[column] == nullptr) return;
        const auto [offset, bytes] = m_fields[column];
        copyField(bytes, records + first * m_stride + offset, m_stride, last - first,
                  columns[column] + first * bytes);
    };
    // What a group reads behind the last field of a record must be there: at least one record stays for the end.
    const std::size_t together = m_groups.empty() || count == 0 ? 0 : (count - 1) / kTogether * kTogether;
    const std::size_t piece = std::max<std::size_t>(1, kTransposedBytes / m_stride / kTogether) * kTogether;
    for (std::size_t first = 0; first < together; first += piece) {
        const std::size_t last = std::min(together, first + piece);
        for (const Group& group : m_groups)
            for (std::size_t i = first; i < last; i += kTogether)
                gather(group, records + i * m_stride, m_stride, i, columns);
        for (const std::size_t column : m_alone) copy(column, first, last);
    }
    for (std::size_t column = 0; column < m_fields.size(); ++column) copy(column, together, count);
#if defined(__SSE2__)
    _mm_sfence();  // what went past the caches is there before anybody is told of it
#endif
}

void interleave(const RecordLayout& layout, std::span<const std::byte* const> columns, std::size_t count,
                std::byte* records)
{
    const std::size_t stride = layout.length;
    const std::size_t piece = std::max<std::size_t>(1, kTransposedBytes / stride);
    for (std::size_t first = 0; first < count; first += piece) {
        const std::size_t n = std::min(piece, count - first);
        for (std::size_t k = 0; k < layout.fields.size(); ++k) {
            const std::size_t size = layout.fields[k].bytes();
            std::byte* to = records + first * stride + layout.fields[k].offset;
            if (columns[k] == nullptr) {
                for (std::size_t i = 0; i < n; ++i) std::memset(to + i * stride, 0, size);
                continue;
            }
            const std::byte* from = columns[k] + first * size;
            switch (size) {
                case 1:
                    scatter<1>(from, stride, n, to);
                    break;
                case 2:
                    scatter<2>(from, stride, n, to);
                    break;
                case 4:
                    scatter<4>(from, stride, n, to);
                    break;
                case 8:
                    scatter<8>(from, stride, n, to);
                    break;
                default:
                    for (std::size_t i = 0; i < n; ++i) std::memcpy(to + i * stride, from + i * size, size);
            }
        }
    }
}

std::vector<std::uint32_t> spreadOrder(std::uint32_t count)
{
    // The bit-reversed numbers (van der Corput's sequence), without those that are too large.
    std::vector<std::uint32_t> order;
    if (count == 0) return order;
    order.reserve(count);
    const int bits = std::bit_width(count - 1);
    for (std::uint64_t k = 0; k < std::uint64_t(1) << bits; ++k) {
        std::uint32_t r = 0;
        for (int b = 0; b < bits; ++b) r |= std::uint32_t((k >> b) & 1) << (bits - 1 - b);
        if (r < count) order.push_back(r);
    }
    return order;
}

}  // namespace punctum::las
