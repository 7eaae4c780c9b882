// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/RangeCoder.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>

namespace punctum::las
{

/// The predictors of LAZ that pointwise and layered chunks share, after M. Isenburg, "LASzip: lossless compression
/// of LiDAR data", Photogrammetric Engineering & Remote Sensing 79(2), 2013. All begin a chunk with reset().

/// Median of the last values, kept sorted; of which end the oldest one is taken out depends on what came in.
class RunningMedian
{
public:
    std::int32_t get() const { return m_values[2]; }
    void add(std::int32_t v)
    {
        auto& s = m_values;
        if (m_dropHighest) {
            if (v < s[2]) {
                s[4] = s[3];
                s[3] = s[2];
                const bool below0 = v < s[0], below1 = v < s[1];
                s[2] = below1 ? s[1] : v;
                s[1] = below0 ? s[0] : below1 ? v : s[1];
                s[0] = below0 ? v : s[0];
            } else {
                const bool below3 = v < s[3];
                s[4] = below3 ? s[3] : v;
                s[3] = below3 ? v : s[3];
                m_dropHighest = false;
            }
        } else if (s[2] < v) {
            s[0] = s[1];
            s[1] = s[2];
            const bool above4 = s[4] < v, above3 = s[3] < v;
            s[2] = above3 ? s[3] : v;
            s[3] = above4 ? s[4] : above3 ? v : s[3];
            s[4] = above4 ? v : s[4];
        } else {
            const bool above1 = s[1] < v;
            s[0] = above1 ? s[1] : v;
            s[1] = above1 ? v : s[1];
            m_dropHighest = true;
        }
    }

private:
    std::array<std::int32_t, 5> m_values{};
    bool m_dropHighest = true;
};

/// Models of one thing in many contexts, of which few come; made when first needed.
template <unsigned Symbols, unsigned Contexts>
class SparseModels
{
public:
    SymbolModel<Symbols>& operator[](unsigned context)
    {
        auto& model = m_models[context];
        if (!model) model = std::make_unique<SymbolModel<Symbols>>();
        return *model;
    }
    void reset()
    {
        for (auto& m : m_models)
            if (m) m->reset();
    }

private:
    std::array<std::unique_ptr<SymbolModel<Symbols>>, Contexts> m_models;
};

/// A context without its lowest bit: neighboring lengths are much the same.
constexpr unsigned evenUpTo(unsigned k, unsigned most)
{
    return k < most ? k & ~1u : most;
}

/// GPS time: the difference of its bits to the last time of one of four interleaved sequences, as a multiple of the
/// difference before. `SaysSame`: a time that did not change has a symbol (pointwise chunks); without, somebody
/// else knows.
template <bool SaysSame>
class TimePredictor
{
public:
    void reset(std::uint64_t time)
    {
        m_times = {time};
        m_differences = {};
        m_extremes = {};
        m_at = m_newest = 0;
        m_multiples.reset();
        m_fromZero.reset();
        m_integers.reset();
    }
    std::uint64_t decode(RangeDecoder& in)
    {
        // One change of the sequence is all that an encoder ever needs.
        int changes = 0;
        while (step(in))
            if (++changes == kSequences) {
                in.fail();
                break;
            }
        return m_times[m_at];
    }

private:
    static constexpr int kSequences = 4;
    static constexpr unsigned kSameSymbols = SaysSame ? 1 : 0;
    static constexpr unsigned kMost = 500;                                 ///< multiples with a symbol: 0 to 500,
    static constexpr unsigned kLeast = 10;                                 ///< then -1 to -10,
    static constexpr unsigned kSame = kMost + kLeast + 1;                  ///< then no change, if that is said,
    static constexpr unsigned kWhole = kMost + kLeast + 1 + kSameSymbols;  ///< a whole time begins a sequence,
    static constexpr unsigned kSymbols = kWhole + 4;                       ///< another sequence

    void wholeTime(RangeDecoder& in)
    {
        m_newest = (m_newest + 1) & 3;
        const std::uint32_t high = std::uint32_t(in.integer(m_integers, std::int32_t(m_times[m_at] >> 32), 8));
        m_times[m_newest] = (std::uint64_t(high) << 32) | in.word();
        m_at = m_newest;
        m_differences[m_at] = 0;
        m_extremes[m_at] = 0;
    }
    void add(std::int32_t difference) { m_times[m_at] += std::uint64_t(std::int64_t(difference)); }
    /// After four far outliers in a row the difference that is multiplied is a new one.
    void extreme(std::int32_t difference)
    {
        if (++m_extremes[m_at] > 3) {
            m_differences[m_at] = difference;
            m_extremes[m_at] = 0;
        }
    }
    /// True when another sequence was chosen, whose time follows.
    bool step(RangeDecoder& in)
    {
        std::int32_t& last = m_differences[m_at];
        if (last == 0) {
            const unsigned kind = in.likelySymbol(m_fromZero);
            if (kind == kSameSymbols) {
                last = in.integer(m_integers, 0, 0);
                add(last);
                m_extremes[m_at] = 0;
            } else if (kind == kSameSymbols + 1) {
                wholeTime(in);
            } else if (kind > kSameSymbols + 1) {
                m_at = (m_at + kind - kSameSymbols - 1) & 3;
                return true;
            }
            return false;
        }
        const unsigned kind = in.likelySymbol(m_multiples);
        const auto times = [&](std::int32_t n) { return std::int32_t(std::uint32_t(n) * std::uint32_t(last)); };
        if (kind == 1) {
            add(in.integer(m_integers, last, 1));
            m_extremes[m_at] = 0;
        } else if (kind == 0) {
            const std::int32_t difference = in.integer(m_integers, 0, 7);
            add(difference);
            extreme(difference);
        } else if (kind < kMost) {
            add(in.integer(m_integers, times(std::int32_t(kind)), kind < 10 ? 2 : 3));
        } else if (kind == kMost) {
            const std::int32_t difference = in.integer(m_integers, times(kMost), 4);
            add(difference);
            extreme(difference);
        } else if (kind < kMost + kLeast) {
            add(in.integer(m_integers, times(std::int32_t(kMost) - std::int32_t(kind)), 5));
        } else if (kind == kMost + kLeast) {
            const std::int32_t difference = in.integer(m_integers, times(-std::int32_t(kLeast)), 6);
            add(difference);
            extreme(difference);
        } else if (kind == kWhole) {
            wholeTime(in);
        } else if (!SaysSame || kind != kSame) {
            m_at = (m_at + kind - kWhole) & 3;
            return true;
        }
        return false;
    }

