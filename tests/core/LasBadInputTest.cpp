// SPDX-License-Identifier: MIT
#include "core/Error.h"
#include "core/las/Reader.h"
#include "core/las/Writer.h"
#include "core/task/Progress.h"
#include "tests/core/LasFiles.h"

#include <QTemporaryDir>
#include <QTest>

#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <functional>
#include <limits>

using namespace punctum;
using lasfiles::Bytes;
namespace fs = std::filesystem;

/// Files that are damaged or lie: each is refused with one sentence, or opened with a warning. The rows are those
/// of the catalogue in docs/dev/las.md. Worth most under the sanitizers.
class LasBadInputTest : public QObject
{
    Q_OBJECT

private slots:
    void refused_data();
    void refused();
    void opened_data();
    void opened();
    void notRegular();
    void everyByteOfTheHeaderMayLie();
    void mutatedChunksDoNoHarm_data();
    void mutatedChunksDoNoHarm();
    void cutAnywhere_data();
    void cutAnywhere();
    void sparseFileBeyond32Bits();

private:
    fs::path make(const std::string& name, const Bytes& bytes) const
    {
        const fs::path path = fs::path(m_dir.path().toStdString()) / name;
        lasfiles::writeFile(path, bytes);
        return path;
    }
    QTemporaryDir m_dir;
};

namespace
{

constexpr std::size_t kCount = 1065;

/// A sound LAS 1.2 file of format 3.
Bytes plain()
{
    return lasfiles::file(lasfiles::header(2, 3, 34, kCount), {}, lasfiles::randomRecords(3, 34, kCount, 1));
}
/// A sound LAS 1.4 file of format 6.
Bytes plain14()
{
    Bytes head = lasfiles::header(4, 6, 30, kCount);
    lasfiles::set<std::uint16_t>(head, 6, 16);
    return lasfiles::file(head, {}, lasfiles::randomRecords(6, 30, kCount, 1));
}
Bytes laz(std::uint8_t format, std::uint32_t chunk = 200, std::uint16_t extra = 0)
{
    const auto length = std::uint16_t(lasfiles::recordLength(format) + extra);
    Bytes b = lasfiles::lazFile(format, length, lasfiles::randomRecords(format, length, kCount, 1, true), chunk);
    if (format >= 6) lasfiles::set<std::uint16_t>(b, 6, 16);
    return b;
}
std::size_t pointOffset(const Bytes& b)
{
    return lasfiles::get<std::uint32_t>(b, 96);
}
/// Where the payload of the laszip record begins.
std::size_t laszipAt(const Bytes& b)
{
    return lasfiles::get<std::uint16_t>(b, 94) + 54u;
}

template <typename T>
Bytes with(Bytes b, std::size_t at, T value)
{
    lasfiles::set<T>(b, at, value);
    return b;
}

template <typename T>
Bytes withLaszip(Bytes b, std::size_t at, T value)
{
    return with<T>(b, laszipAt(b) + at, value);
}

/// Doubles in place of the extra bytes record's fields; `data` as its payload, 8 extra bytes.
Bytes withExtra(const Bytes& data)
{
    return lasfiles::file(lasfiles::header(2, 0, 28, 10), {lasfiles::record("LASF_Spec", 4, data)}, Bytes(280));
}

Bytes descriptor(int type, int options, const std::string& name = "x")
{
    Bytes d(192);
    d[2] = std::byte(type);
    d[3] = std::byte(options);
    std::memcpy(d.data() + 4, name.data(), std::min<std::size_t>(name.size(), 32));
    return d;
}

struct Opened {
    std::shared_ptr<const las::SourceFile> source;
    las::ReadResult result;
    std::shared_ptr<PointCloud> cloud;
};

Opened openAll(const fs::path& path)
{
    Opened o;
    const auto reader = las::Reader::open(path);
    o.source = reader->source();
    o.cloud = reader->createCloud();
    Progress progress;
    o.result = reader->read(*o.cloud, progress);
    return o;
}

}  // namespace

