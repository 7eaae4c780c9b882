// SPDX-License-Identifier: MIT
#include "core/las/RecordBlocks.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace punctum::las
{

namespace
{

constexpr std::size_t kPieceBytes = 16 << 10;  ///< of records: with the columns' ends it fits a 32 KiB L1 cache

template <std::size_t N>
void gather(const std::byte* from, std::size_t stride, std::size_t count, std::byte* to)
{
    for (std::size_t i = 0; i < count; ++i) std::memcpy(to + i * N, from + i * stride, N);
}

template <std::size_t N>
void scatter(const std::byte* from, std::size_t stride, std::size_t count, std::byte* to)
{
    for (std::size_t i = 0; i < count; ++i) std::memcpy(to + i * stride, from + i * N, N);
}

}  // namespace

void deinterleave(const RecordLayout& layout, const std::byte* records, std::size_t count,
                  std::span<std::byte* const> columns)
{
    const std::size_t stride = layout.length;
    const std::size_t piece = std::max<std::size_t>(1, kPieceBytes / stride);
    for (std::size_t first = 0; first < count; first += piece) {
        const std::size_t n = std::min(piece, count - first);
        for (std::size_t k = 0; k < layout.fields.size(); ++k) {
            if (columns[k] == nullptr) continue;
            const std::size_t size = layout.fields[k].bytes();
            const std::byte* from = records + first * stride + layout.fields[k].offset;
            std::byte* to = columns[k] + first * size;
            switch (size) {
                case 1:
                    gather<1>(from, stride, n, to);
                    break;
                case 2:
                    gather<2>(from, stride, n, to);
                    break;
                case 4:
                    gather<4>(from, stride, n, to);
                    break;
                case 8:
                    gather<8>(from, stride, n, to);
                    break;
                default:
                    for (std::size_t i = 0; i < n; ++i) std::memcpy(to + i * size, from + i * stride, size);
            }
        }
    }
}

void interleave(const RecordLayout& layout, std::span<const std::byte* const> columns, std::size_t count,
                std::byte* records)
{
    const std::size_t stride = layout.length;
    const std::size_t piece = std::max<std::size_t>(1, kPieceBytes / stride);
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
