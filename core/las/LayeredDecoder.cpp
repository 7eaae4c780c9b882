// SPDX-License-Identifier: MIT
// The layers of the point formats 6 to 10, after M. Isenburg's LASzip 3 ("native LAS 1.4 compressor", 2017) and the
// predictors of "LASzip: lossless compression of LiDAR data" (2013).
#include "core/las/LayeredDecoder.h"

#include "core/las/ChunkCodec.h"
#include "core/las/Predictors.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>
#include <vector>

namespace punctum::las
{

namespace
{

/// Offsets in the record (LAS 1.4 R15, table 11).
constexpr std::size_t kZAt = 8, kIntensityAt = 12, kReturnsAt = 14, kFlagsAt = 15, kClassAt = 16, kUserAt = 17,
                      kAngleAt = 18, kSourceAt = 20, kTimeAt = 22, kRestAt = 30;
constexpr std::size_t kColorBytes = 6, kNirBytes = 2;
constexpr unsigned kChannels = 4;
constexpr unsigned kChannelShift = 4, kChannelBits = 3u << kChannelShift;  ///< of the flags
constexpr unsigned kMixingUpTo = 3;  ///< last version of the items in which channels mix, see Turn and Channels

constexpr std::size_t kBlock = 256;  ///< points between two looks for damage

/// Six contexts by number of returns and return number, which of the two is the smaller one does not matter.
constexpr std::uint8_t returnContext(unsigned returns, unsigned number)
{
    constexpr std::uint8_t kWithZero[] = {0, 1, 2, 3, 4, 5, 3, 4, 4, 5};
    const unsigned low = std::min(returns, number), high = std::max(returns, number);
    switch (low) {
        case 0:
            return kWithZero[std::min(high, 9u)];
        case 1:
            return high < 3 ? std::uint8_t(high - 1) : 3;
        case 2:
            return high == 2 ? 2 : high < 11 ? 4 : 3;
        default:
            return high == low || (low > 10 && high == low + 1) ? 5 : 4;
    }
}
/// How many returns below the last one.
constexpr std::uint8_t returnLevel(unsigned returns, unsigned number)
{
    return std::uint8_t(std::min(returns > number ? returns - number : number - returns, 7u));
}

struct ReturnContexts {
    std::uint8_t map, level;
};
constexpr auto kReturnContexts = [] {
    std::array<ReturnContexts, 256> table{};
    for (unsigned k = 0; k < table.size(); ++k)
        table[k] = {returnContext(k >> 4, k & 15), returnLevel(k >> 4, k & 15)};
    return table;
}();

unsigned channelOf(const std::byte* record)
{
    return (unsigned(record[kFlagsAt]) & kChannelBits) >> kChannelShift;
}

/// What the first layer says of a point, by which the others go.
struct Turn {
    std::uint8_t channel = 0;  ///< scanner channel
    /// The same, for color, waveforms and extra bytes. As LASzip had it before version 4 of the items: 0 wherever
    /// the channel did not just change.
    std::uint8_t itemChannel = 0;
    std::uint8_t place = 0;     ///< first return: 2, last: 1, both: 3
    std::uint8_t level = 0;     ///< returns below the last one
    std::uint8_t zContext = 0;  ///< by the size of the steps in X and Y
    bool newAngle = false, newSource = false, newTime = false;
};

/// What a layer keeps for each scanner channel, made when the channel first comes. A State has `last`, the value of
/// the channel's last point, and begin(), which forgets all but a value to begin with.
template <typename State>
class Channels
{
public:
    using Value = decltype(State::last);

    /// `mixing`: as LASzip had it before version 4 of the items. The point with which another channel comes back is
    /// told from, and stands for, the last point of the channel before.
    explicit Channels(bool mixing = false) : m_mixing(mixing) {}

    void start(unsigned channel, const Value& value)
    {
        m_known = {};
        m_now = channel;
        begin(channel, value);
    }
    unsigned channel() const { return m_now; }
    State& now() { return *m_states[m_now]; }

    struct Place {
        State& state;
        Value& last;
    };
    Place at(unsigned channel)
    {
        if (channel == m_now) [[likely]]
            return {now(), now().last};
        State& before = now();
        m_now = channel;
        const bool known = m_known[channel];
        if (!known) begin(channel, before.last);
        return {now(), known && m_mixing ? before.last : now().last};
    }

private:
    void begin(unsigned channel, const Value& value)
    {
        if (!m_states[channel]) m_states[channel] = std::make_unique<State>();
        m_states[channel]->begin(value);
        m_known[channel] = true;
    }

