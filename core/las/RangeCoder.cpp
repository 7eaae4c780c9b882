// SPDX-License-Identifier: MIT
#include "core/las/RangeCoder.h"

#include <algorithm>
#include <climits>

namespace punctum::las
{

namespace
{

constexpr std::uint32_t kMinLength = 1u << 24;
constexpr unsigned kHighBits = IntegerModels<32, 2>::kHighBits;
constexpr unsigned kDirectBits = 19;  ///< most bits coded without a model at once
constexpr unsigned kIntegerBits = 32;

}  // namespace

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

void IntegerEncoder::add(std::uint32_t amount)
{
    const std::uint32_t before = m_base;
    m_base += amount;
    if (m_base >= before) return;
    // carry into the bytes that are out already
    std::size_t k = m_bytes.size();
    while (k > 0 && m_bytes[--k] == std::byte(0xFF)) m_bytes[k] = std::byte(0);
    if (k < m_bytes.size()) m_bytes[k] = std::byte(unsigned(m_bytes[k]) + 1);
}

void IntegerEncoder::renormalize()
{
    while (m_length < kMinLength) {
        m_bytes.push_back(std::byte(m_base >> 24));
        m_base <<= 8;
        m_length <<= 8;
    }
}

template <unsigned Most>
void IntegerEncoder::putSymbol(SymbolModel<Most>& model, unsigned symbol)
{
    if (symbol + 1 == model.symbols()) {
        const std::uint32_t x = model.below(symbol) * (m_length >> kSymbolShift);
        add(x);
        m_length -= x;
    } else {
        m_length >>= kSymbolShift;
        const std::uint32_t x = model.below(symbol) * m_length;
        add(x);
        m_length = model.below(symbol + 1) * m_length - x;
    }
    renormalize();
    model.count(symbol);
}

void IntegerEncoder::putBit(BitModel& model, bool bit)
{
    const std::uint32_t x = model.zero() * (m_length >> kBitShift);
    if (bit) {
        add(x);
        m_length -= x;
    } else {
        m_length = x;
    }
    renormalize();
    model.count(bit);
}

void IntegerEncoder::putBits(unsigned bits, std::uint32_t value)
{
    if (bits > kDirectBits) {
        putBits(16, value & 0xFFFFu);
        value >>= 16;
        bits -= 16;
    }
    m_length >>= bits;
    add(value * m_length);
    renormalize();
}

void IntegerEncoder::encode(std::int32_t predicted, std::int32_t real, unsigned context)
{
    const std::uint32_t difference = std::uint32_t(real) - std::uint32_t(predicted);  // wraps, as the format does
    const std::int64_t c = std::int32_t(difference);
    unsigned k = 0;
    for (std::uint64_t m = std::uint64_t(c <= 0 ? -c : c - 1); m != 0; m >>= 1) ++k;
    putSymbol(m_models.lengths[context], k);
    if (k == 0) {
        putBit(m_models.tiny, c != 0);
    } else if (k < kIntegerBits) {
        const auto folded = std::uint32_t(c < 0 ? c + ((std::int64_t(1) << k) - 1) : c - 1);
        if (k <= kHighBits) {
            putSymbol(m_models.high[k - 1], folded);
        } else {
            const unsigned low = k - kHighBits;
            putSymbol(m_models.high[k - 1], folded >> low);
            putBits(low, folded & ((1u << low) - 1));
        }
    }
}

std::vector<std::byte> IntegerEncoder::finish()
{
    const bool longEnd = m_length > 2 * kMinLength;
    add(longEnd ? kMinLength : kMinLength / 2);
    m_length = longEnd ? kMinLength >> 1 : kMinLength >> 9;
    renormalize();
    m_bytes.insert(m_bytes.end(), longEnd ? 3 : 2, std::byte(0));
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
