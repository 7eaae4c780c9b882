// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <climits>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace punctum::las
{

/// The range coder and integer compressor of LAZ, after A. Said's FastAC as M. Isenburg uses it ("LASzip: lossless
/// compression of LiDAR data", 2013; A. Said, HPL-2004-76).
///
/// RangeEncoder and RangeDecoder have the same members, which take what is to be coded and give what was: so that a
/// predictor is written once, for both. The decoder does not look at what it is given.
///
/// Decoding is built for long chains of dependent steps on wide processors: symbols are found by comparing their
/// ranges sixteen at once instead of by bisection, whose branches cannot be foretold, and bytes are taken without a
/// branch.

constexpr unsigned kSymbolShift = 15;  ///< scale of symbol frequencies
constexpr unsigned kBitShift = 13;     ///< scale of bit probabilities
constexpr unsigned kDirectBits = 19;   ///< most bits coded without a model at once

/// Adaptive frequencies of 2 to `Most` symbols, 15-bit scale.
template <unsigned Most>
class SymbolModel
{
public:
    explicit SymbolModel(unsigned symbols = Most) { reset(symbols); }
    /// All symbols are equally frequent again.
    void reset(unsigned symbols = Most)
    {
        m_symbols = symbols;
        m_last = 0;
        std::fill_n(m_counts.begin(), symbols, std::uint16_t(1));
        m_below.fill(kNever);
        m_coarse.fill(kNever);
        m_total = 0;
        m_cycle = symbols;
        rescale();
        m_untilUpdate = m_cycle = (symbols + 6) / 2;
    }
    unsigned symbols() const noexcept { return m_symbols; }
    /// The symbol that came last: with few symbols in use it mostly comes again.
    unsigned last() const noexcept { return m_last; }
    /// Cumulative frequency below `symbol`.
    std::uint32_t below(unsigned symbol) const noexcept { return std::uint16_t(m_below[symbol]); }
    /// The last symbol whose range begins at or below `target`, which is at most INT16_MAX.
    [[gnu::always_inline]] unsigned find(std::uint32_t target) const noexcept
    {
        unsigned at = 0;
        if constexpr (kBlocks > 1) {
            for (unsigned k = 0; k < kCoarse; k += kLanes) at += notAbove(&m_coarse[k], target);
            at = (std::min(at, kBlocks) - 1) * kLanes;
        }
        at += notAbove(&m_below[at], target) - 1;
        return std::min(at, m_symbols - 1);
    }
    void count(unsigned symbol) noexcept
    {
        m_last = symbol;
        ++m_counts[symbol];
        if (--m_untilUpdate == 0) rescale();
    }

private:
    static constexpr unsigned kLanes = 16;
    static constexpr unsigned kBlocks = (Most + kLanes - 1) / kLanes;
    static constexpr unsigned kCoarse = (kBlocks + kLanes - 1) / kLanes * kLanes;
    static constexpr std::int16_t kNever = INT16_MAX;

    /// How many of sixteen rising values are at or below `target`.
    static unsigned notAbove(const std::int16_t* values, std::uint32_t target) noexcept
    {
#if defined(__SSE2__)
        const __m128i t = _mm_set1_epi16(std::int16_t(target));
        const auto* v = reinterpret_cast<const __m128i*>(values);
        const __m128i above =
            _mm_packs_epi16(_mm_cmpgt_epi16(_mm_load_si128(v), t), _mm_cmpgt_epi16(_mm_load_si128(v + 1), t));
        return unsigned(std::countr_zero(unsigned(_mm_movemask_epi8(above)) | 0x10000u));
#else
        unsigned n = 0;
        for (unsigned k = 0; k < kLanes; ++k) n += unsigned(values[k] <= std::int32_t(target));
        return n;
#endif
    }
    [[gnu::noinline]] void rescale() noexcept
    {
        m_total += m_cycle;
        if (m_total > (1u << kSymbolShift)) {
            m_total = 0;
            for (unsigned k = 0; k < m_symbols; ++k) m_total += m_counts[k] = std::uint16_t((m_counts[k] + 1u) / 2);
        }
        const std::uint32_t scale = 0x80000000u / m_total;
        std::uint32_t sum = 0;
        for (unsigned k = 0; k < m_symbols; ++k) {
            m_below[k] = std::int16_t((scale * sum) >> (31 - kSymbolShift));
            sum += m_counts[k];
        }
        if constexpr (kBlocks > 1)
            for (unsigned k = 0; k < m_symbols; k += kLanes) m_coarse[k / kLanes] = m_below[k];
        m_cycle = std::min(m_cycle * 5 / 4, (m_symbols + 6) * 8);
        m_untilUpdate = m_cycle;
    }

    alignas(16) std::array<std::int16_t, kBlocks * kLanes> m_below;
    alignas(16) std::array<std::int16_t, kCoarse> m_coarse;  ///< every sixteenth of m_below
    std::array<std::uint16_t, Most> m_counts;
    unsigned m_symbols = 0;
    unsigned m_last = 0;
    std::uint32_t m_total = 0;
    std::uint32_t m_cycle = 0;
    std::uint32_t m_untilUpdate = 0;
};

/// Adaptive probability of a bit, 13-bit scale.
class BitModel
{
public:
    void reset() { *this = BitModel(); }
    std::uint32_t zero() const noexcept { return m_zeroProbability; }
    void count(bool bit) noexcept
    {
        if (!bit) ++m_zeroCount;
        if (--m_untilUpdate == 0) rescale();
    }

private:
    void rescale() noexcept;

    std::uint32_t m_zeroCount = 1;
    std::uint32_t m_bitCount = 2;
    std::uint32_t m_zeroProbability = 1u << 12;
    std::uint32_t m_cycle = 4;
    std::uint32_t m_untilUpdate = 4;
};

/// Models of integers of `Bits` bits, coded as differences to a prediction in one of `Contexts`.
template <unsigned Bits, unsigned Contexts>
struct IntegerModels {
    static constexpr unsigned kHighBits = 8;  ///< bits of a difference that are coded with a model

    IntegerModels() { reset(); }
    void reset()
    {
        for (auto& m : lengths) m.reset();
        tiny.reset();
        for (unsigned k = 1; k <= Bits; ++k) high[k - 1].reset(1u << std::min(k, kHighBits));
        length = 0;
    }

    std::array<SymbolModel<Bits + 1>, Contexts> lengths;  ///< bits of the difference, per context
    BitModel tiny;                                        ///< differences 0 and 1
    std::array<SymbolModel<1u << kHighBits>, Bits> high;  ///< top bits of differences of k bits, at [k - 1]
    unsigned length = 0;                                  ///< bits of the difference decoded last
};

constexpr std::uint32_t kMinLength = 1u << 24;  ///< of the interval, between two symbols

/// What an encoder whose interval has this length ends with: one byte and three zeros, or two and two.
constexpr bool longEnd(std::uint32_t length) noexcept
{
    return length > 2 * kMinLength;
}
/// How far above its base.
constexpr std::uint32_t endAbove(std::uint32_t length) noexcept
{
    return longEnd(length) ? kMinLength : kMinLength / 2;
}

/// Takes symbols, bits and integers from compressed bytes. Reading past the end gives zeros; no input is an error
/// at once, see damaged().
class RangeDecoder
{
public:
    /// Bytes that must be readable behind the end.
    static constexpr std::size_t kReadAhead = 8;

    RangeDecoder() = default;
    /// `bytes` must stay, and kReadAhead zeros follow them in memory.
    explicit RangeDecoder(std::span<const std::byte> bytes) noexcept
        : m_at(bytes.data()), m_begin(bytes.data()), m_end(bytes.data() + bytes.size())
    {
        for (int k = 0; k < 4; ++k) {
            m_value = (m_value << 8) | (m_at < m_end ? std::uint32_t(*m_at) : 0);
            ++m_at;
        }
        if (m_at > m_end + 1) m_at = m_end + 1;
        m_impossible = m_value == m_length;
    }
    /// Bytes taken so far; one more than there are when more were asked for.
    std::size_t taken() const noexcept { return std::size_t(m_at - m_begin); }
    /// The bytes hold what no encoder writes.
    bool impossible() const noexcept { return m_impossible; }
    /// They do, as those can tell who know what the symbols mean.
    void fail() noexcept { m_impossible = true; }
    /// That, or more bytes were asked for than there are.
    bool damaged() const noexcept { return m_impossible || m_at > m_end; }

    /// How many zeros an encoder that is at this point ends with (RangeEncoder::finish).
    unsigned zerosAtEnd() const noexcept { return longEnd(m_length) ? 3 : 2; }
    /// Whether such an encoder can have written the zeros that the bytes end with. Where there are more than its
    /// own, those before them must be an end that it writes: a number just so far above its base as to tell its
    /// last interval from others, in one or two bytes.
    bool zerosAsWritten() const noexcept
    {
        const std::byte* last = m_end;
        while (last != m_begin && last[-1] == std::byte(0)) --last;
        return m_end - last <= std::ptrdiff_t(zerosAtEnd()) ||
               endAbove(m_length) - m_value < (longEnd(m_length) ? 1u << 24 : 1u << 16);
    }

    static constexpr bool kEncodes = false;

    template <unsigned Most>
    [[gnu::always_inline]] unsigned symbol(SymbolModel<Most>& model, unsigned = 0) noexcept
    {
        const std::uint32_t step = m_length >> kSymbolShift;
        return take(model, model.find(std::min<std::uint32_t>(m_value / step, INT16_MAX)), step);
    }
    /// The same, faster where the symbol that came last mostly comes again.
    template <unsigned Most>
    [[gnu::always_inline]] unsigned likelySymbol(SymbolModel<Most>& model, unsigned = 0) noexcept
    {
        const std::uint32_t step = m_length >> kSymbolShift;
        const unsigned last = model.last();
        const std::uint32_t x = model.below(last) * step;
        const std::uint32_t y = last + 1 < model.symbols() ? model.below(last + 1) * step : m_length;
        if (m_value - x < y - x) [[likely]]
            return take(model, last, step);
        return take(model, model.find(std::min<std::uint32_t>(m_value / step, INT16_MAX)), step);
    }
    [[gnu::always_inline]] bool bit(BitModel& model) noexcept
    {
        const std::uint32_t x = model.zero() * (m_length >> kBitShift);
        const bool bit = m_value >= x;
        m_value -= bit ? x : 0;
        m_length = bit ? m_length - x : x;
        renormalize();
        model.count(bit);
        return bit;
    }
    /// 1 to 32 bits that all come equally often.
    std::uint32_t bits(unsigned n) noexcept
    {
        if (n > kDirectBits) {
            const std::uint32_t low = bits(16);
            return (bits(n - 16) << 16) | low;
        }
        m_length >>= n;
        const std::uint32_t most = (1u << n) - 1;
        std::uint32_t value = m_value / m_length;
        if (value > most) {
            m_impossible = true;
            value = most;
        }
        m_value -= value * m_length;
        renormalize();
        return value;
    }
    /// 32 bits, the lower half first.
    std::uint32_t word(std::uint32_t = 0) noexcept
    {
        const std::uint32_t low = bits(16);
        return (bits(16) << 16) | low;
    }
    /// An integer near `predicted`. With less than 32 bits only as many of the result mean something.
    template <unsigned Bits, unsigned Contexts>
    std::int32_t integer(IntegerModels<Bits, Contexts>& models, std::int32_t predicted, unsigned context,
                         std::int32_t = 0) noexcept
    {
        constexpr unsigned kHigh = IntegerModels<Bits, Contexts>::kHighBits;
        const unsigned k = models.length = likelySymbol(models.lengths[context]);
        std::uint32_t difference = 0x80000000u;
        if (k == 0) {
            difference = bit(models.tiny) ? 1 : 0;
        } else if (k < 32) {
            std::uint32_t folded = symbol(models.high[k - 1]);
            if (k > kHigh) folded = (folded << (k - kHigh)) | bits(k - kHigh);
            // the upper half of the 2^k values are the positive ones
            difference = folded >= (1u << (k - 1)) ? folded + 1 : folded - ((1u << k) - 1);
        }
        return std::int32_t(std::uint32_t(predicted) + difference);
    }

private:
    template <unsigned Most>
    [[gnu::always_inline]] unsigned take(SymbolModel<Most>& model, unsigned symbol, std::uint32_t step) noexcept
    {
        const std::uint32_t x = model.below(symbol) * step;
        const std::uint32_t y = symbol + 1 < model.symbols() ? model.below(symbol + 1) * step : m_length;
        m_value -= x;
        m_length = y - x;
        renormalize();
        model.count(symbol);
        return symbol;
    }
    /// Takes whole bytes until the length has its upper eight bits again: none, one, two or three.
    [[gnu::always_inline]] void renormalize() noexcept
    {
        const unsigned shift = unsigned(std::countl_zero(m_length)) & 24u;
        std::uint32_t next;
        std::memcpy(&next, m_at, sizeof next);
        const std::uint64_t both = (std::uint64_t(m_value) << 32) | __builtin_bswap32(next);
        m_value = std::uint32_t((both << shift) >> 32);
        m_length <<= shift;
        m_at = std::min(m_at + shift / 8, m_end + 1);
    }

    std::uint32_t m_value = 0;
    std::uint32_t m_length = 0xFFFFFFFFu;
    const std::byte* m_at = nullptr;
    const std::byte* m_begin = nullptr;
    const std::byte* m_end = nullptr;
    bool m_impossible = false;
};

/// Makes compressed bytes of symbols, bits and integers.
class RangeEncoder
{
public:
    static constexpr bool kEncodes = true;

    /// Makes room for `bytes` more; each symbol, bit or word takes at most four, an integer eight.
    void reserve(std::size_t bytes)
    {
        if (m_bytes.size() - m_at < bytes + kWriteAhead) m_bytes.resize(2 * m_bytes.size() + bytes + kWriteAhead);
    }
    template <unsigned Most>
    [[gnu::always_inline]] unsigned symbol(SymbolModel<Most>& model, unsigned symbol) noexcept
    {
        const std::uint32_t step = m_length >> kSymbolShift;
        const std::uint32_t x = model.below(symbol) * step;
        const std::uint32_t y = symbol + 1 < model.symbols() ? model.below(symbol + 1) * step : m_length;
        m_length = y - x;
        add(x);
        model.count(symbol);
        return symbol;
    }
    template <unsigned Most>
    [[gnu::always_inline]] unsigned likelySymbol(SymbolModel<Most>& model, unsigned likely) noexcept
    {
        return symbol(model, likely);
    }
    [[gnu::always_inline]] bool bit(BitModel& model, bool bit) noexcept
    {
        const std::uint32_t x = model.zero() * (m_length >> kBitShift);
        m_length = bit ? m_length - x : x;
        add(bit ? x : 0);
        model.count(bit);
        return bit;
    }
    void bits(unsigned n, std::uint32_t value) noexcept
    {
        if (n > kDirectBits) {
            bits(16, value & 0xFFFFu);
            value >>= 16;
            n -= 16;
        }
        m_length >>= n;
        add(value * m_length);
    }
    std::uint32_t word(std::uint32_t value) noexcept
    {
        bits(16, value & 0xFFFFu);
        bits(16, value >> 16);
        return value;
    }
    template <unsigned Bits, unsigned Contexts>
    std::int32_t integer(IntegerModels<Bits, Contexts>& models, std::int32_t predicted, unsigned context,
                         std::int32_t real) noexcept
    {
        static_assert(Bits == 16 || Bits == 32);
        constexpr unsigned kHigh = IntegerModels<Bits, Contexts>::kHighBits;
        std::int32_t c = std::int32_t(std::uint32_t(real) - std::uint32_t(predicted));  // wraps, as the format does
        if constexpr (Bits == 16) c = std::int16_t(c);
        const unsigned k = unsigned(std::bit_width(c <= 0 ? 0u - std::uint32_t(c) : std::uint32_t(c) - 1));
        models.length = likelySymbol(models.lengths[context], k);
        if (k == 0) {
            bit(models.tiny, c != 0);
        } else if (k < 32) {
            // the upper half of the 2^k values are the positive ones
            const std::uint32_t folded = std::uint32_t(c) + (c < 0 ? (1u << k) - 1 : ~0u);
            if (k <= kHigh) {
                symbol(models.high[k - 1], folded);
            } else {
                symbol(models.high[k - 1], folded >> (k - kHigh));
                bits(k - kHigh, folded & ((1u << (k - kHigh)) - 1));
            }
        }
        return real;
    }
    /// Ends the stream and gives its bytes.
    std::vector<std::byte> finish();

private:
    static constexpr std::size_t kWriteAhead = 8;

    /// Moves the base up, and puts out whole bytes until the length has its upper eight bits again.
    [[gnu::always_inline]] void add(std::uint32_t amount) noexcept
    {
        m_base += amount;
        if (m_base < amount) [[unlikely]]
            carry();
        const unsigned shift = unsigned(std::countl_zero(m_length)) & 24u;
        const std::uint32_t next = __builtin_bswap32(m_base);
        std::memcpy(m_bytes.data() + m_at, &next, sizeof next);
        m_base <<= shift;
        m_length <<= shift;
        m_at += shift / 8;
    }
    void carry() noexcept;

    std::uint32_t m_base = 0;
    std::uint32_t m_length = 0xFFFFFFFFu;
    std::vector<std::byte> m_bytes;
    std::size_t m_at = 0;
};

/// Writes 32-bit integers as differences to a prediction, two contexts: what the chunk table needs.
class IntegerEncoder
{
public:
    void encode(std::int32_t predicted, std::int32_t real, unsigned context)
    {
        m_encoder.reserve(kMostBytes);
        m_encoder.integer(m_models, predicted, context, real);
    }
    std::vector<std::byte> finish() { return m_encoder.finish(); }

private:
    static constexpr std::size_t kMostBytes = 8;

    IntegerModels<32, 2> m_models;
    RangeEncoder m_encoder;
};

/// Reads what IntegerEncoder wrote. Reading past the end gives zeros and sets overrun(); no input is an error.
class IntegerDecoder
{
public:
    explicit IntegerDecoder(std::span<const std::byte> bytes);
    std::int32_t decode(std::int32_t predicted, unsigned context)
    {
        return m_decoder.integer(m_models, predicted, context);
    }
    bool overrun() const noexcept { return m_decoder.taken() > m_size; }

private:
    std::size_t m_size;
    std::vector<std::byte> m_bytes;
    IntegerModels<32, 2> m_models;
    RangeDecoder m_decoder;
};

}  // namespace punctum::las