void LasBadInputTest::refused_data()
{
    QTest::addColumn<QByteArray>("bytes");
    QTest::addColumn<QString>("said");
    const auto row = [](const char* name, const Bytes& b, const char* said) {
        QTest::newRow(name) << QByteArray(reinterpret_cast<const char*>(b.data()), qsizetype(b.size()))
                            << QString(said);
    };
    Bytes cut = plain();
    row("1 empty", {}, "it has 0 bytes, and a header needs 227");
    cut.resize(100);
    row("2 100 bytes", cut, "it has 100 bytes");
    cut = plain();
    cut.resize(226);
    row("3 226 bytes", cut, "it has 226 bytes");
    row("4 LASX", with<char>(plain(), 3, 'X'), "signature is not LASF");
    row("4 a zip", with<std::uint32_t>(plain(), 0, 0x04034b50), "signature is not LASF");
    row("5 header size 0", with<std::uint16_t>(plain(), 94, 0), "header size 0 is less than 227");
    row("6 header size 226", with<std::uint16_t>(plain(), 94, 226), "header size 226 is less than 227");
    row("7 header size 65535", with<std::uint16_t>(plain(), 94, 65535), "header size 65535 is beyond");
    for (const std::uint32_t offset : {0u, 200u, 0x7FFFFFFFu, 0xFFFFFFFFu})
        row(("8-10 point offset " + std::to_string(offset)).c_str(), with(plain(), 96, offset),
            ("starts at " + std::to_string(offset) + ", outside the file").c_str());
    for (const std::uint8_t format : {11, 63, 127, 0xC3})
        row(("13 format " + std::to_string(format)).c_str(), with(plain(), 104, format), "is not supported");
    row("14 record length 0", with<std::uint16_t>(plain(), 105, 0), "0 bytes long, but point format 3 needs 34");
    row("15 record length 20", with<std::uint16_t>(plain(), 105, 20), "20 bytes long");
    row("20 version 2.0", with<std::uint16_t>(plain(), 24, 0x0002), "version 2.0 is not supported");
    row("20 version 1.9", with<std::uint8_t>(plain(), 25, 9), "version 1.9 is not supported");
    row("30 no laszip record", with<std::uint8_t>(plain(), 104, 0x83), "compression record is missing");
    row("31 no items", withLaszip<std::uint16_t>(laz(3), 32, 0), "does not fit");
    row("31 65535 items", withLaszip<std::uint16_t>(laz(3), 32, 65535), "too short");
    row("33 two byte items", withLaszip<std::uint16_t>(withLaszip<std::uint16_t>(laz(3), 40, 0), 42, 4),
        "does not fit");
    row("34 wrong order", withLaszip<std::uint16_t>(withLaszip<std::uint16_t>(laz(3), 40, 8), 46, 7),
        "does not fit");
    row("34 wrong size", withLaszip<std::uint16_t>(laz(3), 36, 24), "does not fit");
    row("34 item version 0", withLaszip<std::uint16_t>(laz(3), 38, 0), "unsupported version (0)");
    row("34 item version 9", withLaszip<std::uint16_t>(laz(7), 38, 9), "unsupported version (9)");
    row("35 compressor 9", withLaszip<std::uint16_t>(laz(3), 0, 9), "unsupported way (compressor 9");
    row("35 compressor 0", withLaszip<std::uint16_t>(laz(3), 0, 0), "unsupported way (compressor 0");
    row("35 coder 15", withLaszip<std::uint16_t>(laz(3), 2, 15), "coder 15");
    row("36 layered format 3", withLaszip<std::uint16_t>(laz(3), 0, 3), "unsupported compressor 3");
    row("36 chunked format 6", withLaszip<std::uint16_t>(laz(6), 0, 2), "unsupported compressor 2");
    {
        Bytes b = laz(3);
        lasfiles::set<std::uint16_t>(b, lasfiles::get<std::uint16_t>(b, 94) + 20u, 30);  // the record's own length
        row("32 short record", b, "");
        b = laz(3);
        b.resize(pointOffset(b) + 4);
        row("ends before the chunks", b, "ends before its points");
        b = laz(6);
        lasfiles::set<std::int64_t>(b, pointOffset(b), 0);
        lasfiles::set<std::uint32_t>(b, pointOffset(b) + 8 + 30, 0xFFFFFFFFu);
        row("44 first chunk without a sound head, no table", b, "not one can be read");
    }
    {
        Bytes b = withLaszip<std::uint32_t>(laz(3), 12, 0xFFFFFFFFu);
        lasfiles::set<std::int64_t>(b, pointOffset(b), 0);
        row("41 variable chunks, no table", b, "cannot be rebuilt");
    }
}

