// SPDX-License-Identifier: MIT
// The predictors of M. Isenburg, "LASzip: lossless compression of LiDAR data", Photogrammetric Engineering & Remote
// Sensing 79(2), 2013, as the items of version 2 have them.
#include "core/las/PointwiseDecoder.h"

#include "core/las/ChunkCodec.h"
#include "core/las/Predictors.h"

#include <array>
#include <cstring>
#include <vector>

namespace punctum::las
{

namespace
{

constexpr std::size_t kPointBytes = 20, kTimeBytes = 8, kColorBytes = 6, kWaveBytes = WavePacket::kBytes;

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
    SparseModels<256, 256> m_returnModels, m_classModels, m_userModels;
    IntegerModels<32, 2> m_dx;
    IntegerModels<32, 22> m_dy;
    IntegerModels<32, 20> m_z;
    std::array<std::array<RunningMedian, 2>, 16> m_medians;
    std::array<std::uint16_t, 16> m_lastIntensity{};
    std::array<std::int32_t, 8> m_lastHeight{};
};

/// GPS time.
class TimeItem
{
public:
    void start(const std::byte* record)
    {
        std::uint64_t time;
        std::memcpy(&time, record, kTimeBytes);
        m_predictor.reset(time);
    }
    void decode(RangeDecoder& in, std::byte* record)
    {
        const std::uint64_t time = m_predictor.decode(in);
        std::memcpy(record, &time, kTimeBytes);
    }

private:
    TimePredictor<true> m_predictor;
};

/// Red, green and blue.
class ColorItem
{
public:
    void start(const std::byte* record)
    {
        std::memcpy(m_color.data(), record, kColorBytes);
        m_predictor.reset();
    }
    void decode(RangeDecoder& in, std::byte* record)
    {
        m_predictor.decode(in, m_color);
        std::memcpy(record, m_color.data(), kColorBytes);
    }

private:
    ColorPredictor::Color m_color{};
    ColorPredictor m_predictor;
};

/// Waveform packets.
class WaveItem
{
public:
    void start(const std::byte* record)
    {
        m_packet.load(record);
        m_predictor.reset();
    }
    void decode(RangeDecoder& in, std::byte* record)
    {
        m_predictor.decode(in, m_packet);
        m_packet.store(record);
    }

private:
    WavePacket m_packet;
    WavePredictor m_predictor;
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
