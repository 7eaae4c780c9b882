// SPDX-License-Identifier: MIT
#include "core/las/RangeCoder.h"

#include <algorithm>
#include <climits>

namespace punctum::las
{

void BitModel::rescale() noexcept
{
    m_bitCount += m_cycle;
    if (m_bitCount > (1u << kBitShift)) {
        m_bitCount = (m_bitCount + 1) / 2;
        m_zeroCount = (m_zeroCount + 1) / 2;
        if (m_zeroCount == m_bitCount) ++m_bitCount;
    }
    const std::uint32_t scale = 0x80000000u / m_bitCount;
    m_zeroProbability = (m_zeroCount * scale) >> (31 - kBitShift);
    m_cycle = std::min(m_cycle * 5 / 4, 64u);
    m_untilUpdate = m_cycle;
}

void RangeEncoder::carry() noexcept
{
    std::size_t k = m_at;
    while (k > 0 && m_bytes[--k] == std::byte(0xFF)) m_bytes[k] = std::byte(0);
    if (k < m_at) m_bytes[k] = std::byte(unsigned(m_bytes[k]) + 1);
}

std::vector<std::byte> RangeEncoder::finish()
{
    reserve(0);
    const std::uint32_t length = m_length;
    m_length = longEnd(length) ? kMinLength >> 1 : kMinLength >> 9;
    add(endAbove(length));
    const std::size_t zeros = longEnd(length) ? 3 : 2;
    m_bytes.resize(m_at);
    m_bytes.insert(m_bytes.end(), zeros, std::byte(0));
    return std::move(m_bytes);
}

IntegerDecoder::IntegerDecoder(std::span<const std::byte> bytes) : m_size(bytes.size())
{
    m_bytes.reserve(bytes.size() + RangeDecoder::kReadAhead);
    m_bytes.assign(bytes.begin(), bytes.end());
    m_bytes.resize(bytes.size() + RangeDecoder::kReadAhead);
    m_decoder = RangeDecoder(std::span(m_bytes).first(m_size));
}

}  // namespace punctum::las