void LasBadInputTest::refused()
{
    QFETCH(QByteArray, bytes);
    QFETCH(QString, said);
    Bytes b(std::size_t(bytes.size()));
    if (!b.empty()) std::memcpy(b.data(), bytes.data(), b.size());
    const fs::path path = make("bad.las", b);
    try {
        openAll(path);
        QFAIL("it was opened");
    } catch (const Error& e) {
        const QString sentence = e.what();
        QVERIFY2(sentence.contains(said), e.what());
        QVERIFY2(sentence.startsWith("bad.las: ") && sentence.count("bad.las") == 1 && !sentence.contains('\n'),
                 e.what());
        QVERIFY2(sentence.endsWith('.') || sentence.endsWith(')'), e.what());
        QCOMPARE(e.file(), path);
    }
}

void LasBadInputTest::opened_data()
{
    QTest::addColumn<QByteArray>("bytes");
    QTest::addColumn<qulonglong>("points");
    QTest::addColumn<bool>("recovered");
    QTest::addColumn<QString>("warned");
    const auto row = [](const char* name, const Bytes& b, std::size_t points, bool recovered, const char* warned) {
        QTest::newRow(name) << QByteArray(reinterpret_cast<const char*>(b.data()), qsizetype(b.size()))
                            << qulonglong(points) << recovered << QString(warned);
    };
    const double inf = std::numeric_limits<double>::infinity(), nan = std::nan("");
    row("sound", plain(), kCount, false, "");
    row("sound 1.4", plain14(), kCount, false, "");
    row("sound LAZ", laz(3), kCount, false, "");
    row("sound layered LAZ", laz(7), kCount, false, "");
    row("11 VLR count", with<std::uint32_t>(plain(), 100, 0xFFFFFFFFu), kCount, false,
        "4294967295 variable length records");
    {
        Bytes b = lasfiles::file(lasfiles::header(2, 3, 34, kCount), {lasfiles::record("a", 1, Bytes(20))},
                                 lasfiles::randomRecords(3, 34, kCount, 1));
        row("12 VLR length", with<std::uint16_t>(b, 227 + 20, 60000), kCount, false,
            "1 variable length records are announced, 0");
    }
    row("16 record length 65535", with<std::uint16_t>(plain(), 105, 65535), 0, true, "the file holds 0");
    row("17 count 2^32-1", with<std::uint32_t>(plain(), 107, 0xFFFFFFFFu), kCount, true,
        "4294967295 points, the file holds 1065");
    row("18 count 2^63", with<std::uint64_t>(plain14(), 247, 1ull << 63), kCount, true, "the file holds 1065");
    row("19 two counts", with<std::uint32_t>(plain14(), 107, 5), kCount, false, "counts differ");
    row("20 version 1.5", with<std::uint8_t>(plain14(), 25, 5), kCount, false, "LAS 1.5");
    row("21 1.4 with a short header", with<std::uint8_t>(plain(), 25, 4), kCount, false, "should have 375");
    {
        Bytes b = plain();
        b.resize(b.size() - 50);
        row("22 cut in a record", b, kCount - 2, true, "the file holds 1063");
        b.resize(227);
        row("header only", b, 0, true, "the file holds 0");
    }
    for (const double scale : {0.0, nan, inf})
        row(("23-24 scale " + std::to_string(scale)).c_str(), with(plain(), 131, scale), kCount, false,
            "scale or offset of X");
    row("25 negative scale", with(plain(), 139, -0.01), kCount, false, "scale of Y is negative");
    row("26 offset 1e308", with(plain(), 155, 1e308), kCount, false, "scale or offset of X");
    row("27 box NaN", with(plain(), 179, nan), kCount, false, "");
    row("27 box upside down", with(plain(), 187, 1e9), kCount, false, "");
    row("27 box far", with(plain(), 179, 1e300), kCount, false, "");
    const auto evlr = [](std::uint64_t start, std::uint32_t count) {
        return with(with(plain14(), 235, start), 243, count);
    };
    row("28 EVLR at 2^40", evlr(1ull << 40, 1), kCount, true, "1 extended records");
    row("28 EVLR at 2^64-1", evlr(~0ull, 1), kCount, true, "1 extended records");
    row("28 EVLR before the points", evlr(100, 1), kCount, true, "1 extended records");
    row("29 EVLR among the points", evlr(375 + 300, 1), kCount, true, "begin inside the point data");
    {
        Bytes b = plain14();
        const std::size_t end = b.size();
        lasfiles::append(b, lasfiles::record("a", 1, Bytes(10), true));
        lasfiles::append(b, lasfiles::record("b", 2, Bytes(10), true));
        lasfiles::set<std::uint64_t>(b, 235, end);
        row("28 EVLR count 2^32-1", with<std::uint32_t>(b, 243, 0xFFFFFFFFu), kCount, true, "2 are found");
        lasfiles::set<std::uint32_t>(b, 243, 2);
        row("two EVLRs", b, kCount, false, "");
        row("28 EVLR length 2^64-1", with<std::uint64_t>(b, end + 70 + 20, ~0ull), kCount, true, "1 are found");
        row("28 EVLR length wraps", with<std::uint64_t>(b, end + 20, ~0ull - end - 59), kCount, true,
            "0 are found");
    }
    row("37 chunk size 1", withLaszip<std::uint32_t>(laz(3), 12, 1), kCount, false, "chunk size 1 is wrong");
    row("37 chunk size 1, layered", withLaszip<std::uint32_t>(laz(7), 12, 1), kCount, false, "rebuilt");
    row("37 chunk size 0, one chunk", withLaszip<std::uint32_t>(laz(7, 2000), 12, 0), kCount, false, "rebuilt");
    row("38 table pointer", with<std::int64_t>(laz(3), pointOffset(laz(3)), -5), kCount, false, "rebuilt");
    row(
        "39 table count",
        [] {
            Bytes b = laz(7);
            return with<std::uint32_t>(b, std::size_t(lasfiles::get<std::int64_t>(b, pointOffset(b))) + 4,
                                       0xFFFFFFFFu);
        }(),
        kCount, false, "rebuilt");
    row("46 count too large, chunked", with<std::uint32_t>(laz(3, 50000), 107, 5000), kCount, true,
        "5000 points, the file holds 1065");
    row("46 count too large, layered", with<std::uint64_t>(laz(6, 50000), 247, 5000), kCount, true,
        "5000 points, the file holds 1065");
    row("46 count too small, chunked", with<std::uint32_t>(laz(3, 50000), 107, 500), kCount, true,
        "500 points, the file holds 1065");
    row("46 count too small, layered", with<std::uint64_t>(laz(6, 50000), 247, 500), kCount, true,
        "500 points, the file holds 1065");
    row("46 count far too large", with<std::uint32_t>(laz(3), 107, 0xFFFFFFFFu), kCount, true,
        "the file holds 1065");
    row("50 no descriptors", withExtra({}), 10, false, "");
    row("50 100 bytes", withExtra(Bytes(100)), 10, false, "not a whole number");
    row("50 type 0 of no bytes", withExtra(descriptor(0, 0)), 10, false, "covers no bytes");
    row("50 type 200", withExtra(descriptor(200, 0)), 10, false, "reserved type 200");
    row("50 too long", withExtra(descriptor(0, 200)), 10, false, "beyond the end");
    {
        Bytes many;
        for (int k = 0; k < 340; ++k) lasfiles::append(many, descriptor(1, 0));
        row("50 340 descriptors", withExtra(many), 10, false, "beyond the end");
        row("50 name without NUL", withExtra(descriptor(10, 0, std::string(32, '\xFF'))), 10, false, "");
        row("50 NaN scale", withExtra(with(descriptor(10, 8), 112, nan)), 10, false, "cannot be used");
    }
    {
        Bytes b = plain();
        for (std::size_t i = 0; i < kCount; ++i)
            for (std::size_t a = 0; a < 3; ++a)
                lasfiles::set<std::int32_t>(b, 227 + i * 34 + 4 * a, a == 0 ? INT32_MIN : INT32_MAX);
        row("54 all equal", b, kCount, false, "");
        lasfiles::set<std::int32_t>(b, 227, INT32_MAX);
        row("54 extremes", b, kCount, false, "");
        row("54 one point", lasfiles::file(lasfiles::header(2, 0, 20, 1), {}, Bytes(20)), 1, false, "");
        row("no point", lasfiles::file(lasfiles::header(2, 0, 20, 0), {}, {}), 0, false, "");
    }
}

