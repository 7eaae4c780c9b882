// SPDX-License-Identifier: MIT
#include "core/Error.h"
#include "core/Text.h"
#include "core/las/Reader.h"
#include "core/las/Writer.h"
#include "core/task/Progress.h"
#include "tests/core/BadInputs.h"
#include "tests/core/LoadAndSave.h"

#include <QTemporaryDir>
#include <QTest>

using namespace punctum;
using lasfiles::Bytes;
namespace fs = std::filesystem;

/// Files whose tail reads as zeros, as after an interrupted copy: no point is given that was not written, and what
/// is missing is told.
class LasZeroTailTest : public QObject
{
    Q_OBJECT

private slots:
    void compressed_data();
    void compressed();
    void realFiles_data();
    void realFiles();
    void hole_data();
    void hole();
    void pointsThatGoOnAlike_data();
    void pointsThatGoOnAlike();
    void layers_data();
    void layers();
    void stream();
    void holeInStream();
    void plainIsWarnedOf();

private:
    fs::path make(const Bytes& bytes) const
    {
        const fs::path path = fs::path(m_dir.path().toStdString()) / "zeros.laz";
        lasfiles::writeFile(path, bytes);
        return path;
    }
    QTemporaryDir m_dir;
};

namespace
{

constexpr std::size_t kPoints = 4000;

/// What the reader makes of a file.
struct Given {
    Bytes records;
    std::vector<PointRange> missing;
    std::vector<std::string> warnings;
    std::uint64_t points = 0, sound = 0;
    bool recovered = false;

    explicit Given(const fs::path& path)
    {
        const auto reader = las::Reader::open(path);
        const std::size_t length = reader->source()->layout.length;
        points = reader->source()->pointCount;
        records.resize(std::size_t(points) * length);
        Progress progress;
        const auto result = reader->visitRecords(progress, [&](PointRange r, std::span<const std::byte> bytes) {
            std::memcpy(records.data() + r.first * length, bytes.data(), bytes.size());
        });
        missing = result.missing;
        warnings = reader->source()->warnings;
        warnings.insert(warnings.end(), result.warnings.begin(), result.warnings.end());
        recovered = reader->source()->recovered || !missing.empty();
        sound = points;
        for (const PointRange& r : missing) sound -= r.size();
    }
    std::string said() const
    {
        std::string all;
        for (const std::string& w : warnings) all += w + "\n";
        return all;
    }
};

/// Lifelike records: neighbors resemble each other, so that a point takes a few bytes.
Bytes survey(std::uint8_t format, std::size_t count)
{
    return lasfiles::randomRecords(format, lasfiles::recordLength(format), count, 7, true);
}

/// The last `percent` of the bytes are zeros.
Bytes zeroed(Bytes bytes, int percent)
{
    const std::size_t from = bytes.size() - bytes.size() * std::size_t(percent) / 100;
    std::fill(bytes.begin() + std::ptrdiff_t(from), bytes.end(), std::byte(0));
    return bytes;
}

/// Checks a damaged file against the records it once had; gives the number of those that are read.
std::uint64_t check(const fs::path& path, const Bytes& before, std::size_t length)
{
    const std::uint64_t count = before.size() / length;
    std::optional<Given> opened;
    try {
        opened.emplace(path);
    } catch (const Error& e) {
        if (std::string(e.what()).find("not one can be read") == std::string::npos) throw;
        return 0;
    }
    const Given& given = *opened;
    if (given.points > count) throw std::runtime_error("points were invented: " + given.said());
    for (const PointRange& r : las::readable(given.points, given.missing))
        for (PointIndex i = r.first; i < r.last; ++i)
            if (std::memcmp(given.records.data() + i * length, before.data() + i * length, length) != 0)
                throw std::runtime_error("point " + std::to_string(i) + " was invented: " + given.said());
    if (given.sound == count) return count;
    if (!given.recovered) throw std::runtime_error("the loss is not told");
    const bool told = given.points < count
                          ? given.said().find("The header says " + grouped(count) + " points, the file holds " +
                                              grouped(given.points) + ".") != std::string::npos
                          : given.said().find("are damaged and could not be read") != std::string::npos;
    if (!told) throw std::runtime_error("the loss is not told in points: " + given.said());
    // The original must stay.
    const auto cloud = lasfiles::load(path);
    bool refused = false;
    try {
        lasfiles::save(*cloud, path);
    } catch (const Error&) {
        refused = true;
    }
    if (!refused) throw std::runtime_error("it was saved over");
    return given.sound;
}

}  // namespace

