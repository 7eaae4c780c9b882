// SPDX-License-Identifier: MIT
#include "core/las/Reader.h"
#include "core/las/Writer.h"
#include "core/task/Progress.h"
#include "tests/core/LasFiles.h"
#include "tests/core/LoadAndSave.h"
#include "tests/core/ReadRecords.h"

#include <QTemporaryDir>
#include <QTest>

#include <set>

using namespace punctum;
using lasfiles::Bytes;
using lasfiles::load;
using lasfiles::recordsByUs;
using lasfiles::save;
namespace fs = std::filesystem;

/// What is opened and saved is what it was: every real file that is at hand, and random records of every format, as
/// LAS and as LAZ. Judged by LASzip's own API and by a plain look at the bytes that shares no code with the
/// program.
class LasIdentityTest : public QObject
{
    Q_OBJECT

private slots:
    void realFiles_data();
    void realFiles();
    void throughLazAndBack_data();
    void throughLazAndBack();
    void randomRecords_data();
    void randomRecords();

private:
    fs::path temp(const std::string& name) const { return fs::path(m_dir.path().toStdString()) / name; }
    QTemporaryDir m_dir;
};

namespace
{

constexpr std::size_t kRandomPoints = 800'000;  ///< over all formats and numbers of extra bytes
constexpr int kExtraBytes[] = {0, 1, 7, 33};
constexpr std::size_t kFormats = 11;
constexpr std::size_t kMostConverted = 400'000;  ///< points of real files that are also saved as the other kind

/// A file's parts by what its header says, for files that tell the truth.
struct Parts {
    Bytes header;
    std::vector<Bytes> vlrs, evlrs;
    Bytes gap;   ///< before the points
    Bytes tail;  ///< after the last EVLR, where there is one
    std::uint64_t points = 0;

    explicit Parts(const Bytes& b)
    {
        const auto size = lasfiles::get<std::uint16_t>(b, 94);
        const std::uint8_t minor = lasfiles::get<std::uint8_t>(b, 25);
        header.assign(b.begin(), b.begin() + size);
        points = lasfiles::get<std::uint32_t>(b, 107);
        std::size_t at = size;
        for (std::uint32_t k = 0; k < lasfiles::get<std::uint32_t>(b, 100); ++k)
            at = take(b, at, 54u + lasfiles::get<std::uint16_t>(b, at + 20), vlrs);
        gap.assign(b.begin() + std::ptrdiff_t(at), b.begin() + lasfiles::get<std::uint32_t>(b, 96));
        if (minor < 4) return;
        if (lasfiles::get<std::uint64_t>(b, 247) != 0) points = lasfiles::get<std::uint64_t>(b, 247);
        at = std::size_t(lasfiles::get<std::uint64_t>(b, 235));
        const auto count = lasfiles::get<std::uint32_t>(b, 243);
        for (std::uint32_t k = 0; k < count; ++k)
            at = take(b, at, 60 + std::size_t(lasfiles::get<std::uint64_t>(b, at + 20)), evlrs);
        if (count != 0) tail.assign(b.begin() + std::ptrdiff_t(at), b.end());
    }
    static std::size_t take(const Bytes& b, std::size_t at, std::size_t bytes, std::vector<Bytes>& list)
    {
        list.emplace_back(b.begin() + std::ptrdiff_t(at), b.begin() + std::ptrdiff_t(at + bytes));
        return at + bytes;
    }
    std::uint8_t format() const { return lasfiles::get<std::uint8_t>(header, 104) & 0x3F; }
    std::uint16_t length() const { return lasfiles::get<std::uint16_t>(header, 105); }
};

std::string userOf(const Bytes& record)
{
    const std::string field(reinterpret_cast<const char*>(record.data()) + 2, 16);
    return field.substr(0, field.find('\0'));
}

/// What must be equal where a file becomes another kind: records but those on compression and on places in the
/// file, and the header but for the fields that follow from them.
Parts comparable(Parts parts)
{
    const auto stale = [](const Bytes& r) { return userOf(r) == "laszip encoded" || userOf(r) == "copc"; };
    std::erase_if(parts.vlrs, stale);
    const bool copc = std::erase_if(parts.evlrs, stale) != 0;
    lasfiles::set<std::uint32_t>(parts.header, 96, 0);
    lasfiles::set<std::uint32_t>(parts.header, 100, 0);
    lasfiles::set<std::uint8_t>(parts.header, 104, parts.format());
    if (parts.header.size() >= 235) lasfiles::set<std::uint64_t>(parts.header, 227, 0);
    if (parts.header.size() >= 375) lasfiles::set<std::uint64_t>(parts.header, 235, 0);
    if (parts.header.size() >= 375 && copc) lasfiles::set<std::uint32_t>(parts.header, 243, 0);
    return parts;
}

}  // namespace

void LasIdentityTest::realFiles_data()
{
    QTest::addColumn<QString>("file");
    for (const auto& f : lasfiles::sharedFiles(PUNCTUM_TEST_DATA))
        QTest::newRow(f.filename().c_str()) << QString::fromStdString(f.string());
    if (lasfiles::sharedFiles(PUNCTUM_TEST_DATA).empty()) QTest::newRow("none") << QString();
}