void LasBadInputTest::opened()
{
    QFETCH(QByteArray, bytes);
    QFETCH(qulonglong, points);
    QFETCH(bool, recovered);
    QFETCH(QString, warned);
    Bytes b(std::size_t(bytes.size()));
    std::memcpy(b.data(), bytes.data(), b.size());
    const Opened o = openAll(make("bad.laz", b));
    const auto& warnings = o.source->warnings;
    QString all;
    for (const std::string& w : warnings) all += QString::fromStdString(w) + "\n";
    if (points != 0 || !warned.isEmpty()) QCOMPARE(qulonglong(o.cloud->size()), points);
    QVERIFY2(o.source->recovered == recovered, all.toUtf8().constData());
    if (warned.isEmpty() && !recovered)
        QVERIFY2(all.isEmpty(), all.toUtf8().constData());
    else
        QVERIFY2(all.contains(warned), all.toUtf8().constData());
    for (const std::string& w : warnings) QVERIFY(w.ends_with('.') && w.find('\n') == std::string::npos);
    QVERIFY(o.result.bounds.empty() == (o.cloud->size() == 0) || !o.result.missing.empty());

    // What could be opened can be saved (under another name), and is sound then.
    Progress progress;
    const fs::path copy = fs::path(m_dir.path().toStdString()) / "copy.las";
    las::write(*o.cloud, copy, {}, progress);
    QCOMPARE(
        openAll(copy).source->pointCount, o.cloud->size() - [&] {
            PointIndex n = 0;
            for (const PointRange& r : o.result.missing) n += r.size();
            return n;
        }());
}

