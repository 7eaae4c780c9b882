// SPDX-License-Identifier: MIT
#include "core/Error.h"
#include "core/las/ChunkTable.h"
#include "core/las/File.h"
#include "core/las/Reader.h"
#include "core/las/SourceParser.h"
#include "core/task/Progress.h"
#include "tests/core/LasFiles.h"
#include "tests/core/ReadRecords.h"

#include <QTemporaryDir>
#include <QTest>

using namespace punctum;
using namespace punctum::las;
using lasfiles::Bytes;
using lasfiles::recordsByUs;
namespace fs = std::filesystem;

/// The table of compressed chunks: the same bytes as LASzip's, and rebuilt when it is lost.
class LasChunkTableTest : public QObject
{
    Q_OBJECT

private slots:
    void writtenTablesAreRead_data();
    void writtenTablesAreRead();
    void bytesAreLaszips();
    void garbageIsRefusedOrRead();
    void lostTableIsRebuilt_data();
    void lostTableIsRebuilt();
    void positionAtTheEndOfTheFile();
    void noPointsNeedNoTable();
    void tablesThatWeWouldWriteOtherwise();
    void variableChunks_data();
    void variableChunks();
    void cutFileGivesWhatIsThere_data();
    void cutFileGivesWhatIsThere();
    void realTablesMatch();

private:
    fs::path make(const std::string& name, const Bytes& bytes) const
    {
        const fs::path path = fs::path(m_dir.path().toStdString()) / name;
        lasfiles::writeFile(path, bytes);
        return path;
    }
    static std::size_t pointOffset(const Bytes& file) { return lasfiles::get<std::uint32_t>(file, 96); }
    /// The same chunks with a table of variable chunks, and chunk size 0 or 2^32-1 in the laszip record.
    static Bytes withVariableChunks(std::uint8_t format, std::uint16_t length, const Bytes& points,
                                    const std::vector<std::size_t>& counts, std::uint32_t chunkSize);

    QTemporaryDir m_dir;
};

Bytes LasChunkTableTest::withVariableChunks(std::uint8_t format, std::uint16_t length, const Bytes& points,
                                            const std::vector<std::size_t>& counts, std::uint32_t chunkSize)
{
    Bytes vlr, chunks(8);
    std::vector<ChunkEntry> entries;
    std::size_t at = 0;
    for (const std::size_t n : counts) {
        const Bytes part(points.begin() + std::ptrdiff_t(at * length),
                         points.begin() + std::ptrdiff_t((at + n) * length));
        const Bytes one = lasfiles::compressedByLaszip(format, length, part, 1000000, &vlr);
        const auto end = std::size_t(lasfiles::get<std::int64_t>(one, 0));
        chunks.insert(chunks.end(), one.begin() + 8, one.begin() + std::ptrdiff_t(end));
        entries.push_back({std::uint32_t(n), std::uint32_t(end - 8)});
        at += n;
    }
    lasfiles::set(vlr, 54 + 12, chunkSize);
    Bytes head = lasfiles::header(lasfiles::minorFor(format), std::uint8_t(format | 0x80), length, at);
    lasfiles::set<std::uint32_t>(head, 107, format < 6 ? std::uint32_t(at) : 0);
    lasfiles::set<std::int64_t>(chunks, 0, std::int64_t(head.size() + vlr.size() + chunks.size()));
    const auto table = encodeChunkTable(entries, true);
    lasfiles::append(chunks, table);
    return lasfiles::file(head, {vlr}, chunks);
}

void LasChunkTableTest::writtenTablesAreRead_data()
{
    QTest::addColumn<int>("entries");
    QTest::addColumn<bool>("variable");
    QTest::addColumn<int>("kind");
    for (const int n : {0, 1, 2, 7, 1000, 20000})
        for (const bool variable : {false, true})
            for (int kind = 0; kind < 3; ++kind)
                QTest::addRow("%d entries, %s, kind %d", n, variable ? "variable" : "fixed", kind)
                    << n << variable << kind;
}

