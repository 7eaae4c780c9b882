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
/// of LiDAR data", Photogrammetric Engineering & Remote Sensing 79(2), 2013. All begin a chunk with reset(). code()
/// takes the value that is to be encoded, or anything (see RangeEncoder, RangeDecoder), and gives the one that is
/// coded.

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
    template <typename Coder>
    std::uint64_t code(Coder& coder, std::uint64_t time)
    {
        // One change of the sequence is all that an encoder ever needs.
        int changes = 0;
        while (step(coder, time))
            if (++changes == kSequences) {
                if constexpr (!Coder::kEncodes) coder.fail();
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

    template <typename Coder>
    void wholeTime(Coder& coder, std::uint64_t time)
    {
        m_newest = (m_newest + 1) & 3;
        const std::int32_t high =
            coder.integer(m_integers, std::int32_t(m_times[m_at] >> 32), 8, std::int32_t(time >> 32));
        m_times[m_newest] = (std::uint64_t(std::uint32_t(high)) << 32) | coder.word(std::uint32_t(time));
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
    /// Whether the time is so near to the last one of the sequence that their difference has 32 bits.
    bool isNear(std::uint64_t time, unsigned sequence) const
    {
        const auto difference = std::int64_t(time - m_times[sequence]);
        return difference == std::int32_t(difference);
    }
    /// 0, where a whole time is needed, or how many sequences further on the time belongs.
    unsigned sequencesOn(std::uint64_t time) const
    {
        for (unsigned k = 1; k < kSequences; ++k)
            if (isNear(time, (m_at + k) & 3)) return k;
        return 0;
    }
    /// What an encoder chooses where the difference before was zero.
    unsigned chooseFromZero(std::uint64_t time) const
    {
        if (SaysSame && time == m_times[m_at]) return 0;
        return isNear(time, m_at) ? kSameSymbols : kSameSymbols + 1 + sequencesOn(time);
    }
    /// And elsewhere.
    unsigned chooseMultiple(std::uint64_t time) const
    {
        if (SaysSame && time == m_times[m_at]) return kSame;
        if (!isNear(time, m_at)) return kWhole + sequencesOn(time);
        // in floats, and rounded, as LASzip does it
        const float ratio = float(std::int32_t(time - m_times[m_at])) / float(m_differences[m_at]);
        const float rounded = ratio + (ratio >= 0 ? 0.5f : -0.5f);
        if (!(rounded < 0x1p31f)) return kMost + kLeast;  // no int32: the processor makes it the lowest one
        const auto multiple = std::int32_t(rounded);
        if (multiple >= 0) return std::min(unsigned(multiple), kMost);
        return kMost + std::min(0u - unsigned(multiple), kLeast);
    }
    /// True when another sequence was chosen, whose time follows.
    template <typename Coder>
    bool step(Coder& coder, std::uint64_t time)
    {
        std::int32_t& last = m_differences[m_at];
        const auto real = std::int32_t(time - m_times[m_at]);
        if (last == 0) {
            const unsigned kind = coder.likelySymbol(m_fromZero, Coder::kEncodes ? chooseFromZero(time) : 0);
            if (kind == kSameSymbols) {
                last = coder.integer(m_integers, 0, 0, real);
                add(last);
                m_extremes[m_at] = 0;
            } else if (kind == kSameSymbols + 1) {
                wholeTime(coder, time);
            } else if (kind > kSameSymbols + 1) {
                m_at = (m_at + kind - kSameSymbols - 1) & 3;
                return true;
            }
            return false;
        }
        const unsigned kind = coder.likelySymbol(m_multiples, Coder::kEncodes ? chooseMultiple(time) : 0);
        const auto times = [&](std::int32_t n) { return std::int32_t(std::uint32_t(n) * std::uint32_t(last)); };
        if (kind == 1) {
            add(coder.integer(m_integers, last, 1, real));
            m_extremes[m_at] = 0;
        } else if (kind == 0) {
            const std::int32_t difference = coder.integer(m_integers, 0, 7, real);
            add(difference);
            extreme(difference);
        } else if (kind < kMost) {
            add(coder.integer(m_integers, times(std::int32_t(kind)), kind < 10 ? 2 : 3, real));
        } else if (kind == kMost) {
            const std::int32_t difference = coder.integer(m_integers, times(kMost), 4, real);
            add(difference);
            extreme(difference);
        } else if (kind < kMost + kLeast) {
            add(coder.integer(m_integers, times(std::int32_t(kMost) - std::int32_t(kind)), 5, real));
        } else if (kind == kMost + kLeast) {
            const std::int32_t difference = coder.integer(m_integers, times(-std::int32_t(kLeast)), 6, real);
            add(difference);
            extreme(difference);
        } else if (kind == kWhole) {
            wholeTime(coder, time);
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
    template <typename Coder>
    Color code(Coder& coder, const Color& before, const Color& real)
    {
        // the bits of `changed` are in the order of the bytes, then "not gray"
        const unsigned changed = coder.likelySymbol(m_changed, Coder::kEncodes ? changes(before, real) : 0);
        Color color = before;
        const auto next = [&](unsigned byte, int predicted) {
            if ((changed >> byte & 1) == 0) return;
            const auto guess = std::uint8_t(std::clamp(predicted, 0, 255));
            color[byte] = std::uint8_t(guess + coder.symbol(m_differences[byte], std::uint8_t(real[byte] - guess)));
        };
        for (unsigned k = 0; k < 2; ++k) next(k, before[k]);
        if ((changed & 64) != 0) {
            for (unsigned k = 0; k < 2; ++k) {
                const int red = int(color[k]) - before[k];
                next(k + 2, before[k + 2] + red);
                const int green = int(color[k + 2]) - before[k + 2];
                next(k + 4, before[k + 4] + (red + green) / 2);
            }
        } else {
            color[2] = color[4] = color[0];
            color[3] = color[5] = color[1];
        }
        return color;
    }

private:
    static unsigned changes(const Color& before, const Color& real)
    {
        unsigned changed = 0;
        for (unsigned k = 0; k < 6; ++k) changed |= unsigned(real[k] != before[k]) << k;
        const bool gray = real[2] == real[0] && real[4] == real[0] && real[3] == real[1] && real[5] == real[1];
        return changed | unsigned(!gray) << 6;
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
    template <typename Coder>
    WavePacket code(Coder& coder, const WavePacket& before, const WavePacket& real)
    {
        WavePacket packet = before;
        packet.descriptor = std::byte(coder.likelySymbol(m_descriptors, unsigned(real.descriptor)));
        m_lastKind = coder.symbol(m_kinds[m_lastKind], Coder::kEncodes ? kindOf(before, real) : 0);
        if (m_lastKind == 1) {
            packet.offset += before.words[0];
        } else if (m_lastKind == 2) {
            m_lastStep = coder.integer(m_steps, m_lastStep, 0, std::int32_t(real.offset - before.offset));
            packet.offset += std::uint64_t(std::int64_t(m_lastStep));
        } else if (m_lastKind == 3) {
            const std::uint64_t low = coder.word(std::uint32_t(real.offset));
            packet.offset = (std::uint64_t(coder.word(std::uint32_t(real.offset >> 32))) << 32) | low;
        }
        const auto next = [&](auto& models, unsigned word, unsigned context) {
            packet.words[word] = std::uint32_t(
                coder.integer(models, std::int32_t(before.words[word]), context, std::int32_t(real.words[word])));
        };
        next(m_sizes, 0, 0);
        next(m_locations, 1, 0);
        for (unsigned k = 0; k < 3; ++k) next(m_directions, 2 + k, k);
        return packet;
    }

private:
    /// The same place, right behind, near, or anywhere.
    static unsigned kindOf(const WavePacket& before, const WavePacket& real)
    {
        const auto step = std::int64_t(real.offset - before.offset);
        if (step != std::int32_t(step)) return 3;
        if (step == 0) return 0;
        return std::int32_t(step) == std::int32_t(before.words[0]) ? 1 : 2;
    }

    std::int32_t m_lastStep = 0;
    unsigned m_lastKind = 0;
    SymbolModel<256> m_descriptors;
    std::array<SymbolModel<4>, 4> m_kinds;  ///< see kindOf; by the kind before
    IntegerModels<32, 1> m_steps, m_sizes, m_locations;
    IntegerModels<32, 3> m_directions;
};

}  // namespace punctum::las
