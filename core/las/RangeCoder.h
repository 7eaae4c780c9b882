// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace punctum::las
{

/// The range coder and integer compressor of the LAZ chunk table, after A. Said's FastAC as M. Isenburg uses it
/// ("LASzip: lossless compression of LiDAR data", 2013). Only what the table needs: 32-bit integers, two contexts.

/// Adaptive frequencies of up to 256 symbols, 15-bit scale.
class SymbolModel
{
public:
    explicit SymbolModel(unsigned symbols);

    unsigned symbols() const { return unsigned(m_counts.size()); }
    /// Cumulative frequency below `symbol`.
    std::uint32_t below(unsigned symbol) const { return m_below[symbol]; }
    void count(unsigned symbol);

private:
    void rescale();
    std::vector<std::uint32_t> m_counts;
    std::vector<std::uint32_t> m_below;
    std::uint32_t m_total = 0;
    std::uint32_t m_cycle = 0;
    std::uint32_t m_untilUpdate = 0;
};

/// Adaptive probability of a bit, 13-bit scale.
class BitModel
{
public:
    std::uint32_t zero() const { return m_zeroProbability; }
    void count(bool bit);

private:
    std::uint32_t m_zeroCount = 1;
    std::uint32_t m_bitCount = 2;
    std::uint32_t m_zeroProbability = 1u << 12;
    std::uint32_t m_cycle = 4;
    std::uint32_t m_untilUpdate = 4;
};

/// Models shared by writing and reading of integers.
struct IntegerModels {
    IntegerModels();
    std::array<SymbolModel, 2> lengths;  ///< bits of the difference, per context
    BitModel tiny;                       ///< differences 0 and 1
    std::vector<SymbolModel> high;       ///< top bits of differences of k bits, at [k - 1]
};

/// Writes 32-bit integers as differences to a prediction.
class IntegerEncoder
{
public:
    void encode(std::int32_t predicted, std::int32_t real, unsigned context);
    /// Ends the stream and gives its bytes.
    std::vector<std::byte> finish();

private:
    void putSymbol(SymbolModel& model, unsigned symbol);
    void putBit(BitModel& model, bool bit);
    void putBits(unsigned bits, std::uint32_t value);
    void add(std::uint32_t amount);
    void renormalize();

    IntegerModels m_models;
    std::uint32_t m_base = 0;
    std::uint32_t m_length = 0xFFFFFFFFu;
    std::vector<std::byte> m_bytes;
};

/// Reads what IntegerEncoder wrote. Reading past the end gives zeros and sets overrun(); no input is an error.
class IntegerDecoder
{
public:
    explicit IntegerDecoder(std::span<const std::byte> bytes);
    std::int32_t decode(std::int32_t predicted, unsigned context);
    bool overrun() const noexcept { return m_overrun; }

private:
    unsigned getSymbol(SymbolModel& model);
    bool getBit(BitModel& model);
    std::uint32_t getBits(unsigned bits);
    void renormalize();
    std::uint32_t nextByte();

    IntegerModels m_models;
    std::span<const std::byte> m_bytes;
    std::size_t m_at = 0;
    std::uint32_t m_value = 0;
    std::uint32_t m_length = 0xFFFFFFFFu;
    bool m_overrun = false;
};

}  // namespace punctum::las