void LasIdentityTest::realFiles()
{
    QFETCH(QString, file);
    if (file.isEmpty()) QSKIP("the shared test data is not here");
    const fs::path path = file.toStdString();
    const Bytes original = lasfiles::readFile(path);
    const Parts before(original);
    const auto byLaszip = [&](const fs::path& p) {
        return lasfiles::recordsByLaszip(p, before.format(), before.length(), std::size_t(before.points));
    };
    const auto sameParts = [&](const fs::path& p) {
        const Parts a = comparable(before), b = comparable(Parts(lasfiles::readFile(p)));
        QVERIFY(a.header == b.header);
        QVERIFY(a.vlrs == b.vlrs);
        QVERIFY(a.evlrs == b.evlrs);
        QVERIFY(a.gap == b.gap);
        QVERIFY(a.tail == b.tail);
    };
    const Bytes records = byLaszip(path);
    QVERIFY(recordsByUs(path) == records);
    const auto cloud = load(path);
    QVERIFY(!cloud->source()->recovered);
    QCOMPARE(std::uint64_t(cloud->size()), before.points);

    const bool compressed = las::isCompressedName(path);
    const fs::path same = temp(compressed ? "same.laz" : "same.las"), other = temp(compressed ? "o.las" : "o.laz"),
                   back = temp(compressed ? "back.laz" : "back.las");
    const auto report = save(*cloud, same);
    QCOMPARE(report.bytes, std::uint64_t(fs::file_size(same)));
    if (!compressed) {
        QVERIFY(lasfiles::readFile(same) == original);
        QVERIFY(report.notes.empty());
    } else {
        QVERIFY(byLaszip(same) == records);
        sameParts(same);
    }
    if (before.points > kMostConverted) return;  // others of its kind are smaller
    save(*cloud, other);
    QVERIFY(byLaszip(other) == records);
    sameParts(other);
    save(*load(other), back);
    if (!compressed) QVERIFY(lasfiles::readFile(back) == original);
    QVERIFY(byLaszip(back) == records);
    sameParts(back);
}

void LasIdentityTest::throughLazAndBack_data()
{
    QTest::addColumn<QString>("file");
    QTest::addColumn<bool>("mended");
    // What saving puts right in these: numbers of records and points, the place of the extended records.
    const std::set<std::string> mended{"bad-vlr-count.las", "vlr-count-garbage.las", "count-zero.las",
                                       "evlr-offset-zero.las"};
    for (const char* folder : {"/more", "/cases"})
        for (const auto& f : lasfiles::sharedFiles(std::string(PUNCTUM_TEST_DATA) + folder))
            QTest::newRow(f.filename().c_str())
                << QString::fromStdString(f.string()) << mended.contains(f.filename().string());
    if (!fs::exists(fs::path(PUNCTUM_TEST_DATA) / "more")) QTest::newRow("none") << QString() << false;
}

void LasIdentityTest::throughLazAndBack()
{
    // Every byte of a LAS file comes back from its LAZ copy. LASzip, which cannot read all of these files, is not
    // asked.
    QFETCH(QString, file);
    QFETCH(bool, mended);
    if (file.isEmpty()) QSKIP("the shared test data is not here");
    const fs::path path = file.toStdString(), las = temp("first.las"), laz = temp("second.laz"),
                   back = temp("third.las");
    const auto cloud = load(path);
    const auto report = save(*cloud, las);
    const bool damaged = cloud->source()->recovered || !cloud->source()->asRead->get().missing.empty();
    QCOMPARE(damaged, path.filename() == "laz-zero-tail.laz");
    if (!las::isCompressedName(path)) {
        QCOMPARE(lasfiles::readFile(las) == lasfiles::readFile(path), !mended);
        QVERIFY(mended || report.notes.empty());
    }
    const auto first = load(las);
    QVERIFY(!first->source()->recovered);
    save(*first, laz);
    const auto second = load(laz);
    QVERIFY(!second->source()->recovered && second->source()->asRead->get().missing.empty());
    save(*second, back);
    QVERIFY(lasfiles::readFile(back) == lasfiles::readFile(las));
    QVERIFY(recordsByUs(laz) == recordsByUs(las));
}

void LasIdentityTest::randomRecords_data()
{
    QTest::addColumn<int>("format");
    QTest::addColumn<int>("extra");
    for (int format = 0; format < int(kFormats); ++format)
        for (const int extra : kExtraBytes)
            QTest::addRow("format %d, %d extra bytes", format, extra) << format << extra;
}

void LasIdentityTest::randomRecords()
{
    QFETCH(int, format);
    QFETCH(int, extra);
    const auto f = std::uint8_t(format);
    const auto length = std::uint16_t(lasfiles::recordLength(f) + extra);
    constexpr std::size_t kRows = kFormats * std::size(kExtraBytes);
    const std::size_t count = (kRandomPoints + kRows - 1) / kRows;
    // every other number of extra bytes with neighbors that resemble each other, as the coders expect
    const Bytes points =
        lasfiles::randomRecords(f, length, count, std::uint32_t(format * 100 + extra), extra == 7 || extra == 0);
    const fs::path in = temp("in.las"), las = temp("out.las"), laz = temp("out.laz");
    lasfiles::writeFile(in, lasfiles::file(lasfiles::header(lasfiles::minorFor(f), f, length, count), {}, points));

    const auto cloud = load(in);
    save(*cloud, las);
    save(*cloud, laz);
    QVERIFY(lasfiles::readFile(las) == lasfiles::readFile(in));
    QVERIFY(lasfiles::recordsByLaszip(las, f, length, count) == points);
    QVERIFY(lasfiles::recordsByLaszip(laz, f, length, count) == points);
    QVERIFY(recordsByUs(las) == points);
    QVERIFY(recordsByUs(laz) == points);
    const auto again = load(laz);
    QVERIFY(!again->source()->recovered && !load(las)->source()->recovered);
    for (std::size_t k = 0; k < cloud->columns().size(); ++k) {
        const auto &a = *cloud->columns()[k], &b = *again->columns()[k];
        QVERIFY(std::memcmp(a.data(), b.data(), a.elementBytes() * count) == 0);
    }
}

QTEST_GUILESS_MAIN(LasIdentityTest)
#include "LasIdentityTest.moc"
