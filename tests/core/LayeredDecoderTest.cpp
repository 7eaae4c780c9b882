// SPDX-License-Identifier: MIT
#include "core/las/LayeredDecoder.h"

#include "tests/core/ChunkDecoding.h"

using namespace punctum::las;
namespace fs = std::filesystem;

/// Our own decoder of layered chunks against LASzip: the same records on real files, on records that reach every
/// branch, in all versions of the items; and damaged chunks, of which LASzip notices less.
class LayeredDecoderTest : public QObject
{
    Q_OBJECT

private slots:
    void realChunks();
    void madeChunks_data();
    void madeChunks();
    void unchangedFields();
    void versions_data();
    void versions();
    void damagedChunks_data();
    void damagedChunks();
    void movedLayerEnds();
    void endlessTimes();
    void unsoundHeads();
    void whatIsSupported();

private:
    static LazInfo infoOf(int format, int extra)
    {
        return LazInfo::standard(std::uint8_t(format),
                                 std::uint16_t(standardRecordLength(std::uint8_t(format)) + extra));
    }
    static Bytes chunkOf(const LazInfo& info, const Bytes& records)
    {
        return encodeChunk(info, records, punctum::Progress());
    }
    /// The same items in another version.
    static LazInfo withVersion(LazInfo info, std::uint16_t version)
    {
        for (std::size_t k = 0; k < info.items.size(); ++k) {
            info.items[k].version = version;
            std::memcpy(info.payload.data() + 34 + 6 * k + 4, &version, 2);
        }
        return info;
    }
    static std::uint32_t layerSize(const LazInfo& info, const Bytes& chunk, std::size_t layer)
    {
        std::uint32_t size;
        std::memcpy(&size, chunk.data() + info.recordLength + 4 + 4 * layer, 4);
        return size;
    }
    static void setLayerSize(const LazInfo& info, Bytes& chunk, std::size_t layer, std::uint32_t size)
    {
        std::memcpy(chunk.data() + info.recordLength + 4 + 4 * layer, &size, 4);
    }
    static void withoutLayer(const LazInfo& info, Bytes& chunk, std::size_t layer)
    {
        std::size_t at = info.recordLength + 4 + 4 * info.layers();
        for (std::size_t k = 0; k < layer; ++k) at += layerSize(info, chunk, k);
        const auto from = chunk.begin() + std::ptrdiff_t(at);
        chunk.erase(from, from + std::ptrdiff_t(layerSize(info, chunk, layer)));
        setLayerSize(info, chunk, layer, 0);
    }
};

void LayeredDecoderTest::realChunks()
{
    compareRealChunks(LayeredDecoder::supports, false);
}

void LayeredDecoderTest::madeChunks_data()
{
    QTest::addColumn<int>("format");
    QTest::addColumn<int>("extra");
    for (int format = 6; format <= 10; ++format)
        for (int extra : {0, 1, 7, 33})
            QTest::addRow("format %d, %d extra bytes", format, extra) << format << extra;
}

