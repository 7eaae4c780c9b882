// SPDX-License-Identifier: MIT
#include "core/las/PointwiseDecoder.h"

#include "tests/core/ChunkDecoding.h"

#include <sstream>

using namespace punctum::las;
namespace fs = std::filesystem;

namespace
{

/// What LASzip makes of the records: the bytes between the position of the table and the table.
Bytes chunkByLaszip(LazInfo info, const Bytes& records)
{
    info.chunkSize = std::uint32_t(records.size() / info.recordLength);
    std::ostringstream out;
    LaszipEncoder encoder(info, out);
    encoder.add(records);
    encoder.finish();
    const std::string all = std::move(out).str();
    std::int64_t table = 0;
    std::memcpy(&table, all.data(), sizeof table);
    Bytes chunk(std::size_t(table) - sizeof table);
    std::memcpy(chunk.data(), all.data() + sizeof table, chunk.size());
    return chunk;
}

}  // namespace

/// Our own coding of pointwise chunks against LASzip: encoded, the same bytes; decoded, the same records and the
/// same end; on real files, on records that reach every branch of the predictors, and on damaged chunks.
class PointwiseDecoderTest : public QObject
{
    Q_OBJECT

private slots:
    void realChunks();
    void madeChunks_data();
    void madeChunks();
    void damagedChunks_data();
    void damagedChunks();
    void shortChunks();
    void whatIsSupported();
};

void PointwiseDecoderTest::realChunks()
{
    compareRealChunks(PointwiseDecoder::supports, true);
}

void PointwiseDecoderTest::madeChunks_data()
{
    QTest::addColumn<int>("format");
    QTest::addColumn<int>("extra");
    for (int format = 0; format <= 5; ++format)
        for (int extra : {0, 1, 7, 33})
            QTest::addRow("format %d, %d extra bytes", format, extra) << format << extra;
}

void PointwiseDecoderTest::madeChunks()
{
    QFETCH(int, format);
    QFETCH(int, extra);
    const auto f = std::uint8_t(format);
    const auto length = std::uint16_t(standardRecordLength(f) + extra);
    const LazInfo info = LazInfo::standard(f, length);
    QVERIFY(PointwiseDecoder::supports(info));
    for (const std::size_t count : {1, 2, 3, 1000, 20'000}) {
        const Bytes records = RecordSource(f, length, unsigned(format * 100 + extra) + unsigned(count)).make(count);
        const Bytes chunk = encodeChunk(info, records, punctum::Progress());
        QVERIFY(chunk == chunkByLaszip(info, records));
        checkMadeChunk(info, records, chunk);
    }
}

void PointwiseDecoderTest::damagedChunks_data()
{
    QTest::addColumn<int>("format");
    for (int format = 0; format <= 5; ++format) QTest::addRow("format %d", format) << format;
}

/// Where LASzip decodes all points and ends exactly, ours must give the same; else it may give anything but must
/// stay in bounds and notice.
void PointwiseDecoderTest::damagedChunks()
{
    QFETCH(int, format);
    const auto f = std::uint8_t(format);
    const auto length = std::uint16_t(standardRecordLength(f) + 3);
    const LazInfo info = LazInfo::standard(f, length);
    constexpr std::size_t kCount = 500;
    const Bytes sound = encodeChunk(info, RecordSource(f, length, 7).make(kCount), punctum::Progress());
    std::mt19937 random(unsigned(format) + 1);
    int unnoticed = 0;
    for (int round = 0; round < 400; ++round) {
        const Bytes chunk = damaged(sound, unsigned(round), random);
        const Decoded ours = decode(info, chunk, kCount, PointDecoder::Codec::Fastest);
        const Decoded theirs = decode(info, chunk, kCount, PointDecoder::Codec::Laszip);
        if (theirs.whole(kCount, length, chunk.size())) QVERIFY(ours.records == theirs.records);
        if (ours.whole(kCount, length, chunk.size())) {
            ++unnoticed;
            QVERIFY(ours.records == theirs.records);
        }
    }
    qInfo("%d of 400 damaged chunks look whole, to both", unnoticed);
}

void PointwiseDecoderTest::shortChunks()
{
    const LazInfo info = LazInfo::standard(3, 34);
    for (std::size_t size : {0, 1, 33}) {
        const Bytes chunk(size);
        PointDecoder decoder(info, chunk, 10);
        std::byte record[34];
        QCOMPARE(decoder.decode(1, record), std::size_t(0));
        QVERIFY(!decoder.error().empty());
    }
    const Bytes first(34);  // one record, and no compressed byte
    PointDecoder decoder(info, first, 10);
    std::byte records[340];
    QVERIFY(decoder.decode(10, records) < 10);
    QVERIFY(decoder.position() > first.size());
}

void PointwiseDecoderTest::whatIsSupported()
{
    QVERIFY(!PointwiseDecoder::supports(LazInfo::standard(6, standardRecordLength(6))));  // layered
    LazInfo old = LazInfo::standard(1, standardRecordLength(1));
    old.items[1].version = 1;
    QVERIFY(!PointwiseDecoder::supports(old));
}

QTEST_GUILESS_MAIN(PointwiseDecoderTest)
#include "PointwiseDecoderTest.moc"
