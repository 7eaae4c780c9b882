// SPDX-License-Identifier: MIT
#include "core/las/RangeCoder.h"

#include <algorithm>
#include <climits>

namespace punctum::las
{

namespace
{

constexpr unsigned kSymbolShift = 15;  ///< scale of symbol frequencies
constexpr unsigned kBitShift = 13;     ///< scale of bit probabilities
constexpr std::uint32_t kMinLength = 1u << 24;
constexpr unsigned kHighBits = 8;     ///< bits of a difference that are coded with a model
constexpr unsigned kDirectBits = 19;  ///< most bits coded without a model at once
constexpr unsigned kIntegerBits = 32;

}  // namespace

SymbolModel::SymbolModel(unsigned symbols) : m_counts(symbols, 1), m_below(symbols)
{
    m_cycle = symbols;
    rescale();
    m_untilUpdate = m_cycle = (symbols + 6) / 2;
}

void SymbolModel::count(unsigned symbol)
{
    ++m_counts[symbol];
    if (--m_untilUpdate == 0) rescale();
}

void SymbolModel::rescale()
{
    m_total += m_cycle;
    if (m_total > (1u << kSymbolShift)) {
        m_total = 0;
        for (std::uint32_t& c : m_counts) m_total += c = (c + 1) / 2;
    }
    const std::uint32_t scale = 0x80000000u / m_total;
    std::uint32_t sum = 0;
    for (std::size_t k = 0; k < m_counts.size(); ++k) {
        m_below[k] = (scale * sum) >> (31 - kSymbolShift);
        sum += m_counts[k];
    }
    m_cycle = std::min(m_cycle * 5 / 4, (symbols() + 6) * 8);
    m_untilUpdate = m_cycle;
}

void BitModel::count(bool bit)
{
    if (!bit) ++m_zeroCount;
    if (--m_untilUpdate != 0) return;
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

IntegerModels::IntegerModels() : lengths{SymbolModel(kIntegerBits + 1), SymbolModel(kIntegerBits + 1)}
{
    for (unsigned k = 1; k <= kIntegerBits; ++k) high.emplace_back(1u << std::min(k, kHighBits));
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

void IntegerEncoder::putSymbol(SymbolModel& model, unsigned symbol)
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

IntegerDecoder::IntegerDecoder(std::span<const std::byte> bytes) : m_bytes(bytes)
{
    for (int k = 0; k < 4; ++k) m_value = (m_value << 8) | nextByte();
}

std::uint32_t IntegerDecoder::nextByte()
{
    if (m_at < m_bytes.size()) return std::uint32_t(m_bytes[m_at++]);
    m_overrun = true;
    return 0;
}

void IntegerDecoder::renormalize()
{
    while (m_length < kMinLength) {
        m_value = (m_value << 8) | nextByte();
        m_length <<= 8;
    }
}

unsigned IntegerDecoder::getSymbol(SymbolModel& model)
{
    const std::uint32_t whole = m_length;
    m_length >>= kSymbolShift;
    // The last symbol whose range begins at or below the value; damaged input may lie beyond all of them.
    unsigned symbol = 0, beyond = model.symbols();
    while (beyond - symbol > 1) {
        const unsigned middle = (symbol + beyond) / 2;
        (model.below(middle) * m_length > m_value ? beyond : symbol) = middle;
    }
    const std::uint32_t x = model.below(symbol) * m_length;
    const std::uint32_t y = symbol + 1 == model.symbols() ? whole : model.below(symbol + 1) * m_length;
    m_value -= x;
    m_length = y - x;
    renormalize();
    model.count(symbol);
    return symbol;
}

bool IntegerDecoder::getBit(BitModel& model)
{
    const std::uint32_t x = model.zero() * (m_length >> kBitShift);
    const bool bit = m_value >= x;
    if (bit) {
        m_value -= x;
        m_length -= x;
    } else {
        m_length = x;
    }
    renormalize();
    model.count(bit);
    return bit;
}

std::uint32_t IntegerDecoder::getBits(unsigned bits)
{
    if (bits > kDirectBits) {
        const std::uint32_t low = getBits(16);
        return (getBits(bits - 16) << 16) | low;
    }
    m_length >>= bits;
    const std::uint32_t value = std::min(m_value / m_length, (1u << bits) - 1);
    m_value -= value * m_length;
    renormalize();
    return value;
}

std::int32_t IntegerDecoder::decode(std::int32_t predicted, unsigned context)
{
    const unsigned k = getSymbol(m_models.lengths[context]);
    std::int64_t c = 0;
    if (k == 0) {
        c = getBit(m_models.tiny) ? 1 : 0;
    } else if (k < kIntegerBits) {
        std::uint32_t folded = getSymbol(m_models.high[k - 1]);
        if (k > kHighBits) {
            const unsigned low = k - kHighBits;
            folded = (folded << low) | getBits(low);
        }
        c = folded >= (1u << (k - 1)) ? std::int64_t(folded) + 1
                                      : std::int64_t(folded) - ((std::int64_t(1) << k) - 1);
    } else {
        c = INT32_MIN;
    }
    return std::int32_t(std::uint32_t(predicted) + std::uint32_t(c));
}

}  // namespace punctum::las