    bool m_mixing;
    unsigned m_now = 0;
    std::array<bool, kChannels> m_known{};
    std::array<std::unique_ptr<State>, kChannels> m_states;
};

/// Scanner channel, returns, X and Y, and which of the other values change: the layer that each chunk has.
class FirstLayer
{
public:
    explicit FirstLayer(bool mixing) : m_mixing(mixing) {}
    void start(const std::byte* record, RangeDecoder in)
    {
        m_in = in;
        State::Value value;
        std::memcpy(value.xy.data(), record, sizeof value.xy);
        value.returns = std::uint8_t(record[kReturnsAt]);
        m_flags = std::uint8_t(record[kFlagsAt]) & ~kChannelBits;
        m_channels.start(channelOf(record), value);
    }
    const RangeDecoder& in() const { return m_in; }
    /// The next point: fills in its bytes of the record.
    Turn decode(std::byte* record)
    {
        RangeDecoder in = m_in;  // a copy, which the processor has in registers
        Turn turn;
        decode(in, turn, record);
        m_in = in;
        return turn;
    }

private:
    struct State {
        struct Value {
            std::array<std::uint32_t, 2> xy{};
            std::uint8_t returns = 0;
        };
        Value last;
        bool newTime = false;
        std::array<SymbolModel<128>, 8> changes;
        SymbolModel<3> channel;
        std::array<SymbolModel<16>, 16> counts, numbers;
        SymbolModel<13> numbersOfSameTime;
        IntegerModels<32, 2> dx;
        IntegerModels<32, 22> dy;
        std::array<std::array<RunningMedian, 2>, 12> medians;

        void begin(const Value& value)
        {
            last = value;
            newTime = false;
            for (auto& m : changes) m.reset();
            channel.reset();
            for (auto& m : counts) m.reset();
            for (auto& m : numbers) m.reset();
            numbersOfSameTime.reset();
            dx.reset();
            dy.reset();
            medians = {};
        }
    };

    void decode(RangeDecoder& in, Turn& turn, std::byte* record)
    {
        State& before = m_channels.now();
        unsigned number = before.last.returns & 15, count = before.last.returns >> 4;
        const unsigned kind = (number == 1 ? 1 : 0) + (number >= count ? 2 : 0) + (before.newTime ? 4 : 0);
        const unsigned changes = in.likelySymbol(before.changes[kind]);
        turn.newAngle = (changes & 8) != 0;
        turn.newTime = (changes & 16) != 0;
        turn.newSource = (changes & 32) != 0;
        turn.channel = std::uint8_t(m_channels.channel());
        if ((changes & 64) != 0)
            turn.channel = std::uint8_t((turn.channel + in.symbol(before.channel) + 1) % kChannels);
        turn.itemChannel = m_mixing && (changes & 64) == 0 ? 0 : turn.channel;
        State& state = m_channels.at(turn.channel).state;

        number = state.last.returns & 15;
        count = state.last.returns >> 4;
        if ((changes & 4) != 0) count = in.symbol(state.counts[count]);
        switch (changes & 3) {
            case 0:
                break;
            case 1:
                number = (number + 1) & 15;
                break;
            case 2:
                number = (number - 1) & 15;
                break;
            default:
                if (turn.newTime)
                    number = in.symbol(state.numbers[number]);
                else
                    number = (number + in.symbol(state.numbersOfSameTime) + 2) & 15;
        }
        state.last.returns = std::uint8_t(count << 4 | number);
        state.newTime = turn.newTime;
        const ReturnContexts contexts = kReturnContexts[state.last.returns];
        turn.level = contexts.level;
        turn.place = std::uint8_t((number == 1 ? 2 : 0) + (number >= count ? 1 : 0));

        const unsigned single = count == 1 ? 1 : 0;
        auto& [medianX, medianY] = state.medians[2u * contexts.map + (turn.newTime ? 1 : 0)];
        const std::int32_t dx = in.integer(state.dx, medianX.get(), single);
        medianX.add(dx);
        const std::int32_t dy = in.integer(state.dy, medianY.get(), single + evenUpTo(state.dx.length, 20));
        medianY.add(dy);
        turn.zContext = std::uint8_t(single + evenUpTo((state.dx.length + state.dy.length) / 2, 18));
        state.last.xy[0] += std::uint32_t(dx);
        state.last.xy[1] += std::uint32_t(dy);

        std::memcpy(record, state.last.xy.data(), sizeof state.last.xy);
        record[kReturnsAt] = std::byte(state.last.returns);
        record[kFlagsAt] = std::byte(m_flags | unsigned(turn.channel) << kChannelShift);
    }

