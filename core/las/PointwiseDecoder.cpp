// SPDX-License-Identifier: MIT
// The predictors of M. Isenburg, "LASzip: lossless compression of LiDAR data", Photogrammetric Engineering & Remote
// Sensing 79(2), 2013, as the items of version 2 have them.
#include "core/las/PointwiseDecoder.h"

#include "core/las/RangeCoder.h"

#include <array>
#include <cstring>
#include <vector>

namespace punctum::las
{

namespace
{

constexpr std::size_t kPointBytes = 20, kTimeBytes = 8, kColorBytes = 6, kWaveBytes = 29;

/// Contexts by number of returns (row) and return number: all pairs that can be have one, the impossible ones
/// share.
constexpr std::uint8_t kReturnContext[8][8] = {
    {15, 14, 13, 12, 11, 10, 9, 8},  {14, 0, 1, 3, 6, 10, 10, 9},    {13, 1, 2, 4, 7, 11, 11, 10},
    {12, 3, 4, 5, 8, 12, 12, 11},    {11, 6, 7, 8, 9, 13, 13, 12},   {10, 10, 11, 12, 13, 14, 14, 13},
    {9, 10, 11, 12, 13, 14, 15, 14}, {8, 9, 10, 11, 12, 13, 14, 15},
};
/// How many returns below the last one, by number of returns and return number.
constexpr unsigned returnLevel(unsigned returns, unsigned number)
{
    return returns > number ? returns - number : number - returns;
}

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

/// Models of bytes that depend on the byte before; made when first needed.
class ByteModels
{
public:
    SymbolModel<256>& operator[](std::uint8_t before)
    {
        auto& model = m_models[before];
        if (!model) model = std::make_unique<SymbolModel<256>>();
        return *model;
    }
    void reset()
    {
        for (auto& m : m_models)
            if (m) m->reset();
    }

private:
    std::array<std::unique_ptr<SymbolModel<256>>, 256> m_models;
};

/// A context without its lowest bit: neighboring lengths are much the same.
constexpr unsigned evenUpTo(unsigned k, unsigned most)
{
    return k < most ? k & ~1u : most;
}

/// The 20 bytes of format 0.
class PointItem
{
public:
    void start(const std::byte* record)
    {
        std::memcpy(m_axes.data(), record, 12);
        m_intensity = 0;  // so version 2 has it
        m_returns = std::uint8_t(record[14]);
        m_class = std::uint8_t(record[15]);
        m_angle = std::uint8_t(record[16]);
        m_user = std::uint8_t(record[17]);
        std::memcpy(&m_source, record + 18, 2);
        m_changed.reset();
        m_intensities.reset();
        for (auto& m : m_angles) m.reset();
        m_sources.reset();
        m_returnModels.reset();
        m_classModels.reset();
        m_userModels.reset();
        m_dx.reset();
        m_dy.reset();
        m_z.reset();
        m_medians = {};
        m_lastIntensity = {};
        m_lastHeight = {};
    }
    void decode(RangeDecoder& in, std::byte* record)
    {
        const unsigned changed = in.likelySymbol(m_changed);
        if ((changed & 32) != 0) m_returns = std::uint8_t(in.likelySymbol(m_returnModels[m_returns]));
        const unsigned number = m_returns & 7, returns = (m_returns >> 3) & 7;
        const unsigned context = kReturnContext[returns][number], level = returnLevel(returns, number);
        if (changed != 0) {
            std::uint16_t& last = m_lastIntensity[context];
            if ((changed & 16) != 0) last = std::uint16_t(in.integer(m_intensities, last, std::min(context, 3u)));
            m_intensity = last;
            if ((changed & 8) != 0) m_class = std::uint8_t(in.symbol(m_classModels[m_class]));
            if ((changed & 4) != 0) m_angle = std::uint8_t(m_angle + in.symbol(m_angles[(m_returns >> 6) & 1]));
            if ((changed & 2) != 0) m_user = std::uint8_t(in.symbol(m_userModels[m_user]));
            if ((changed & 1) != 0) m_source = std::uint16_t(in.integer(m_sources, m_source, 0));
        }
        const unsigned single = returns == 1 ? 1 : 0;
        auto& [medianX, medianY] = m_medians[context];
        const std::int32_t dx = in.integer(m_dx, medianX.get(), single);
        medianX.add(dx);
        const std::int32_t dy = in.integer(m_dy, medianY.get(), single + evenUpTo(m_dx.length, 20));
        medianY.add(dy);
        m_axes[0] += std::uint32_t(dx);
        m_axes[1] += std::uint32_t(dy);
        std::int32_t& height = m_lastHeight[level];
        height = in.integer(m_z, height, single + evenUpTo((m_dx.length + m_dy.length) / 2, 18));
        m_axes[2] = std::uint32_t(height);

        std::memcpy(record, m_axes.data(), 12);
        std::memcpy(record + 12, &m_intensity, 2);
        record[14] = std::byte(m_returns);
        record[15] = std::byte(m_class);
        record[16] = std::byte(m_angle);
        record[17] = std::byte(m_user);
        std::memcpy(record + 18, &m_source, 2);
    }

private:
    std::array<std::uint32_t, 3> m_axes{};
    std::uint16_t m_intensity = 0, m_source = 0;
    std::uint8_t m_returns = 0, m_class = 0, m_angle = 0, m_user = 0;
    SymbolModel<64> m_changed;
    IntegerModels<16, 4> m_intensities;
    std::array<SymbolModel<256>, 2> m_angles;
    IntegerModels<16, 1> m_sources;
    ByteModels m_returnModels, m_classModels, m_userModels;
    IntegerModels<32, 2> m_dx;
    IntegerModels<32, 22> m_dy;
    IntegerModels<32, 20> m_z;
    std::array<std::array<RunningMedian, 2>, 16> m_medians;
    std::array<std::uint16_t, 16> m_lastIntensity{};
    std::array<std::int32_t, 8> m_lastHeight{};
};

/// GPS time: the difference of its bits to the last time of one of four interleaved sequences, as a multiple of the
/// difference before.
class TimeItem
{
public:
    void start(const std::byte* record)
    {
        m_times = {};
        std::memcpy(&m_times[0], record, kTimeBytes);
        m_differences = {};
        m_extremes = {};
        m_at = m_newest = 0;
        m_multiples.reset();
        m_fromZero.reset();
        m_integers.reset();
    }
    void decode(RangeDecoder& in, std::byte* record)
    {
        for (int switches = 0; switches < kSequences; ++switches)
            if (!step(in)) break;
        std::memcpy(record, &m_times[m_at], kTimeBytes);
    }

private:
    static constexpr int kSequences = 4;
    static constexpr unsigned kMost = 500;                    ///< multiples that have a symbol: 0 to 500,
    static constexpr unsigned kLeast = 10;                    ///< then -1 to -10
    static constexpr unsigned kSame = kMost + kLeast + 1;     ///< the time did not change
    static constexpr unsigned kWhole = kMost + kLeast + 2;    ///< a time of its own begins a sequence
    static constexpr unsigned kSymbols = kMost + kLeast + 6;  ///< the last three: another sequence

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
            if (kind == 1) {
                last = in.integer(m_integers, 0, 0);
                add(last);
                m_extremes[m_at] = 0;
            } else if (kind == 2) {
                wholeTime(in);
            } else if (kind > 2) {
                m_at = (m_at + kind - 2) & 3;
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
        } else if (kind != kSame) {
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
    SymbolModel<6> m_fromZero;
    IntegerModels<32, 9> m_integers;
};

/// Red, green and blue, byte by byte; green and blue are predicted from how red changed.
class ColorItem
{
public:
    void start(const std::byte* record)
    {
        for (std::size_t k = 0; k < kColorBytes; ++k) m_bytes[k] = std::uint8_t(record[k]);
        m_changed.reset();
        for (auto& m : m_differences) m.reset();
    }
    void decode(RangeDecoder& in, std::byte* record)
    {
        // bytes: red low, red high, green low, ...; the bits of `changed` are in the same order, then "not grey"
        const unsigned changed = in.likelySymbol(m_changed);
        const std::array<std::uint8_t, kColorBytes> before = m_bytes;
        for (unsigned k = 0; k < 2; ++k)
            if ((changed >> k & 1) != 0) m_bytes[k] = std::uint8_t(before[k] + in.symbol(m_differences[k]));
        if ((changed & 64) != 0) {
            for (unsigned k = 0; k < 2; ++k) {
                const int red = int(m_bytes[k]) - before[k];
                if ((changed >> (k + 2) & 1) != 0) m_bytes[k + 2] = guess(in, k + 2, before[k + 2] + red);
                const int green = int(m_bytes[k + 2]) - before[k + 2];
                if ((changed >> (k + 4) & 1) != 0)
                    m_bytes[k + 4] = guess(in, k + 4, before[k + 4] + (red + green) / 2);
            }
        } else {
            m_bytes[2] = m_bytes[4] = m_bytes[0];
            m_bytes[3] = m_bytes[5] = m_bytes[1];
        }
        std::memcpy(record, m_bytes.data(), kColorBytes);
    }

private:
    std::uint8_t guess(RangeDecoder& in, unsigned byte, int predicted)
    {
        return std::uint8_t(unsigned(std::clamp(predicted, 0, 255)) + in.symbol(m_differences[byte]));
    }