void LasChunkTableTest::writtenTablesAreRead()
{
    QFETCH(int, entries);
    QFETCH(bool, variable);
    QFETCH(int, kind);
    std::mt19937 random(std::uint32_t(entries + kind));
    std::vector<ChunkEntry> table;
    for (int k = 0; k < entries; ++k) {
        ChunkEntry e{variable ? std::uint32_t(1 + random() % 70000) : 0u, 0};
        if (kind == 0) e.bytes = std::uint32_t(200000 + random() % 5000);  // as in real files
        if (kind == 1) e.bytes = std::uint32_t(random());                  // differences of up to 32 bits
        if (kind == 2) e.bytes = k % 2 == 0 ? 0 : 0x80000000u;             // the one difference of exactly 2^31
        table.push_back(e);
    }
    const auto bytes = encodeChunkTable(table, variable);
    const auto back = decodeChunkTable(bytes, variable, std::uint64_t(entries));
    QVERIFY(back.has_value());
    QVERIFY(*back == table);
    if (entries > 1) {
        QVERIFY(!decodeChunkTable(bytes, variable, std::uint64_t(entries - 1)).has_value());
        QVERIFY(!decodeChunkTable(std::span(bytes).first(9), variable, std::uint64_t(entries)).has_value());
    }
}

void LasChunkTableTest::bytesAreLaszips()
{
    for (const std::uint8_t format : {0, 3, 6, 8}) {
        const auto length = lasfiles::recordLength(format);
        const Bytes points = lasfiles::randomRecords(format, length, 4001, format, true);
        const Bytes laz = lasfiles::compressedByLaszip(format, length, points, 10);
        const auto tableAt = std::size_t(lasfiles::get<std::int64_t>(laz, 0));
        const Bytes stored(laz.begin() + std::ptrdiff_t(tableAt), laz.end());
        const auto entries = decodeChunkTable(stored, false, 100000);
        QVERIFY(entries.has_value());
        QCOMPARE(entries->size(), std::size_t(401));
        std::size_t sum = 8;
        for (const ChunkEntry& e : *entries) sum += e.bytes;
        QCOMPARE(sum, tableAt);
        QVERIFY(encodeChunkTable(*entries, false) == stored);
    }
}

void LasChunkTableTest::garbageIsRefusedOrRead()
{
    std::mt19937 random(1);
    for (int round = 0; round < 2000; ++round) {
        Bytes bytes(8 + random() % 200);
        for (std::byte& b : bytes) b = std::byte(random() & 0xFF);
        if (round % 2 == 0) lasfiles::set<std::uint32_t>(bytes, 0, 0);
        if (round % 4 == 0) lasfiles::set<std::uint32_t>(bytes, 4, std::uint32_t(random() % 300));
        const auto entries = decodeChunkTable(bytes, round % 3 == 0, 1000);
        if (entries) QVERIFY(entries->size() <= 1000);
    }
    Bytes most(64);
    lasfiles::set<std::uint32_t>(most, 4, 0xFFFFFFFFu);
    QVERIFY(!decodeChunkTable(most, true, 1000).has_value());
}

void LasChunkTableTest::lostTableIsRebuilt_data()
{
    QTest::addColumn<int>("format");
    QTest::addColumn<QString>("damage");
    for (const int format : {1, 3, 6, 7, 10})
        for (const char* damage : {"pointer 0", "pointer own", "pointer negative", "pointer beyond", "pointer -1",
                                   "pointer into a chunk", "version", "count", "huge count", "bytes"})
            QTest::addRow("format %d, %s", format, damage) << format << QString(damage);
}