    bool m_mixing;
    RangeDecoder m_in;
    unsigned m_flags = 0;
    Channels<State> m_channels;
};

/// Any other layer: one field of the records. Where no value changes it is not there at all.
class Layer
{
public:
    virtual ~Layer() = default;
    virtual void start(const std::byte* record, RangeDecoder in) = 0;
    virtual void decode(const Turn& turn, std::byte* record) = 0;
    const RangeDecoder& in() const { return m_in; }

protected:
    RangeDecoder m_in;
};

template <typename State>
class FieldLayer final : public Layer
{
public:
    FieldLayer(std::size_t at, std::uint8_t Turn::*channel, bool mixing)
        : m_at(at), m_channel(channel), m_channels(mixing)
    {
    }
    void start(const std::byte* record, RangeDecoder in) override
    {
        m_in = in;
        m_channels.start(channelOf(record), State::load(record + m_at));
    }
    void decode(const Turn& turn, std::byte* record) override
    {
        RangeDecoder in = m_in;
        auto [state, last] = m_channels.at(turn.*m_channel);
        state.decode(in, turn, last);
        State::store(record + m_at, last);
        m_in = in;
    }

private:
    std::size_t m_at;
    std::uint8_t Turn::*m_channel;
    Channels<State> m_channels;
};

/// A field that is bytes as they are.
template <typename Value>
struct Field {
    Value last{};

    static Value load(const std::byte* field)
    {
        Value value;
        std::memcpy(&value, field, sizeof value);
        return value;
    }
    static void store(std::byte* field, const Value& value) { std::memcpy(field, &value, sizeof value); }
};

/// One that is told from its last value alone.
template <typename Value, typename Models>
struct ModeledField : Field<Value> {
    Models models;

    void begin(Value value)
    {
        this->last = value;
        models.reset();
    }
};

struct Height : Field<std::int32_t> {
    std::array<std::int32_t, 8> byLevel{};
    IntegerModels<32, 20> models;

    void begin(std::int32_t value)
    {
        last = value;
        byLevel.fill(value);
        models.reset();
    }
    void decode(RangeDecoder& in, const Turn& turn, std::int32_t& value)
    {
        std::int32_t& before = byLevel[turn.level];
        value = before = in.integer(models, before, turn.zContext);
    }
};

struct Class : ModeledField<std::uint8_t, SparseModels<256, 64>> {
    void decode(RangeDecoder& in, const Turn& turn, std::uint8_t& value)
    {
        value = std::uint8_t(in.likelySymbol(models[(value & 31u) << 1 | (turn.place == 3 ? 1u : 0u)]));
    }
};

/// All of the byte but the scanner channel.
struct Flags {
    std::uint8_t last = 0;
    SparseModels<64, 64> models;

    static std::uint8_t load(const std::byte* field) { return std::uint8_t(unsigned(*field) & ~kChannelBits); }
    static void store(std::byte* field, std::uint8_t value)
    {
        *field = std::byte((unsigned(*field) & kChannelBits) | value);
    }
    void begin(std::uint8_t value)
    {
        last = value;
        models.reset();
    }
    void decode(RangeDecoder& in, const Turn&, std::uint8_t& value)
    {
        const unsigned symbol = in.likelySymbol(models[(value & 15u) | (value >> 2 & 0x30u)]);
        value = std::uint8_t((symbol & 15u) | (symbol & 0x30u) << 2);
    }
};

struct Intensity : Field<std::uint16_t> {
    std::array<std::uint16_t, 8> byPlace{};
    IntegerModels<16, 4> models;

