// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/ChunkCodec.h"
#include "core/las/Predictors.h"

#include <array>
#include <cstring>
#include <vector>

namespace punctum::las
{

/// The records of pointwise chunks (formats 0 to 5), coded field by field: for PointwiseDecoder and
/// PointwiseEncoder. The predictors are those of M. Isenburg, "LASzip: lossless compression of LiDAR data",
/// Photogrammetric Engineering & Remote Sensing 79(2), 2013, as the items of version 2 have them.

/// Contexts by number of returns (row) and return number: all pairs that can be have one, the impossible ones
/// share.
constexpr std::uint8_t kReturnContext[8][8] = {
    {15, 14, 13, 12, 11, 10, 9, 8},  {14, 0, 1, 3, 6, 10, 10, 9},    {13, 1, 2, 4, 7, 11, 11, 10},
    {12, 3, 4, 5, 8, 12, 12, 11},    {11, 6, 7, 8, 9, 13, 13, 12},   {10, 10, 11, 12, 13, 14, 14, 13},
    {9, 10, 11, 12, 13, 14, 15, 14}, {8, 9, 10, 11, 12, 13, 14, 15},
};
/// How many returns below the last one, by number of returns and return number.
constexpr unsigned returnLevelOf(unsigned returns, unsigned number)
{
    return returns > number ? returns - number : number - returns;
}

/// The 20 bytes of format 0.
class PointItem
{
public:
    static constexpr std::size_t kBytes = 20;

    struct Value {
        std::array<std::uint32_t, 3> axes{};
        std::uint16_t intensity = 0, source = 0;
        std::uint8_t returns = 0, code = 0, angle = 0, user = 0;

        void load(const std::byte* record)
        {
            std::memcpy(axes.data(), record, 12);
            std::memcpy(&intensity, record + 12, 2);
            returns = std::uint8_t(record[14]);
            code = std::uint8_t(record[15]);
            angle = std::uint8_t(record[16]);
            user = std::uint8_t(record[17]);
            std::memcpy(&source, record + 18, 2);
        }
        void store(std::byte* record) const
        {
            std::memcpy(record, axes.data(), 12);
            std::memcpy(record + 12, &intensity, 2);
            record[14] = std::byte(returns);
            record[15] = std::byte(code);
            record[16] = std::byte(angle);
            record[17] = std::byte(user);
            std::memcpy(record + 18, &source, 2);
        }
    };

    void start(const Value& first)
    {
        m_last = first;
        m_last.intensity = 0;  // so version 2 has it
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
    template <typename Coder>
    const Value& code(Coder& coder, const Value& real)
    {
        Value& v = m_last;
        const unsigned changed = coder.likelySymbol(m_changed, Coder::kEncodes ? changes(real) : 0);
        if ((changed & 32) != 0)
            v.returns = std::uint8_t(coder.likelySymbol(m_returnModels[v.returns], real.returns));
        const unsigned number = v.returns & 7, returns = (v.returns >> 3) & 7;
        const unsigned context = kReturnContext[returns][number], level = returnLevelOf(returns, number);
        if (changed != 0) {
            std::uint16_t& last = m_lastIntensity[context];
            if ((changed & 16) != 0)
                last = std::uint16_t(coder.integer(m_intensities, last, std::min(context, 3u), real.intensity));
            v.intensity = last;
            if ((changed & 8) != 0) v.code = std::uint8_t(coder.symbol(m_classModels[v.code], real.code));
            if ((changed & 4) != 0)
                v.angle = std::uint8_t(
                    v.angle + coder.symbol(m_angles[(v.returns >> 6) & 1], std::uint8_t(real.angle - v.angle)));
            if ((changed & 2) != 0) v.user = std::uint8_t(coder.symbol(m_userModels[v.user], real.user));
            if ((changed & 1) != 0) v.source = std::uint16_t(coder.integer(m_sources, v.source, 0, real.source));
        }
        const unsigned single = returns == 1 ? 1 : 0;
        auto& [medianX, medianY] = m_medians[context];
        const std::int32_t dx = coder.integer(m_dx, medianX.get(), single, std::int32_t(real.axes[0] - v.axes[0]));
        medianX.add(dx);
        const std::int32_t dy = coder.integer(m_dy, medianY.get(), single + evenUpTo(m_dx.length, 20),
                                              std::int32_t(real.axes[1] - v.axes[1]));
        medianY.add(dy);
        v.axes[0] += std::uint32_t(dx);
        v.axes[1] += std::uint32_t(dy);
        std::int32_t& height = m_lastHeight[level];
        height = coder.integer(m_z, height, single + evenUpTo((m_dx.length + m_dy.length) / 2, 18),
                               std::int32_t(real.axes[2]));
        v.axes[2] = std::uint32_t(height);
        return v;
    }

private:
    unsigned changes(const Value& real) const
    {
        const unsigned context = kReturnContext[(real.returns >> 3) & 7][real.returns & 7];
        return unsigned(real.returns != m_last.returns) << 5 |
               unsigned(real.intensity != m_lastIntensity[context]) << 4 | unsigned(real.code != m_last.code) << 3 |
               unsigned(real.angle != m_last.angle) << 2 | unsigned(real.user != m_last.user) << 1 |
               unsigned(real.source != m_last.source);
    }

    Value m_last;
    SymbolModel<64> m_changed;
    IntegerModels<16, 4> m_intensities;
    std::array<SymbolModel<256>, 2> m_angles;
    IntegerModels<16, 1> m_sources;
    SparseModels<256, 256> m_returnModels, m_classModels, m_userModels;
    IntegerModels<32, 2> m_dx;
    IntegerModels<32, 22> m_dy;
    IntegerModels<32, 20> m_z;
    std::array<std::array<RunningMedian, 2>, 16> m_medians;
    std::array<std::uint16_t, 16> m_lastIntensity{};
    std::array<std::int32_t, 8> m_lastHeight{};
};

/// A value that is bytes as they are.
template <typename T>
struct PlainValue {
    T bytes{};