    std::array<std::uint8_t, kColorBytes> m_bytes{};
    SymbolModel<128> m_changed;
    std::array<SymbolModel<256>, kColorBytes> m_differences;
};

/// Waveform packets: descriptor index, then offset, size, return location and the three direction parameters.
class WaveItem
{
public:
    void start(const std::byte* record)
    {
        std::memcpy(&m_offset, record + 1, 8);
        std::memcpy(m_words.data(), record + 9, 20);
        m_lastStep = 0;
        m_lastKind = 0;
        m_index.reset();
        for (auto& m : m_kinds) m.reset();
        m_steps.reset();
        m_sizes.reset();
        m_locations.reset();
        m_directions.reset();
    }
    void decode(RangeDecoder& in, std::byte* record)
    {
        record[0] = std::byte(in.likelySymbol(m_index));
        m_lastKind = in.symbol(m_kinds[m_lastKind]);
        if (m_lastKind == 1) {
            m_offset += m_words[0];  // right behind the packet before
        } else if (m_lastKind == 2) {
            m_lastStep = in.integer(m_steps, m_lastStep, 0);
            m_offset += std::uint64_t(std::int64_t(m_lastStep));
        } else if (m_lastKind == 3) {
            const std::uint64_t low = in.word();
            m_offset = (std::uint64_t(in.word()) << 32) | low;
        }
        const auto next = [&](auto& models, std::uint32_t& word, unsigned context) {
            word = std::uint32_t(in.integer(models, std::int32_t(word), context));
        };
        next(m_sizes, m_words[0], 0);
        next(m_locations, m_words[1], 0);
        for (unsigned k = 0; k < 3; ++k) next(m_directions, m_words[2 + k], k);
        std::memcpy(record + 1, &m_offset, 8);
        std::memcpy(record + 9, m_words.data(), 20);
    }

private:
    std::uint64_t m_offset = 0;
    std::array<std::uint32_t, 5> m_words{};
    std::int32_t m_lastStep = 0;
    unsigned m_lastKind = 0;
    SymbolModel<256> m_index;
    std::array<SymbolModel<4>, 4> m_kinds;  ///< same, next, near or any offset, by the kind before
    IntegerModels<32, 1> m_steps, m_sizes, m_locations;
    IntegerModels<32, 3> m_directions;
};

/// Extra bytes, each as the difference to the same byte of the point before.
class ByteItem
{
public:
    void start(const std::byte* record, std::size_t count)
    {
        m_bytes.resize(count);
        m_differences.resize(count);
        std::memcpy(m_bytes.data(), record, count);
        for (auto& m : m_differences) m.reset();
    }
    void decode(RangeDecoder& in, std::byte* record)
    {
        for (std::size_t k = 0; k < m_bytes.size(); ++k)
            m_bytes[k] = std::uint8_t(m_bytes[k] + in.symbol(m_differences[k]));
        std::memcpy(record, m_bytes.data(), m_bytes.size());
    }

private:
    std::vector<std::uint8_t> m_bytes;
    std::vector<SymbolModel<256>> m_differences;
};

}  // namespace

struct PointwiseDecoder::Impl {
    std::size_t length = 0;
    bool hasTime = false, hasColor = false, hasWave = false;
    std::size_t extraBytes = 0;
    std::vector<std::byte> bytes;  ///< the chunk, and what the range decoder reads ahead
    std::size_t size = 0;
    bool first = true;
    RangeDecoder in;
    PointItem point;
    TimeItem time;
    ColorItem color;
    WaveItem wave;
    ByteItem extra;