    std::array<std::uint64_t, kSequences> m_times{};
    std::array<std::int32_t, kSequences> m_differences{};
    std::array<std::int32_t, kSequences> m_extremes{};
    unsigned m_at = 0, m_newest = 0;
    SymbolModel<kSymbols> m_multiples;
    SymbolModel<5 + kSameSymbols> m_fromZero;
    IntegerModels<32, 9> m_integers;
};

/// Red, green and blue, byte by byte, the lower one first; green and blue are predicted from how red changed.
class ColorPredictor
{
public:
    using Color = std::array<std::uint8_t, 6>;

    void reset()
    {
        m_changed.reset();
        for (auto& m : m_differences) m.reset();
    }
    /// From the color before to the next one.
    void decode(RangeDecoder& in, Color& color)
    {
        // the bits of `changed` are in the order of the bytes, then "not grey"
        const unsigned changed = in.likelySymbol(m_changed);
        const Color before = color;
        for (unsigned k = 0; k < 2; ++k)
            if ((changed >> k & 1) != 0) color[k] = std::uint8_t(before[k] + in.symbol(m_differences[k]));
        if ((changed & 64) != 0) {
            for (unsigned k = 0; k < 2; ++k) {
                const int red = int(color[k]) - before[k];
                if ((changed >> (k + 2) & 1) != 0) color[k + 2] = guess(in, k + 2, before[k + 2] + red);
                const int green = int(color[k + 2]) - before[k + 2];
                if ((changed >> (k + 4) & 1) != 0)
                    color[k + 4] = guess(in, k + 4, before[k + 4] + (red + green) / 2);
            }
        } else {
            color[2] = color[4] = color[0];
            color[3] = color[5] = color[1];
        }
    }

private:
    std::uint8_t guess(RangeDecoder& in, unsigned byte, int predicted)
    {
        return std::uint8_t(unsigned(std::clamp(predicted, 0, 255)) + in.symbol(m_differences[byte]));
    }

    SymbolModel<128> m_changed;
    std::array<SymbolModel<256>, 6> m_differences;
};

/// Waveform packet of a point (LAS 1.4 R15, table 13 on).
struct WavePacket {
    static constexpr std::size_t kBytes = 29;

    std::byte descriptor{};
    std::uint64_t offset = 0;
    std::array<std::uint32_t, 5> words{};  ///< size, return location, the three direction parameters

    void load(const std::byte* record)
    {
        descriptor = record[0];
        std::memcpy(&offset, record + 1, 8);
        std::memcpy(words.data(), record + 9, 20);
    }
    void store(std::byte* record) const
    {
        record[0] = descriptor;
        std::memcpy(record + 1, &offset, 8);
        std::memcpy(record + 9, words.data(), 20);
    }
};

/// Waveform packets, one of which often lies right behind the one before.
class WavePredictor
{
public:
    void reset()
    {
        m_lastStep = 0;
        m_lastKind = 0;
        m_descriptors.reset();
        for (auto& m : m_kinds) m.reset();
        m_steps.reset();
        m_sizes.reset();
        m_locations.reset();
        m_directions.reset();
    }
    /// From the packet before to the next one.
    void decode(RangeDecoder& in, WavePacket& packet)
    {
        packet.descriptor = std::byte(in.likelySymbol(m_descriptors));
        m_lastKind = in.symbol(m_kinds[m_lastKind]);
        if (m_lastKind == 1) {
            packet.offset += packet.words[0];
        } else if (m_lastKind == 2) {
            m_lastStep = in.integer(m_steps, m_lastStep, 0);
            packet.offset += std::uint64_t(std::int64_t(m_lastStep));
        } else if (m_lastKind == 3) {
            const std::uint64_t low = in.word();
            packet.offset = (std::uint64_t(in.word()) << 32) | low;
        }
        const auto next = [&](auto& models, std::uint32_t& word, unsigned context) {
            word = std::uint32_t(in.integer(models, std::int32_t(word), context));
        };
        next(m_sizes, packet.words[0], 0);
        next(m_locations, packet.words[1], 0);
        for (unsigned k = 0; k < 3; ++k) next(m_directions, packet.words[2 + k], k);
    }

private:
    std::int32_t m_lastStep = 0;
    unsigned m_lastKind = 0;
    SymbolModel<256> m_descriptors;
    std::array<SymbolModel<4>, 4> m_kinds;  ///< same, next, near or any offset, by the kind before
    IntegerModels<32, 1> m_steps, m_sizes, m_locations;
    IntegerModels<32, 3> m_directions;
};

}  // namespace punctum::las