void LasBadInputTest::notRegular()
{
    const auto said = [](const fs::path& path) -> std::string {
        try {
            las::Reader::open(path);
        } catch (const Error& e) {
            return e.what();
        }
        return {};
    };
    const fs::path folder = m_dir.path().toStdString();
    QVERIFY(said(folder / "nothing.las").find("no such file") != std::string::npos);
    QVERIFY(said(folder).find("folder") != std::string::npos);
    QVERIFY(said("/dev/zero").find("regular") != std::string::npos);
    QCOMPARE(::mkfifo((folder / "pipe.las").c_str(), 0600), 0);
    QVERIFY(said(folder / "pipe.las").find("regular") != std::string::npos);
    if (::geteuid() != 0) {
        const fs::path secret = make("secret.las", plain());
        ::chmod(secret.c_str(), 0);
        QVERIFY(said(secret).find("cannot be opened") != std::string::npos);
    }
    const fs::path broken = PUNCTUM_TEST_DATA;
    for (const char* name : {"broken_version.laz", "broken_type.laz"})
        if (fs::exists(broken / name)) QVERIFY(said(broken / name).starts_with(name));
    const fs::path named = make("line\nbreak \xFF.las", plain());
    QCOMPARE(openAll(named).cloud->size(), PointIndex(kCount));
    fs::remove(named);  // QTemporaryDir cannot say that name
}

void LasBadInputTest::everyByteOfTheHeaderMayLie()
{
    // Whatever a header says, the end is points, warnings or an Error, soon and without much memory.
    for (const Bytes& good : {plain(), plain14(), laz(3), laz(7)}) {
        const fs::path path = make("lie.las", good);
        const std::size_t end = std::min(pointOffset(good) + 16, good.size());
        std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
        const auto put = [&](std::size_t at, std::byte value) {
            file.seekp(std::streamoff(at));
            file.put(char(value));
            file.flush();
        };
        for (std::size_t at = 0; at < end; ++at) {
            for (const unsigned value : {0u, 1u, 0x7Fu, 0xFFu}) {
                put(at, std::byte(value));
                try {
                    const auto reader = las::Reader::open(path);
                    const PointIndex n = reader->source()->pointCount;
                    QVERIFY2(n <= 100 * kCount,
                             qPrintable(QString("byte %1 = %2: %3 points").arg(at).arg(value).arg(n)));
                    Progress progress;
                    if (at % 4 == value % 4) reader->read(*reader->createCloud(), progress);
                } catch (const Error&) {
                }
            }
            put(at, good[at]);
        }
    }
}

void LasBadInputTest::mutatedChunksDoNoHarm_data()
{
    QTest::addColumn<int>("format");
    for (const int format : {0, 1, 3, 5, 6, 7, 8, 10}) QTest::addRow("format %d", format) << format;
}