    void begin(std::uint16_t value)
    {
        last = value;
        byPlace.fill(value);
        models.reset();
    }
    void decode(RangeDecoder& in, const Turn& turn, std::uint16_t& value)
    {
        std::uint16_t& before = byPlace[2u * turn.place + (turn.newTime ? 1 : 0)];
        value = before = std::uint16_t(in.integer(models, before, turn.place));
    }
};

struct Angle : ModeledField<std::int16_t, IntegerModels<16, 2>> {
    void decode(RangeDecoder& in, const Turn& turn, std::int16_t& value)
    {
        if (turn.newAngle) value = std::int16_t(in.integer(models, value, turn.newTime ? 1 : 0));
    }
};

struct UserData : ModeledField<std::uint8_t, SparseModels<256, 64>> {
    void decode(RangeDecoder& in, const Turn&, std::uint8_t& value)
    {
        value = std::uint8_t(in.likelySymbol(models[value / 4u]));
    }
};

struct Source : ModeledField<std::uint16_t, IntegerModels<16, 1>> {
    void decode(RangeDecoder& in, const Turn& turn, std::uint16_t& value)
    {
        if (turn.newSource) value = std::uint16_t(in.integer(models, value, 0));
    }
};

struct Time : Field<std::uint64_t> {
    TimePredictor<false> predictor;

    void begin(std::uint64_t value)
    {
        last = value;
        predictor.reset(value);
    }
    void decode(RangeDecoder& in, const Turn& turn, std::uint64_t& value)
    {
        if (turn.newTime) value = predictor.code(in, 0);
    }
};

struct Color : Field<ColorPredictor::Color> {
    ColorPredictor predictor;

    void begin(const ColorPredictor::Color& value)
    {
        last = value;
        predictor.reset();
    }
    void decode(RangeDecoder& in, const Turn&, ColorPredictor::Color& value)
    {
        value = predictor.code(in, value, {});
    }
};

struct Nir : Field<std::array<std::uint8_t, kNirBytes>> {
    SymbolModel<4> changes;
    std::array<SymbolModel<256>, kNirBytes> differences;

    void begin(const std::array<std::uint8_t, kNirBytes>& value)
    {
        last = value;
        changes.reset();
        for (auto& m : differences) m.reset();
    }
    void decode(RangeDecoder& in, const Turn&, std::array<std::uint8_t, kNirBytes>& value)
    {
        const unsigned changed = in.likelySymbol(changes);
        for (unsigned k = 0; k < kNirBytes; ++k)
            if ((changed >> k & 1) != 0) value[k] = std::uint8_t(value[k] + in.symbol(differences[k]));
    }
};

struct Wave {
    WavePacket last;
    WavePredictor predictor;

    static WavePacket load(const std::byte* field)
    {
        WavePacket value;
        value.load(field);
        return value;
    }
    static void store(std::byte* field, const WavePacket& value) { value.store(field); }
    void begin(const WavePacket& value)
    {
        last = value;
        predictor.reset();
    }
    void decode(RangeDecoder& in, const Turn&, WavePacket& value) { value = predictor.code(in, value, {}); }
};

struct ExtraByte : Field<std::uint8_t> {
    SymbolModel<256> differences;

    void begin(std::uint8_t value)
    {
        last = value;
        differences.reset();
    }
    void decode(RangeDecoder& in, const Turn&, std::uint8_t& value)
    {
        value = std::uint8_t(value + in.likelySymbol(differences));
    }
};

}  // namespace

struct LayeredDecoder::Impl {
    explicit Impl(const LazInfo& i) : info(i), length(i.recordLength), first(mixes(0))
    {
        add<Height>(kZAt);
        add<Class>(kClassAt);
        add<Flags>(kFlagsAt);
        add<Intensity>(kIntensityAt);
        add<Angle>(kAngleAt);
        add<UserData>(kUserAt);
        add<Source>(kSourceAt);
        add<Time>(kTimeAt);
        std::size_t at = kRestAt, item = 0;
        if (hasColor(info.format)) add<Color>(std::exchange(at, at + kColorBytes), ++item);
        if (hasNir(info.format)) add<Nir>(std::exchange(at, at + kNirBytes), item);
        if (hasWaveform(info.format)) add<Wave>(std::exchange(at, at + WavePacket::kBytes), ++item);
        if (at < length) ++item;
        while (at < length) add<ExtraByte>(at++, item);
    }
    bool mixes(std::size_t item) const { return info.items.at(item).version <= kMixingUpTo; }
    template <typename State>
    void add(std::size_t at, std::size_t item = 0)
    {
        const auto channel = item == 0 ? &Turn::channel : &Turn::itemChannel;
        layers.push_back(std::make_unique<FieldLayer<State>>(at, channel, item != 0 && mixes(item)));
    }
    bool damaged() const
    {
        return first.in().damaged() ||
               std::any_of(present.begin(), present.end(), [](const Layer* l) { return l->in().damaged(); });
    }