void LasChunkTableTest::lostTableIsRebuilt()
{
    QFETCH(int, format);
    QFETCH(QString, damage);
    const auto f = std::uint8_t(format);
    const auto length = lasfiles::recordLength(f);
    const Bytes points = lasfiles::randomRecords(f, length, 1065, 5, true);
    Bytes laz = lasfiles::lazFile(f, length, points, 100);
    const std::size_t at = pointOffset(laz);
    const auto table = std::size_t(lasfiles::get<std::int64_t>(laz, at));
    const auto point = [&](std::int64_t to) { lasfiles::set(laz, at, to); };
    if (damage == "pointer 0") point(0);
    if (damage == "pointer own") point(std::int64_t(at));
    if (damage == "pointer negative") point(-12345);
    if (damage == "pointer beyond") point(1LL << 40);
    if (damage == "pointer -1") point(-1);
    if (damage == "pointer into a chunk") point(std::int64_t(at) + 300);
    if (damage == "version") lasfiles::set<std::uint32_t>(laz, table, 7);
    if (damage == "count") lasfiles::set<std::uint32_t>(laz, table + 4, 3);
    if (damage == "huge count") lasfiles::set<std::uint32_t>(laz, table + 4, 0xFFFFFFFFu);
    if (damage == "bytes") laz[table + 9] ^= std::byte(0x55);
    const fs::path path = make("lost.laz", laz);
    QVERIFY(recordsByUs(path) == points);
    const auto source = Reader::open(path)->source();
    const auto& warnings = source->warnings;
    QVERIFY(std::any_of(warnings.begin(), warnings.end(),
                        [](const std::string& w) { return w.find("rebuilt") != std::string::npos; }));
}

void LasChunkTableTest::positionAtTheEndOfTheFile()
{
    // what LASzip writes to a stream that cannot go back: -1, and the position after the table
    const Bytes points = lasfiles::randomRecords(3, 34, 500, 5, true);
    Bytes laz = lasfiles::lazFile(3, 34, points, 100);
    const std::size_t at = pointOffset(laz);
    const auto table = lasfiles::get<std::int64_t>(laz, at);
    lasfiles::set<std::int64_t>(laz, at, -1);
    Bytes position(8);
    lasfiles::set(position, 0, table);
    lasfiles::append(laz, position);
    const fs::path path = make("stream.laz", laz);
    QVERIFY(recordsByUs(path) == points);
    QVERIFY(Reader::open(path)->source()->warnings.empty());
}

void LasChunkTableTest::noPointsNeedNoTable()
{
    Bytes laz = lasfiles::lazFile(3, 34, {}, 100);
    laz.resize(pointOffset(laz));
    const auto source = Reader::open(make("none.laz", laz))->source();
    QVERIFY(source->pointCount == 0 && source->warnings.empty());
    lasfiles::set(laz, 107, 5u);
    QVERIFY_EXCEPTION_THROWN(Reader::open(make("none.laz", laz)), Error);
}

void LasChunkTableTest::tablesThatWeWouldWriteOtherwise()
{
    // Other last bytes of the coder may say the same; where such a table ends is not known, so the file's rest is
    // its.
    const Bytes points = lasfiles::randomRecords(3, 34, 500, 5, true);
    const Bytes laz = lasfiles::lazFile(3, 34, points, 100);
    int others = 0;
    for (int value = 0; value < 256; ++value) {
        Bytes b = laz;
        b.back() = std::byte(value);
        lasfiles::append(b, Bytes(3, std::byte('t')));
        const fs::path path = make("other.laz", b);
        const auto source = Reader::open(path)->source();
        QVERIFY(recordsByUs(path) == points && !source->recovered);
        if (!source->warnings.empty()) continue;
        QCOMPARE(source->tail.empty(), b[laz.size() - 1] != laz.back());
        others += source->tail.empty() ? 1 : 0;
    }
    QVERIFY(others > 0);
}

void LasChunkTableTest::variableChunks_data()
{
    QTest::addColumn<int>("format");
    QTest::addColumn<QString>("chunkSize");
    QTest::addColumn<bool>("lost");
    for (const int format : {3, 7})
        for (const char* size : {"0", "4294967295"})
            for (const bool lost : {false, true})
                QTest::addRow("format %d, size %s, %s", format, size, lost ? "no table" : "table")
                    << format << QString(size) << lost;
}