void LasBadInputTest::mutatedChunksDoNoHarm()
{
    QFETCH(int, format);
    const Bytes good = laz(std::uint8_t(format), 200, 3);
    const std::size_t begin = pointOffset(good) + 8;
    const auto table = std::size_t(lasfiles::get<std::int64_t>(good, begin - 8));
    std::mt19937 random{std::uint32_t(format)};
    std::size_t found = 0;
    for (int round = 0; round < 60; ++round) {
        Bytes b = good;
        const std::size_t at = begin + random() % (table - begin);
        if (round % 3 == 0) b[at] ^= std::byte(1 << random() % 8);
        if (round % 3 == 1)
            for (std::size_t k = at; k < std::min(at + 16, table); ++k) b[k] = std::byte(random() & 0xFF);
        if (round % 3 == 2)
            std::fill(b.begin() + std::ptrdiff_t(at), b.begin() + std::ptrdiff_t(table), std::byte(0));
        try {
            const Opened o = openAll(make("mutated.laz", b));
            for (const PointRange& r : o.result.missing) {
                ++found;
                QVERIFY(r.last <= o.cloud->size());
                for (PointIndex i = r.first; i < r.last; ++i) QCOMPARE(o.cloud->rawX()[i], 0);
            }
        } catch (const Error&) {
        }
    }
    // layer sizes whose sum wraps to the right one, a count of 0 and of 2^32-1: refused before LASzip sees them
    if (format >= 6) {
        const std::size_t head = begin + lasfiles::recordLength(std::uint8_t(format)) + 3;
        for (const auto& [first, second] : {std::pair(0x80000010u, 0x80000010u), std::pair(0xFFFFFFFFu, 2u)}) {
            Bytes b = good;
            lasfiles::set<std::uint32_t>(b, head + 4, first);
            lasfiles::set<std::uint32_t>(b, head + 8, second);
            QCOMPARE(openAll(make("layers.laz", b)).result.missing, (std::vector<PointRange>{{0, 200}}));
        }
        for (const std::uint32_t count : {0u, 0xFFFFFFFFu, 199u}) {
            const Bytes b = with(good, head, count);
            QCOMPARE(openAll(make("count.laz", b)).result.missing, (std::vector<PointRange>{{0, 200}}));
        }
        Bytes b = good;
        for (std::size_t k = 0; k < 9; ++k) lasfiles::set<std::uint32_t>(b, head + 4 + 4 * k, 0);
        QCOMPARE(openAll(make("empty.laz", b)).result.missing, (std::vector<PointRange>{{0, 200}}));
    }
    QVERIFY(found != 0);
}

void LasBadInputTest::cutAnywhere_data()
{
    QTest::addColumn<int>("format");
    for (const int format : {3, 7, -3, -7})
        QTest::addRow("%s %d", format < 0 ? "LAZ" : "LAS", std::abs(format)) << format;
}

void LasBadInputTest::cutAnywhere()
{
    QFETCH(int, format);
    const auto f = std::uint8_t(std::abs(format));
    const auto length = lasfiles::recordLength(f);
    const Bytes points = lasfiles::randomRecords(f, length, kCount, 1, true);
    const Bytes good = format < 0
                           ? lasfiles::lazFile(f, length, points, 200)
                           : lasfiles::file(lasfiles::header(lasfiles::minorFor(f), f, length, kCount), {}, points);
    std::size_t readable = 0;
    for (std::size_t k = 1; k <= 60; ++k) {
        Bytes b = good;
        b.resize(good.size() * k / 61);
        try {
            const Opened o = openAll(make("cut", b));
            QVERIFY(o.cloud->size() <= kCount);
            // only the chunk table may be missing without loss of points
            QVERIFY(o.source->recovered || o.cloud->size() == kCount);
            ++readable;
        } catch (const Error&) {
        }
    }
    QVERIFY(readable > 30);
}

void LasBadInputTest::sparseFileBeyond32Bits()
{
    // 4.4e9 points, all zero, in a file that takes no room: only opened and sampled here
    const PointIndex count = 4'400'000'000;
    Bytes head = lasfiles::header(4, 6, 30, count);
    lasfiles::set<std::uint16_t>(head, 6, 16);
    const fs::path path = make("huge.las", head);
    std::error_code ec;
    fs::resize_file(path, head.size() + count * 30, ec);
    if (ec) QSKIP("this file system has no files of that size");
    const auto source = las::Reader::open(path)->source();
    QCOMPARE(source->pointCount, count);
    QVERIFY(source->warnings.empty());
    QVERIFY(!source->firstBounds.empty());
}

QTEST_GUILESS_MAIN(LasBadInputTest)
#include "LasBadInputTest.moc"