void LayeredDecoderTest::madeChunks()
{
    QFETCH(int, format);
    QFETCH(int, extra);
    const LazInfo info = infoOf(format, extra);
    for (const std::size_t count : {1, 2, 3, 1000, 20'000}) {
        const Bytes records =
            RecordSource(info.format, info.recordLength, unsigned(format * 100 + extra) + unsigned(count))
                .make(count);
        const Bytes chunk = chunkOf(info, records);
        checkMadeChunk(info, records, chunk);
    }
}

/// Layers that are not there: each field on its own is the same in the whole chunk.
void LayeredDecoderTest::unchangedFields()
{
    const LazInfo info = infoOf(10, 3);
    constexpr std::size_t kCount = 700;
    const std::pair<std::size_t, std::size_t> fields[] = {{8, 4},  {12, 2}, {15, 1}, {16, 1}, {17, 1},  {18, 2},
                                                          {20, 2}, {22, 8}, {30, 6}, {36, 2}, {38, 29}, {68, 1}};
    for (const auto& [at, bytes] : fields) {
        Bytes records = RecordSource(info.format, info.recordLength, unsigned(at)).make(kCount);
        for (std::size_t k = 1; k < kCount; ++k)
            std::copy_n(records.begin() + std::ptrdiff_t(at), bytes,
                        records.begin() + std::ptrdiff_t(k * info.recordLength + at));
        Bytes chunk = chunkOf(info, records);
        if (at == 8) withoutLayer(info, chunk, 1);  // which LASzip writes always, but reads without
        std::size_t absent = 0;
        for (std::size_t layer = 0; layer < info.layers(); ++layer) absent += layerSize(info, chunk, layer) == 0;
        QCOMPARE(absent, std::size_t(1));
        QVERIFY(decode(info, chunk, kCount, PointDecoder::Codec::Laszip).records == records);
        const Decoded ours = decode(info, chunk, kCount, PointDecoder::Codec::Fastest);
        QVERIFY(ours.records == records);
        QCOMPARE(ours.position, std::uint64_t(chunk.size()));
    }
}

void LayeredDecoderTest::versions_data()
{
    QTest::addColumn<int>("format");
    QTest::addColumn<int>("version");
    for (int format = 6; format <= 10; ++format)
        for (int version : {2, 4})
            if (version != 2 || !hasWaveform(std::uint8_t(format)))  // there are none of wave packets
                QTest::addRow("format %d, version %d", format, version) << format << version;
}

/// LASzip writes version 3 only. Version 2 is the same. In version 4 colors, waveforms and extra bytes go by the
/// point's own scanner channel, in version 3 only where the channel just changed; and they are told from another
/// point. So where it changes with each point, what was written as version 3 is one of version 4 as well, of other
/// points; elsewhere it is until the coders of the two part.
void LayeredDecoderTest::versions()
{
    QFETCH(int, format);
    QFETCH(int, version);
    constexpr std::size_t kCount = 5000;
    const LazInfo written = infoOf(format, 3), read = withVersion(written, std::uint16_t(version));
    for (const bool always : {true, false}) {
        RecordSource source(written.format, written.recordLength, 5);
        if (always) source.alwaysChangeChannel();
        const Bytes records = source.make(kCount);
        const Bytes chunk = chunkOf(written, records);
        const Decoded theirs = decode(read, chunk, kCount, PointDecoder::Codec::Laszip);
        const Decoded ours = decode(read, chunk, kCount, PointDecoder::Codec::Fastest);
        if (always || version == 2) {
            QCOMPARE(theirs.records.size(), records.size());
            QVERIFY(ours.records == theirs.records);
            QCOMPARE(ours.position, std::uint64_t(chunk.size()));
        } else {
            QVERIFY(ours.records.size() > 50 * std::size_t(written.recordLength));
            QVERIFY(ours.records.size() <= theirs.records.size());
            QVERIFY(std::equal(ours.records.begin(), ours.records.end(), theirs.records.begin()));
        }
        QCOMPARE(theirs.records == records, version == 2);
    }
}

void LayeredDecoderTest::damagedChunks_data()
{
    QTest::addColumn<int>("format");
    for (int format = 6; format <= 10; ++format) QTest::addRow("format %d", format) << format;
}

/// Damaged chunks may give anything, in bounds; what ours takes for whole must be what LASzip gives.
void LayeredDecoderTest::damagedChunks()
{
    QFETCH(int, format);
    const LazInfo info = infoOf(format, 3);
    const std::size_t length = info.recordLength;
    constexpr std::size_t kCount = 500;
    const Bytes sound = chunkOf(info, RecordSource(info.format, info.recordLength, 7).make(kCount));
    std::mt19937 random(unsigned(format) + 1);
    int unnoticed = 0;
    for (int round = 0; round < 400; ++round) {
        const Bytes chunk = damaged(sound, unsigned(round), random);
        const Decoded ours = decode(info, chunk, kCount, PointDecoder::Codec::Fastest);
        if (!ours.whole(kCount, length, chunk.size())) continue;
        ++unnoticed;
        const Decoded theirs = decode(info, chunk, kCount, PointDecoder::Codec::Laszip);
        QVERIFY(ours.records == theirs.records);
    }
    qInfo("%d of 400 damaged chunks look whole", unnoticed);
    QVERIFY(unnoticed < 60);  // noise, as these records are, hides more than points do
}

/// A byte more for one layer and one less for the next is noticed, though LASzip decodes some of it.
void LayeredDecoderTest::movedLayerEnds()
{
    const LazInfo info = infoOf(8, 2);
    constexpr std::size_t kCount = 2000;
    const Bytes sound = chunkOf(info, RecordSource(info.format, info.recordLength, 3).make(kCount));
    for (std::size_t layer = 0; layer + 1 < info.layers(); ++layer) {
        const std::uint32_t here = layerSize(info, sound, layer), next = layerSize(info, sound, layer + 1);
        QVERIFY(here > 4 && next > 4);
        for (const int move : {-1, 1}) {
            Bytes chunk = sound;
            setLayerSize(info, chunk, layer, here + std::uint32_t(move));
            setLayerSize(info, chunk, layer + 1, next - std::uint32_t(move));
            const Decoded ours = decode(info, chunk, kCount, PointDecoder::Codec::Fastest);
            QVERIFY(!ours.whole(kCount, info.recordLength, chunk.size()));
        }
    }
}

/// GPS times that change their sequence forever, at which LASzip's decoder calls itself until the stack is full.
void LayeredDecoderTest::endlessTimes()
{
    const LazInfo info = infoOf(6, 0);
    constexpr std::size_t kCount = 2000, kTimeLayer = 8;
    const Bytes sound = chunkOf(info, RecordSource(info.format, info.recordLength, 4).make(kCount));
    const std::uint32_t bytes = layerSize(info, sound, kTimeLayer);
    Bytes chunk = sound;
    for (std::uint32_t k = 1; k < bytes; ++k) chunk[chunk.size() - k] = std::byte(0xFF);
    chunk[chunk.size() - bytes] = std::byte(0xFE);
    QVERIFY(decode(info, chunk, kCount, PointDecoder::Codec::Fastest).records.size() < kCount * info.recordLength);
}

void LayeredDecoderTest::unsoundHeads()
{
    const LazInfo info = infoOf(6, 1);
    const Bytes sound = chunkOf(info, RecordSource(info.format, info.recordLength, 2).make(50));
    std::vector<std::byte> records(std::size_t(info.recordLength) * 60);
    const auto refused = [&](const Bytes& chunk) {
        PointDecoder decoder(info, chunk, 50);
        return decoder.decode(50, records.data()) < 50 && !decoder.error().empty();
    };
    QVERIFY(!refused(sound));
    for (std::size_t size : {std::size_t(0), std::size_t(1), std::size_t(info.recordLength) + 43, sound.size() - 1})
        QVERIFY(refused(Bytes(sound.begin(), sound.begin() + std::ptrdiff_t(size))));
    for (std::size_t layer = 0; layer < info.layers(); ++layer)
        for (const std::uint32_t size : {UINT32_MAX, 0x80000000u, 0u, 3u}) {
            Bytes chunk = sound;
            setLayerSize(info, chunk, layer, size);
            QVERIFY(refused(chunk));
        }
    // The layer that every chunk has, with no byte, and all others with none.
    Bytes empty(sound.begin(), sound.begin() + info.recordLength + 4 + 4 * std::ptrdiff_t(info.layers()));
    for (std::size_t layer = 0; layer < info.layers(); ++layer) setLayerSize(info, empty, layer, 0);
    QVERIFY(refused(empty));
    // More points than there are.
    PointDecoder decoder(info, sound, 60);
    QVERIFY(decoder.decode(60, records.data()) < 60 || decoder.position() > sound.size());
}

void LayeredDecoderTest::whatIsSupported()
{
    for (int format = 0; format <= 10; ++format) {
        QCOMPARE(LayeredDecoder::supports(infoOf(format, 0)), format >= 6);
        QVERIFY(ChunkDecoder::make(infoOf(format, 0)) != nullptr);
    }
}

QTEST_GUILESS_MAIN(LayeredDecoderTest)
#include "LayeredDecoderTest.moc"