void LasZeroTailTest::compressed_data()
{
    QTest::addColumn<int>("format");
    QTest::addColumn<int>("chunk");
    QTest::addColumn<int>("percent");
    for (int format = 0; format <= 5; ++format)
        for (const int chunk : {50000, 700, 100})
            for (const int percent : {1, 3, 10, 50, 90})
                QTest::addRow("format %d, chunks of %d, %d %%", format, chunk, percent)
                    << format << chunk << percent;
}

void LasZeroTailTest::compressed()
{
    QFETCH(int, format);
    QFETCH(int, chunk);
    QFETCH(int, percent);
    const auto f = std::uint8_t(format);
    const Bytes points = survey(f, kPoints);
    const Bytes good = lasfiles::lazFile(f, lasfiles::recordLength(f), points, std::uint32_t(chunk));
    const std::uint64_t sound = check(make(zeroed(good, percent)), points, lasfiles::recordLength(f));
    // Chunks that are whole count, and so does what comes before the zeros.
    const std::uint64_t expected = kPoints * std::uint64_t(100 - percent) / 100;
    QVERIFY2(sound + 120 >= expected && (sound <= expected + 300 || percent == 1),
             qPrintable(QString("%1 of %2").arg(sound).arg(expected)));
}

void LasZeroTailTest::realFiles_data()
{
    QTest::addColumn<QString>("file");
    QTest::addColumn<int>("percent");
    for (const char* folder : {"", "/more", "/cases", "/isprs"})
        for (const fs::path& path : lasfiles::sharedFiles(std::string(PUNCTUM_TEST_DATA) + folder)) {
            if (path.extension() != ".laz" || fs::file_size(path) > 300'000) continue;
            if (path.filename() == "laz-zero-tail.laz") continue;  // its sound twin is here
            const auto format = std::to_integer<unsigned>(lasfiles::readFile(path)[104]) & 0x3Fu;
            if (format > 5) continue;
            for (const int percent : {3, 10, 50})
                QTest::addRow("%s, %d %%", path.filename().c_str(), percent)
                    << QString::fromStdString(path.string()) << percent;
        }
    if (fs::exists(fs::path(PUNCTUM_TEST_DATA) / "cases")) return;
    QTest::newRow("none") << QString() << 0;
}

void LasZeroTailTest::realFiles()
{
    QFETCH(QString, file);
    QFETCH(int, percent);
    if (file.isEmpty()) QSKIP("the shared test data is not here");
    const Given before(file.toStdString());
    const std::size_t length = before.records.size() / std::max<std::size_t>(1, std::size_t(before.points));
    const std::uint64_t sound =
        check(make(zeroed(lasfiles::readFile(file.toStdString()), percent)), before.records, length);
    QVERIFY2(sound < before.points || percent == 3, qPrintable(QString::number(sound)));
    QVERIFY2(sound > 0, "nothing was saved from it");
}

void LasZeroTailTest::hole_data()
{
    QTest::addColumn<int>("format");
    QTest::addColumn<int>("chunk");
    QTest::addColumn<bool>("table");
    for (const int format : {0, 1, 3, 5})
        for (const int chunk : {50000, 700, 100})
            for (const bool table : {false, true})
                QTest::addRow("format %d, chunks of %d, %s", format, chunk, table ? "table" : "no table")
                    << format << chunk << table;
}

void LasZeroTailTest::hole()
{
    // A piece that was never written, with and without the table behind it.
    QFETCH(int, format);
    QFETCH(int, chunk);
    QFETCH(bool, table);
    const auto f = std::uint8_t(format);
    const auto length = lasfiles::recordLength(f);
    const Bytes points = survey(f, kPoints);
    const Bytes good = lasfiles::lazFile(f, length, points, std::uint32_t(chunk));
    const std::size_t begin = lasfiles::bad::pointOffset(good) + 8, end = lasfiles::bad::tableAt(good);
    for (const double where : {0.1, 0.5, 0.93}) {
        Bytes b = good;
        const auto from = begin + std::size_t(double(end - begin) * where);
        std::fill_n(b.begin() + std::ptrdiff_t(from), std::min<std::size_t>(4096, end - from), std::byte(0));
        if (!table) std::fill(b.begin() + std::ptrdiff_t(end), b.end(), std::byte(0x55));
        const std::uint64_t sound = check(make(b), points, length);
        QVERIFY(sound < kPoints);
        if (chunk == 100) QVERIFY(double(sound) + 220 >= kPoints * where);
    }
}

void LasZeroTailTest::pointsThatGoOnAlike_data()
{
    QTest::addColumn<int>("format");
    QTest::addColumn<bool>("table");
    for (const int format : {0, 1, 3, 5})
        for (const bool table : {false, true})
            QTest::addRow("format %d, %s", format, table ? "table" : "no table") << format << table;
}

void LasZeroTailTest::pointsThatGoOnAlike()
{
    // Equal points are coded as zeros: those are no damage.
    QFETCH(int, format);
    QFETCH(bool, table);
    const auto f = std::uint8_t(format);
    const auto length = lasfiles::recordLength(f);
    Bytes points = survey(f, 300);
    for (int k = 0; k < 20000; ++k) points.insert(points.end(), points.end() - length, points.end());
    for (const std::uint32_t chunk : {50000u, 5000u}) {
        Bytes b = lasfiles::lazFile(f, length, points, chunk);
        if (!table) std::fill(b.begin() + std::ptrdiff_t(lasfiles::bad::tableAt(b)), b.end(), std::byte(0));
        const Given given(make(b));
        QVERIFY2(given.records == points && !given.recovered, given.said().c_str());
    }
}

void LasZeroTailTest::layers_data()
{
    QTest::addColumn<int>("format");
    QTest::addColumn<int>("chunk");
    for (int format = 6; format <= 10; ++format)
        for (const int chunk : {50000, 700})
            QTest::addRow("format %d, chunks of %d", format, chunk) << format << chunk;
}

void LasZeroTailTest::layers()
{
    // Values without any order take as many bytes as zeros are taken for: only the end of a layer tells.
    QFETCH(int, format);
    QFETCH(int, chunk);
    const auto f = std::uint8_t(format);
    const auto length = std::uint16_t(lasfiles::recordLength(f) + 8);
    const Bytes points = lasfiles::randomRecords(f, length, kPoints, 7, false);
    const Bytes good = lasfiles::lazFile(f, length, points, std::uint32_t(chunk));
    const std::size_t end = lasfiles::bad::tableAt(good);
    QCOMPARE(check(make(good), points, length), std::uint64_t(kPoints));
    for (std::size_t zeros = 12; zeros < 5000; zeros = zeros * 4 / 3) {
        Bytes b = good;
        std::fill(b.begin() + std::ptrdiff_t(end - zeros), b.end(), std::byte(0));
        const std::uint64_t sound = check(make(b), points, length);
        QVERIFY2(sound < kPoints, qPrintable(QString::number(zeros)));
    }
}

void LasZeroTailTest::holeInStream()
{
    // A stream has nothing that tells where it ends: long runs of zeros do, or that it cannot be compressed so.
    for (const bool lifelike : {true, false}) {
        const auto length = lasfiles::recordLength(3);
        const Bytes points = lasfiles::randomRecords(3, length, kPoints, 7, lifelike);
        const Bytes chunked = lasfiles::lazFile(3, length, points, 50000);
        const std::size_t begin = lasfiles::bad::pointOffset(chunked), end = lasfiles::bad::tableAt(chunked);
        Bytes good = lasfiles::bad::withLaszip<std::uint16_t>(chunked, 0, 1);
        good.resize(end);
        good.erase(good.begin() + std::ptrdiff_t(begin), good.begin() + std::ptrdiff_t(begin) + 8);
        for (const double where : {0.3, 0.6, 0.9})
            for (const std::size_t zeros : {24, 512, 4096}) {
                Bytes b = good;
                const auto at = std::size_t(double(b.size()) * where);
                std::fill_n(b.begin() + std::ptrdiff_t(at), std::min(zeros, b.size() - at), std::byte(0));
                const std::uint64_t sound = check(make(b), points, length);
                QVERIFY(sound<kPoints&& double(sound)> 0.5 * where * kPoints);
            }
    }
}

void LasZeroTailTest::stream()
{
    // One stream (compressor 1) has neither chunks nor a table.
    const Bytes points = survey(3, kPoints);
    const auto length = lasfiles::recordLength(3);
    const auto asStream = [](const Bytes& chunked) {
        const std::size_t begin = lasfiles::bad::pointOffset(chunked), end = lasfiles::bad::tableAt(chunked);
        Bytes stream = lasfiles::bad::withLaszip<std::uint16_t>(chunked, 0, 1);
        stream.resize(end);
        stream.erase(stream.begin() + std::ptrdiff_t(begin), stream.begin() + std::ptrdiff_t(begin) + 8);
        return stream;
    };
    const Bytes good = asStream(lasfiles::lazFile(3, length, points, 50000));
    QCOMPARE(check(make(good), points, length), std::uint64_t(kPoints));
    for (const int percent : {3, 10, 50}) {
        const std::uint64_t sound = check(make(zeroed(good, percent)), points, length);
        const std::uint64_t expected = kPoints * std::uint64_t(100 - percent) / 100;
        QVERIFY2(sound + 60 >= expected && sound <= expected + 150,
                 qPrintable(QString("%1 of %2").arg(sound).arg(expected)));
    }
    // a count that no stream of these bytes can hold: the data decides
    Bytes many = good;
    lasfiles::set(many, 107, 0x7FFFFFFFu);
    const Given given(make(many));
    QVERIFY2(given.records == points && given.recovered, given.said().c_str());
    many = zeroed(many, 10);
    lasfiles::set(many, 107, 0x7FFFFFFFu);
    const Given cut(make(many));
    QVERIFY2(cut.sound > kPoints / 2 && cut.sound <= kPoints && cut.recovered, cut.said().c_str());
    many.resize(many.size() / 2);
    QVERIFY(Given(make(many)).sound <= kPoints / 2 + 10);
    // saved, it becomes chunks
    Progress progress;
    las::WriteOptions options;
    options.compressed = true;
    const fs::path path = make(good), copy = path.parent_path() / "chunks.laz";
    const auto report = las::write(*lasfiles::load(path), copy, options, progress);
    QVERIFY(std::any_of(report.notes.begin(), report.notes.end(), [](const std::string& n) {
        return n.find("in one stream, are compressed in chunks") != std::string::npos;
    }));
    QVERIFY(Given(copy).records == points);
    // equal points at the end are zeros, and no damage
    Bytes alike = survey(3, kPoints);
    const Bytes last(alike.end() - length, alike.end());
    for (std::size_t i = 0; i < 30 * kPoints; ++i) lasfiles::append(alike, last);
    const Given goesOn(make(asStream(lasfiles::lazFile(3, length, alike, 1'000'000))));
    QVERIFY2(goesOn.records == alike && !goesOn.recovered, goesOn.said().c_str());
}

void LasZeroTailTest::plainIsWarnedOf()
{
    // Records have no mark of their own: what can be said is said.
    const Bytes good = lasfiles::bad::plain(kPoints);
    QVERIFY(Given(make(good)).warnings.empty());
    const Given given(make(zeroed(good, 10)));
    QCOMPARE(given.points, std::uint64_t(kPoints));
    QVERIFY2(given.said().find("The last 400 points are nothing but zero bytes") != std::string::npos,
             given.said().c_str());
    QVERIFY(!given.recovered);
}

QTEST_GUILESS_MAIN(LasZeroTailTest)
#include "LasZeroTailTest.moc"