    void begin()
    {
        const std::byte* record = bytes.data();
        point.start(record);
        record += kPointBytes;
        if (hasTime) time.start(record);
        if (hasTime) record += kTimeBytes;
        if (hasColor) color.start(record);
        if (hasColor) record += kColorBytes;
        if (hasWave) wave.start(record);
        if (hasWave) record += kWaveBytes;
        if (extraBytes != 0) extra.start(record, extraBytes);
        in = RangeDecoder(std::span(bytes).subspan(length, size - length));
    }
    void next(std::byte* record)
    {
        point.decode(in, record);
        record += kPointBytes;
        if (hasTime) time.decode(in, record);
        if (hasTime) record += kTimeBytes;
        if (hasColor) color.decode(in, record);
        if (hasColor) record += kColorBytes;
        if (hasWave) wave.decode(in, record);
        if (hasWave) record += kWaveBytes;
        if (extraBytes != 0) extra.decode(in, record);
    }
};

bool PointwiseDecoder::supports(const LazInfo& info)
{
    if (info.compressor == LazInfo::Layered) return false;
    return std::all_of(info.items.begin(), info.items.end(), [](const LazInfo::Item& item) {
        return item.version == (item.size == kWaveBytes && item.type == 9 ? 1 : 2);
    });
}

PointwiseDecoder::PointwiseDecoder(const LazInfo& info) : m_impl(std::make_unique<Impl>())
{
    Impl& impl = *m_impl;
    impl.length = info.recordLength;
    impl.hasTime = hasGpsTime(info.format);
    impl.hasColor = hasColor(info.format);
    impl.hasWave = hasWaveform(info.format);
    impl.extraBytes = info.recordLength - standardRecordLength(info.format);
}

PointwiseDecoder::~PointwiseDecoder() = default;

std::string PointwiseDecoder::start(std::span<const std::byte> chunk)
{
    Impl& impl = *m_impl;
    impl.size = 0;
    impl.in = RangeDecoder();
    if (chunk.size() < impl.length) return "it is too short for a point";
    impl.bytes.resize(chunk.size() + RangeDecoder::kReadAhead);
    std::memcpy(impl.bytes.data(), chunk.data(), chunk.size());
    std::fill_n(impl.bytes.data() + chunk.size(), RangeDecoder::kReadAhead, std::byte(0));
    impl.size = chunk.size();
    impl.first = true;
    impl.begin();
    return impl.in.impossible() ? "its compressed bytes begin as none can" : "";
}

std::size_t PointwiseDecoder::decode(std::size_t count, std::byte* records)
{
    Impl& impl = *m_impl;
    if (impl.size == 0) return 0;
    for (std::size_t k = 0; k < count; ++k, records += impl.length) {
        if (impl.first) {
            std::memcpy(records, impl.bytes.data(), impl.length);
            impl.first = false;
        } else {
            impl.next(records);
        }
        if (impl.in.damaged()) return k;
    }
    return count;
}

std::uint64_t PointwiseDecoder::position() const
{
    return m_impl->size == 0 ? 0 : m_impl->length + m_impl->in.taken();
}

}  // namespace punctum::las
