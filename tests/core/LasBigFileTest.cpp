// SPDX-License-Identifier: MIT
#include "core/Error.h"
#include "core/las/AtomicFile.h"
#include "core/las/ChunkTable.h"
#include "core/las/Reader.h"
#include "core/las/WritePlan.h"
#include "core/task/Progress.h"
#include "tests/core/LasFiles.h"

#include <QTemporaryDir>
#include <QTest>

#include <atomic>

using namespace punctum;
using lasfiles::Bytes;
namespace fs = std::filesystem;

/// Files of more than 4 GiB and more than 2^32 points, most of them holes that take no room on the disk. Only some
/// of their points are read: the readers go through a file in an order that visits everywhere early.
class LasBigFileTest : public QObject
{
    Q_OBJECT

private slots:
    void pointsBeyond32Bits();
    void extendedRecordsBeyond4GiB_data();
    void extendedRecordsBeyond4GiB();
    void chunksBeyond4GiB_data();
    void chunksBeyond4GiB();
    void manyPointsNeedLas14();
    void writesBeyond4GiB();

private:
    /// A file of `head`, holes and `parts` at their places; false when this file system has no such files.
    bool make(const std::string& name, const Bytes& head, const std::vector<std::pair<std::uint64_t, Bytes>>& parts,
              std::uint64_t size)
    {
        m_path = fs::path(m_dir.path().toStdString()) / name;
        lasfiles::writeFile(m_path, head);
        std::error_code ec;
        fs::resize_file(m_path, size, ec);
        if (ec) return false;
        std::fstream file(m_path, std::ios::binary | std::ios::in | std::ios::out);
        for (const auto& [at, bytes] : parts) {
            file.seekp(std::streamoff(at));
            file.write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
        }
        return bool(file.flush());
    }
    void cleanup() { fs::remove(m_path); }

    fs::path m_path;
    QTemporaryDir m_dir;
};

namespace
{

constexpr const char* kNoSuchFiles = "this file system has no files of that size";
constexpr std::uint64_t kFourGiB = std::uint64_t(1) << 32;

/// Ends a reading that has seen enough.
struct Enough {
};

Bytes header14(std::uint8_t format, std::uint64_t points)
{
    Bytes head = lasfiles::header(4, format, lasfiles::recordLength(format & 0x3F), points);
    lasfiles::set<std::uint16_t>(head, 6, 16);
    lasfiles::set<std::uint32_t>(head, 107, 0);
    return head;
}

/// The points at the end are holes, which read as zeros; that is the one thing to say of these files.
bool holesAloneAreTold(const las::SourceFile& source)
{
    return !source.recovered && source.warnings.size() == 1 &&
           source.warnings[0].find("nothing but zero bytes") != std::string::npos;
}

}  // namespace

void LasBigFileTest::pointsBeyond32Bits()
{
    const PointIndex count = 4'400'000'000, marked = kFourGiB + 5;  // in the block that is read second
    const Bytes head = header14(6, count);
    const Bytes record = lasfiles::randomRecords(6, 30, 1, 1);
    if (!make("points.las", head, {{head.size() + marked * 30, record}}, head.size() + count * 30))
        QSKIP(kNoSuchFiles);
    const auto reader = las::Reader::open(m_path);
    QCOMPARE(reader->source()->pointCount, count);
    QVERIFY(holesAloneAreTold(*reader->source()));
    QVERIFY(!reader->source()->firstBounds.empty());

    std::atomic<bool> found = false, others = false;
    Progress progress;
    const auto look = [&](PointRange r, std::span<const std::byte> bytes) {
        QCOMPARE(std::uint64_t(bytes.size()), r.size() * 30);
        for (PointIndex i = r.first; i < r.last; ++i) {
            const std::byte* p = bytes.data() + (i - r.first) * 30;
            const bool empty = std::all_of(p, p + 30, [](std::byte b) { return b == std::byte(0); });
            if (i == marked)
                found = std::equal(record.begin(), record.end(), p);
            else if (!empty)
                others = true;
        }
        if (found) throw Enough();
    };
    QVERIFY_EXCEPTION_THROWN(reader->visitRecords(progress, look), Enough);
    QVERIFY(found && !others);
}

void LasBigFileTest::extendedRecordsBeyond4GiB_data()
{
    QTest::addColumn<bool>("wrapped");
    QTest::newRow("as it should be") << false;
    QTest::newRow("position cut to 32 bits") << true;  // some programs write it so
}

void LasBigFileTest::extendedRecordsBeyond4GiB()
{
    QFETCH(bool, wrapped);
    const PointIndex count = 200'000'000;
    Bytes head = header14(6, count);
    const std::uint64_t end = head.size() + count * 30;
    QVERIFY(end > kFourGiB);
    lasfiles::set<std::uint64_t>(head, 235, wrapped ? end & 0xFFFFFFFFu : end);
    lasfiles::set<std::uint32_t>(head, 243, 1);
    const Bytes evlr = lasfiles::record("late", 7, lasfiles::randomRecords(0, 1000, 1, 2), true);
    if (!make("evlr.las", head, {{end, evlr}}, end + evlr.size())) QSKIP(kNoSuchFiles);
    const auto source = las::Reader::open(m_path)->source();
    QCOMPARE(source->pointCount, count);
    QCOMPARE(source->pointDataEnd, end);
    QVERIFY(holesAloneAreTold(*source));
    QCOMPARE(source->evlrs.size(), std::size_t(1));
    QVERIFY(std::equal(source->evlrs[0].data.begin(), source->evlrs[0].data.end(), evlr.begin() + 60, evlr.end()));
}

