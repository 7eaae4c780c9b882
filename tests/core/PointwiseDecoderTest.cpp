// SPDX-License-Identifier: MIT
#include "core/las/ChunkCodec.h"
#include "core/las/File.h"
#include "core/las/PointwiseDecoder.h"
#include "core/las/SourceParser.h"
#include "core/task/Progress.h"

#include <QTest>

#include <cstring>
#include <filesystem>
#include <random>

using namespace punctum::las;
namespace fs = std::filesystem;
using Bytes = std::vector<std::byte>;

/// Our own decoder of pointwise chunks against LASzip: the same records, the same end, on real files, on records
/// that reach every branch of the predictors, and on damaged chunks.
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

private:
    struct Decoded {
        Bytes records;  ///< of the points that could be decoded
        std::uint64_t position = 0;
    };
    static Decoded decode(const LazInfo& info, std::span<const std::byte> chunk, std::size_t count,
                          PointDecoder::Codec codec)
    {
        PointDecoder decoder(info, chunk, count, codec);
        Decoded d;
        d.records.resize(count * info.recordLength);
        // in uneven pieces, as readers do
        std::size_t done = 0;
        for (std::size_t step = 1; done < count; step = step * 2 + 1) {
            const std::size_t want = std::min(step, count - done);
            const std::size_t got = decoder.decode(want, d.records.data() + done * info.recordLength);
            done += got;
            if (got < want) break;
        }
        d.records.resize(done * info.recordLength);
        d.position = decoder.position();
        return d;
    }
    /// Records whose fields change now and then, a little, a lot, or to what they were, in all combinations.
    static Bytes makeRecords(std::uint8_t format, std::uint16_t length, std::size_t count, unsigned seed);
};

Bytes PointwiseDecoderTest::makeRecords(std::uint8_t format, std::uint16_t length, std::size_t count, unsigned seed)
{
    std::mt19937_64 random(seed);
    const auto below = [&](std::uint64_t n) { return random() % n; };
    Bytes all(count * length), record(length);
    for (auto& b : record) b = std::byte(random());
    // some parts of a chunk are quiet, some are noise
    double activity = 0.5;
    std::int64_t timeStep[4] = {1000, -37, 5, 70000};
    std::uint64_t times[4] = {random(), random(), 12345, 0};
    std::size_t sequence = 0;
    const bool gps = punctum::las::hasGpsTime(format), rgb = punctum::las::hasColor(format);
    const std::size_t colorAt = 20 + (gps ? 8 : 0), waveAt = colorAt + (rgb ? 6 : 0),
                      extraAt = waveAt + (punctum::las::hasWaveform(format) ? 29 : 0);
    for (std::size_t i = 0; i < count; ++i) {
        if (below(200) == 0) activity = double(below(101)) / 100;
        const auto changes = [&] { return double(below(1000)) < 1000 * activity; };
        for (std::size_t a = 0; a < 3; ++a) {
            std::int32_t v;
            std::memcpy(&v, record.data() + 4 * a, 4);
            const unsigned bits = unsigned(below(changes() ? 33 : 6));
            const std::uint64_t size = bits == 0 ? 1 : std::uint64_t(1) << bits;
            v = std::int32_t(std::uint32_t(v) + std::uint32_t(below(size)) - std::uint32_t(size / 2));
            std::memcpy(record.data() + 4 * a, &v, 4);
        }
        if (changes()) record[12] = std::byte(random());
        if (below(9) == 0) record[13] = std::byte(random());
        for (std::size_t at = 14; at < 20; ++at)
            if (changes() && below(4) == 0) record[at] = std::byte(below(3) == 0 ? random() : random() % 3);
        if (gps) {
            if (below(6) == 0) sequence = below(4);
            std::uint64_t& t = times[sequence];
            switch (below(40)) {
                case 0:
                    t = random();
                    break;
                case 1:
                    t += random() % 0x100000000u;
                    break;
                case 2:
                    timeStep[sequence] = std::int64_t(below(2000)) - 1000;
                    break;
                case 3:
                    break;  // the same again
                case 4:
                    t -= std::uint64_t(timeStep[sequence] * std::int64_t(below(15)));
                    break;
                case 5:
                    t += std::uint64_t(timeStep[sequence] * std::int64_t(below(700)) + std::int64_t(below(9)));
                    break;
                default:
                    t += std::uint64_t(timeStep[sequence] + (changes() ? std::int64_t(below(7)) - 3 : 0));
            }
            std::memcpy(record.data() + 20, &t, 8);
        }
        if (rgb && changes()) {
            const bool grey = below(3) == 0;
            for (std::size_t k = 0; k < 6; ++k)
                if (below(3) != 0) record[colorAt + k] = std::byte(random());
            if (grey)
                for (std::size_t k = 2; k < 6; ++k) record[colorAt + k] = record[colorAt + k % 2];
        }
        if (extraAt > waveAt) {
            std::uint64_t offset;
            std::uint32_t size;
            std::memcpy(&offset, record.data() + waveAt + 1, 8);
            std::memcpy(&size, record.data() + waveAt + 9, 4);
            switch (below(5)) {
                case 0:
                    offset += size;
                    break;
                case 1:
                    offset += below(5000);
                    break;
                case 2:
                    offset = changes() ? random() : offset - below(100);
                    break;
                default:
                    break;
            }
            if (changes()) size = std::uint32_t(below(4) == 0 ? random() : 512);
            std::memcpy(record.data() + waveAt + 1, &offset, 8);
            std::memcpy(record.data() + waveAt + 9, &size, 4);
            if (below(50) == 0) record[waveAt] = std::byte(below(4));
            for (std::size_t at = waveAt + 13; at < extraAt; ++at)
                if (changes() && below(4) == 0) record[at] = std::byte(random());
        }
        for (std::size_t at = extraAt; at < length; ++at)
            if (changes()) record[at] = std::byte(random());
        std::memcpy(all.data() + i * length, record.data(), length);
    }
    return all;
}