    LazInfo info;
    std::size_t length;
    FirstLayer first;
    std::vector<std::unique_ptr<Layer>> layers;  ///< all others, in their order
    std::vector<Layer*> present;                 ///< those of them that the chunk has
    std::vector<std::byte> bytes;  ///< the first record and the layers, each with what a decoder reads ahead
    std::uint64_t size = 0, head = 0;
    bool atFirst = true;
};

bool LayeredDecoder::supports(const LazInfo& info)
{
    return info.compressor == LazInfo::Layered;
}

LayeredDecoder::LayeredDecoder(const LazInfo& info) : m_impl(std::make_unique<Impl>(info)) {}

LayeredDecoder::~LayeredDecoder() = default;

std::string LayeredDecoder::start(std::span<const std::byte> chunk)
{
    Impl& impl = *m_impl;
    impl.size = 0;
    impl.present.clear();
    if (std::string why = checkLayeredChunk(chunk, impl.info, {}); !why.empty()) return why;

    const std::size_t layers = impl.layers.size() + 1, sizesAt = impl.length + 4;
    impl.head = sizesAt + 4 * layers;
    impl.bytes.resize(impl.length + (chunk.size() - impl.head) + layers * RangeDecoder::kReadAhead);
    const std::byte* from = chunk.data() + impl.head;
    std::byte* to = impl.bytes.data() + impl.length;
    const std::byte* record = std::copy_n(chunk.data(), impl.length, impl.bytes.data()) - impl.length;
    bool impossible = false;
    for (std::size_t k = 0; k < layers; ++k) {
        std::uint32_t size;
        std::memcpy(&size, chunk.data() + sizesAt + 4 * k, sizeof size);
        std::copy_n(from, size, to);
        std::fill_n(to + size, RangeDecoder::kReadAhead, std::byte(0));
        const RangeDecoder in(std::span(to, size));
        if (k == 0) {
            impl.first.start(record, in);
        } else if (size != 0) {
            impl.present.push_back(impl.layers[k - 1].get());
            impl.present.back()->start(record, in);
        }
        impossible = impossible || ((k == 0 || size != 0) && in.impossible());
        from += size;
        to += size + RangeDecoder::kReadAhead;
    }
    impl.size = chunk.size();
    impl.atFirst = true;
    return impossible ? kImpossibleStart : "";
}

std::size_t LayeredDecoder::decode(std::size_t count, std::byte* records)
{
    Impl& impl = *m_impl;
    if (impl.size == 0) return 0;
    for (std::size_t done = 0; done < count;) {
        const std::size_t n = std::min(kBlock, count - done);
        for (std::size_t k = 0; k < n; ++k) {
            std::byte* record = records + k * impl.length;
            // What no layer changes is as in the first record.
            std::memcpy(record, impl.bytes.data(), impl.length);
            if (std::exchange(impl.atFirst, false)) continue;
            const Turn turn = impl.first.decode(record);
            for (Layer* layer : impl.present) layer->decode(turn, record);
        }
        if (impl.damaged()) return done;
        done += n;
        records += n * impl.length;
    }
    return count;
}

std::uint64_t LayeredDecoder::position() const
{
    const Impl& impl = *m_impl;
    if (impl.size == 0) return 0;
    if (impl.damaged()) return impl.size + 1;
    std::uint64_t position = impl.head + impl.first.in().taken();
    for (const Layer* layer : impl.present) position += layer->in().taken();
    return position;
}

bool LayeredDecoder::endsAsWritten() const
{
    const Impl& impl = *m_impl;
    return impl.first.in().zerosAsWritten() && std::all_of(impl.present.begin(), impl.present.end(),
                                                           [](const Layer* l) { return l->in().zerosAsWritten(); });
}

}  // namespace punctum::las