    void load(const std::byte* record) { std::memcpy(&bytes, record, sizeof bytes); }
    void store(std::byte* record) const { std::memcpy(record, &bytes, sizeof bytes); }
};

/// GPS time.
class TimeItem
{
public:
    static constexpr std::size_t kBytes = 8;
    using Value = PlainValue<std::uint64_t>;

    void start(const Value& first) { m_predictor.reset(first.bytes); }
    template <typename Coder>
    Value code(Coder& coder, const Value& real)
    {
        return {m_predictor.code(coder, real.bytes)};
    }

private:
    TimePredictor<true> m_predictor;
};

/// Red, green and blue.
class ColorItem
{
public:
    static constexpr std::size_t kBytes = 6;
    using Value = PlainValue<ColorPredictor::Color>;

    void start(const Value& first)
    {
        m_last = first;
        m_predictor.reset();
    }
    template <typename Coder>
    const Value& code(Coder& coder, const Value& real)
    {
        m_last.bytes = m_predictor.code(coder, m_last.bytes, real.bytes);
        return m_last;
    }

private:
    Value m_last;
    ColorPredictor m_predictor;
};

/// Waveform packets.
class WaveItem
{
public:
    static constexpr std::size_t kBytes = WavePacket::kBytes;
    using Value = WavePacket;

    void start(const Value& first)
    {
        m_last = first;
        m_predictor.reset();
    }
    template <typename Coder>
    const Value& code(Coder& coder, const Value& real)
    {
        return m_last = m_predictor.code(coder, m_last, real);
    }

private:
    Value m_last;
    WavePredictor m_predictor;
};

/// An extra byte, as the difference to that of the point before.
class ByteItem
{
public:
    static constexpr std::size_t kBytes = 1;
    using Value = PlainValue<std::uint8_t>;

    void start(const Value& first)
    {
        m_last = first;
        m_differences.reset();
    }
    template <typename Coder>
    const Value& code(Coder& coder, const Value& real)
    {
        const auto difference = std::uint8_t(real.bytes - m_last.bytes);
        m_last.bytes = std::uint8_t(m_last.bytes + coder.symbol(m_differences, difference));
        return m_last;
    }

private:
    Value m_last;
    SymbolModel<256> m_differences;
};

/// All items of a record, one after the other, by one coder.
class PointwiseItems
{
public:
    explicit PointwiseItems(const LazInfo& info)
        : m_hasTime(hasGpsTime(info.format)),
          m_hasColor(hasColor(info.format)),
          m_hasWave(hasWaveform(info.format)),
          m_extra(std::size_t(info.recordLength - standardRecordLength(info.format)))
    {
    }
    /// Begins a chunk with its first record, which is not coded.
    void start(const std::byte* record)
    {
        forEachItem([&](auto& item) {
            item.start(loaded(item, record));
            record += item.kBytes;
        });
    }
    void encode(RangeEncoder& out, const std::byte* record)
    {
        forEachItem([&](auto& item) {
            item.code(out, loaded(item, record));
            record += item.kBytes;
        });
    }
    void decode(RangeDecoder& in, std::byte* record)
    {
        forEachItem([&](auto& item) {
            item.code(in, {}).store(record);
            record += item.kBytes;
        });
    }

private:
    template <typename Item>
    static typename Item::Value loaded(const Item&, const std::byte* record)
    {
        typename Item::Value value;
        value.load(record);
        return value;
    }
    template <typename Visit>
    [[gnu::always_inline]] void forEachItem(const Visit& visit)
    {
        visit(m_point);
        if (m_hasTime) visit(m_time);
        if (m_hasColor) visit(m_color);
        if (m_hasWave) visit(m_wave);
        for (ByteItem& item : m_extra) visit(item);
    }

    bool m_hasTime, m_hasColor, m_hasWave;
    PointItem m_point;
    TimeItem m_time;
    ColorItem m_color;
    WaveItem m_wave;
    std::vector<ByteItem> m_extra;
};

}  // namespace punctum::las