void LasChunkTableTest::variableChunks()
{
    QFETCH(int, format);
    QFETCH(QString, chunkSize);
    QFETCH(bool, lost);
    const auto f = std::uint8_t(format);
    const auto length = lasfiles::recordLength(f);
    const std::vector<std::size_t> counts = {500, 3, 1, 300, 70000, 29};
    const Bytes points = lasfiles::randomRecords(f, length, 70833, 6, true);
    Bytes laz = withVariableChunks(f, length, points, counts, chunkSize.toUInt());
    if (lost) lasfiles::set<std::int64_t>(laz, pointOffset(laz), 0);
    const fs::path path = make("variable.laz", laz);
    if (lost && format < 6) {
        QVERIFY_EXCEPTION_THROWN(Reader::open(path), Error);
        return;
    }
    QVERIFY(recordsByUs(path) == points);
    if (chunkSize != "0")
        QVERIFY(lasfiles::recordsByLaszip(
                    make("v.laz", withVariableChunks(f, length, points, counts, chunkSize.toUInt())), f, length,
                    70833) == points);

    // the header's count is wrong, the table right
    lasfiles::set<std::uint32_t>(laz, 107, f < 6 ? 70000 : 0);
    if (f >= 6) lasfiles::set<std::uint64_t>(laz, 247, 70000);
    const fs::path wrong = make("wrong.laz", laz);
    if (!lost) QVERIFY(recordsByUs(wrong) == points);
}

void LasChunkTableTest::cutFileGivesWhatIsThere_data()
{
    QTest::addColumn<int>("format");
    for (const int format : {1, 3, 6, 8}) QTest::addRow("format %d", format) << format;
}

void LasChunkTableTest::cutFileGivesWhatIsThere()
{
    QFETCH(int, format);
    const auto f = std::uint8_t(format);
    const auto length = lasfiles::recordLength(f);
    const Bytes points = lasfiles::randomRecords(f, length, 2000, 5, true);
    Bytes laz = lasfiles::lazFile(f, length, points, 300);
    laz.resize(laz.size() / 2);
    const fs::path path = make("cut.laz", laz);
    const auto source = Reader::open(path)->source();
    QVERIFY(source->recovered);
    QVERIFY(source->pointCount > 600 && source->pointCount < 1400);
    if (format >= 6) QCOMPARE(source->pointCount % 300, PointIndex(0));
    const Bytes got = recordsByUs(path);
    // the very last points before a cut may be made of bytes that are not there
    const std::size_t sure = got.size() - (format < 6 ? 2u * length : 0u);
    QVERIFY(std::equal(got.begin(), got.begin() + std::ptrdiff_t(sure), points.begin()));
}

void LasChunkTableTest::realTablesMatch()
{
    const auto files = lasfiles::sharedFiles(PUNCTUM_TEST_DATA);
    if (files.empty()) QSKIP("the shared test data is not here");
    for (const fs::path& path : files) {
        if (path.extension() != ".laz") continue;
        const File file(path);
        const ParsedFile parsed = parseFile(file);
        const Bytes bytes = lasfiles::readFile(path);
        std::vector<ChunkEntry> entries;
        const bool variable = parsed.laz.variable();
        for (const Chunk& c : parsed.chunks)
            entries.push_back({variable ? std::uint32_t(c.count) : 0, std::uint32_t(c.bytes)});
        const auto table = encodeChunkTable(entries, variable);
        const auto at = std::size_t(lasfiles::get<std::int64_t>(bytes, pointOffset(bytes)));
        QVERIFY2(at + table.size() <= bytes.size() &&
                     std::equal(table.begin(), table.end(), bytes.begin() + std::ptrdiff_t(at)),
                 path.c_str());
    }
}

QTEST_GUILESS_MAIN(LasChunkTableTest)
#include "LasChunkTableTest.moc"