void LasBigFileTest::chunksBeyond4GiB_data()
{
    QTest::addColumn<int>("format");
    QTest::newRow("chunked") << 3;
    QTest::newRow("layered") << 7;
}

void LasBigFileTest::chunksBeyond4GiB()
{
    QFETCH(int, format);
    // 64 chunks of 100 MiB, all holes but number 48, the fourth that is read, and 63, whose place is known by sums
    // of more than 32 bits; the table is behind them.
    constexpr std::size_t kChunks = 64, kMiddle = 48, kLast = 63;
    constexpr std::uint64_t kHole = std::uint64_t(100) << 20;
    constexpr std::uint32_t kCount = 500;
    const auto f = std::uint8_t(format);
    const auto length = lasfiles::recordLength(f);
    const Bytes points = lasfiles::randomRecords(f, length, kCount, 1, true);
    Bytes vlr;
    Bytes chunk = lasfiles::compressedByLaszip(f, length, points, kCount, &vlr);
    const auto end = std::size_t(lasfiles::get<std::int64_t>(chunk, 0));
    chunk = Bytes(chunk.begin() + 8, chunk.begin() + std::ptrdiff_t(end));
    lasfiles::set(vlr, 54 + 12, las::kVariableChunks);

    Bytes head = f < 6 ? lasfiles::header(2, std::uint8_t(f | 0x80), length, kChunks * kCount)
                       : header14(std::uint8_t(f | 0x80), kChunks * kCount);
    lasfiles::set<std::uint16_t>(head, 105, length);
    if (f < 6) lasfiles::set<std::uint32_t>(head, 107, std::uint32_t(kChunks * kCount));
    head = lasfiles::file(head, {vlr}, Bytes(8));
    std::vector<las::ChunkEntry> entries;
    std::vector<std::pair<std::uint64_t, Bytes>> parts;
    std::uint64_t at = head.size();
    for (std::size_t k = 0; k < kChunks; ++k) {
        const bool real = k == kMiddle || k == kLast;
        if (real) parts.emplace_back(at, chunk);
        entries.push_back({kCount, real ? std::uint32_t(chunk.size()) : std::uint32_t(kHole)});
        at += entries.back().bytes;
    }
    QVERIFY(at > kFourGiB);
    lasfiles::set<std::int64_t>(head, head.size() - 8, std::int64_t(at));
    const Bytes table = las::encodeChunkTable(entries, true);
    parts.emplace_back(at, table);
    if (!make("chunks.laz", head, parts, at + table.size())) QSKIP(kNoSuchFiles);

    const auto reader = las::Reader::open(m_path);
    QCOMPARE(reader->source()->pointCount, PointIndex(kChunks * kCount));
    QVERIFY2(reader->source()->warnings.empty() && !reader->source()->recovered,
             reader->source()->warnings.empty() ? "" : reader->source()->warnings[0].c_str());
    Bytes got(kCount * length);
    Progress progress;
    const auto look = [&](PointRange r, std::span<const std::byte> bytes) {
        if (r.first < kMiddle * kCount || r.last > (kMiddle + 1) * kCount) return;
        std::memcpy(got.data() + (r.first - kMiddle * kCount) * length, bytes.data(), bytes.size());
        if (r.last == (kMiddle + 1) * kCount) throw Enough();
    };
    QVERIFY_EXCEPTION_THROWN(reader->visitRecords(progress, look), Enough);
    QVERIFY(got == points);
}

void LasBigFileTest::manyPointsNeedLas14()
{
    // Memory is taken as it is touched: this cloud takes none.
    const PointIndex count = kFourGiB + 10;
    std::shared_ptr<PointCloud> cloud;
    try {
        const auto source = las::makeSource(0, {}, {}, {}, count);
        cloud = std::make_shared<PointCloud>(count, CoordinateScale{});
        las::makeColumns(*cloud, source->layout);
        cloud->setSource(source);
    } catch (const Error&) {
        QSKIP("this system gives no memory that is not there");
    }
    Progress progress;
    las::WriteOptions options;
    options.versionMinor = 3;
    try {
        las::planWrite(*cloud, "many.las", options, progress);
        QFAIL("it was planned");
    } catch (const Error& e) {
        QVERIFY2(std::string(e.what()).find("4,294,967,306 points need LAS 1.4") != std::string::npos, e.what());
    }
}

void LasBigFileTest::writesBeyond4GiB()
{
    m_path = fs::path(m_dir.path().toStdString()) / "written.las";
    las::AtomicFile file(m_path);
    const Bytes bytes = lasfiles::randomRecords(0, 20, 5, 3);
    try {
        file.writeAt(kFourGiB + 7, bytes);
    } catch (const Error&) {
        QSKIP(kNoSuchFiles);
    }
    file.sync();
    file.commit();
    QCOMPARE(std::uint64_t(fs::file_size(m_path)), kFourGiB + 7 + bytes.size());
    std::ifstream in(m_path, std::ios::binary);
    in.seekg(std::streamoff(kFourGiB + 7));
    Bytes back(bytes.size());
    in.read(reinterpret_cast<char*>(back.data()), std::streamsize(back.size()));
    QVERIFY(back == bytes);
}

QTEST_GUILESS_MAIN(LasBigFileTest)
#include "LasBigFileTest.moc"