void PointwiseDecoderTest::realChunks()
{
    const fs::path folder(PUNCTUM_TEST_DATA);
    if (!fs::is_directory(folder)) QSKIP("The folder of real files is not here.");
    std::size_t chunks = 0;
    for (const auto& entry : fs::directory_iterator(folder)) {
        if (entry.path().extension() != ".laz" || entry.path().filename().string().starts_with("broken_")) continue;
        const File file(entry.path());
        const ParsedFile parsed = parseFile(file);
        if (!PointwiseDecoder::supports(parsed.laz)) continue;
        for (const Chunk& chunk : parsed.chunks) {
            Bytes data(chunk.bytes);
            file.readAt(chunk.offset, data);
            const Decoded ours = decode(parsed.laz, data, chunk.count, PointDecoder::Codec::Fastest);
            const Decoded theirs = decode(parsed.laz, data, chunk.count, PointDecoder::Codec::Laszip);
            QVERIFY2(ours.records == theirs.records, entry.path().c_str());
            QCOMPARE(ours.position, chunk.bytes);
            QCOMPARE(theirs.position, chunk.bytes);
            ++chunks;
        }
    }
    qInfo("%zu chunks of real files", chunks);
    QVERIFY(chunks > 0);
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
        const Bytes records = makeRecords(f, length, count, unsigned(format * 100 + extra) + unsigned(count));
        const Bytes chunk = encodeChunk(info, records, punctum::Progress());
        const Decoded ours = decode(info, chunk, count, PointDecoder::Codec::Fastest);
        QVERIFY(ours.records == records);
        QCOMPARE(ours.position, std::uint64_t(chunk.size()));
        // and again from a decoder that has another chunk behind it
        PointDecoder again(info, chunk, count);
        Bytes into(records.size());
        QCOMPARE(again.decode(count / 2, into.data()), count / 2);
        again.restart(chunk);
        QCOMPARE(again.decode(count, into.data()), count);
        QVERIFY(into == records);
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
    const Bytes sound = encodeChunk(info, makeRecords(f, length, kCount, 7), punctum::Progress());
    std::mt19937 random(unsigned(format) + 1);
    int unnoticed = 0;
    for (int round = 0; round < 400; ++round) {
        Bytes chunk = sound;
        const std::size_t at = random() % chunk.size();
        switch (round % 4) {
            case 0:
                chunk[at] ^= std::byte(1u << (random() % 8));
                break;
            case 1:
                for (std::size_t k = at; k < std::min(at + 16, chunk.size()); ++k) chunk[k] = std::byte(random());
                break;
            case 2:
                std::fill(chunk.begin() + std::ptrdiff_t(at), chunk.end(), std::byte(random() % 2 == 0 ? 0 : 0xFF));
                break;
            default:
                chunk.resize(at);
        }
        const Decoded ours = decode(info, chunk, kCount, PointDecoder::Codec::Fastest);
        const Decoded theirs = decode(info, chunk, kCount, PointDecoder::Codec::Laszip);
        const auto whole = [&](const Decoded& d) {
            return d.records.size() == kCount * length && d.position == chunk.size();
        };
        if (whole(theirs)) QVERIFY(ours.records == theirs.records);
        if (whole(ours)) {
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
