// SPDX-License-Identifier: MIT
#include "core/Error.h"
#include "core/Text.h"
#include "core/las/Reader.h"
#include "core/las/Writer.h"
#include "core/task/Progress.h"
#include "tests/core/BadInputs.h"
#include "tests/core/ExactBoxes.h"

#include <QTemporaryDir>
#include <QTest>

#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <functional>
#include <limits>

using namespace punctum;
using lasfiles::Bytes;
using lasfiles::bad::laz;
using lasfiles::bad::plain;
using lasfiles::bad::plain14;
using lasfiles::bad::pointOffset;
using lasfiles::bad::with;
namespace fs = std::filesystem;

namespace
{

constexpr std::size_t kCount = 1065;

}  // namespace

/// Files that are damaged or lie: each is refused with one sentence, or opened with a warning. The rows of
/// BadInputs.h, and those of the table in docs/dev/testing.md that are more than a file. Worth most under the
/// sanitizers.
class LasBadInputTest : public QObject
{
    Q_OBJECT

private slots:
    void everyRow_data();
    void everyRow();
    void otherFiles_data();
    void otherFiles();
    void countBelow_data();
    void countBelow();
    void tailsStay_data();
    void tailsStay();
    void notRegular();
    void everyByteOfTheHeaderMayLie();
    void mutatedChunksDoNoHarm_data();
    void mutatedChunksDoNoHarm();
    void damageStaysInItsChunk();
    void changedWhileOpen();
    void namesOfAllKinds();
    void cutAnywhere_data();
    void cutAnywhere();

private:
    fs::path make(const std::string& name, const Bytes& bytes) const
    {
        const fs::path path = fs::path(m_dir.path().toStdString()) / name;
        lasfiles::writeFile(path, bytes);
        return path;
    }
    QTemporaryDir m_dir;
    const std::vector<lasfiles::BadInput> m_rows = lasfiles::badInputs(kCount);
};

namespace
{

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

void LasBadInputTest::everyRow_data()
{
    QTest::addColumn<int>("row");
    for (std::size_t k = 0; k < m_rows.size(); ++k) QTest::newRow(m_rows[k].name.c_str()) << int(k);
}

void LasBadInputTest::everyRow()
{
    QFETCH(int, row);
    const lasfiles::BadInput& bad = m_rows[std::size_t(row)];
    const fs::path path = make("bad.las", bad.bytes);
    if (!bad.opens) {
        try {
            openAll(path);
            QFAIL("it was opened");
        } catch (const Error& e) {
            const QString sentence = e.what();
            QVERIFY2(sentence.contains(QString::fromStdString(bad.said)), e.what());
            QVERIFY2(sentence.startsWith("bad.las: ") && sentence.count("bad.las") == 1 && !sentence.contains('\n'),
                     e.what());
            QVERIFY2(sentence.endsWith('.') || sentence.endsWith(')'), e.what());
            QCOMPARE(e.file(), path);
        }
        QVERIFY(lasfiles::readFile(path) == bad.bytes);
        return;
    }

    const Opened o = openAll(path);
    std::vector<std::string> warnings = o.source->warnings;
    warnings.insert(warnings.end(), o.result.warnings.begin(), o.result.warnings.end());
    std::string all;
    for (const std::string& w : warnings) {
        all += w + "\n";
        QVERIFY2(w.ends_with('.') && w.find('\n') == std::string::npos, w.c_str());
    }
    PointIndex missing = 0;
    for (const PointRange& r : o.result.missing) missing += r.size();
    QVERIFY2(o.cloud->size() == bad.points, all.c_str());
    QVERIFY2(missing == bad.missing, all.c_str());
    QVERIFY(boxesAreExact(*o.cloud));
    QVERIFY2(o.source->recovered == bad.recovered, all.c_str());
    QVERIFY2(bad.said.empty() ? warnings.empty() : all.find(bad.said) != std::string::npos, all.c_str());
    QCOMPARE(o.result.bounds.empty(), o.cloud->size() == missing);

    // What could be opened can be saved (under another name) as either kind, and is sound then.
    for (const bool compressed : {false, true}) {
        if (compressed && bad.name.starts_with("51")) continue;  // LASzip cannot; it is found out
        Progress progress;
        const fs::path copy = fs::path(m_dir.path().toStdString()) / "copy";
        las::WriteOptions options;
        options.compressed = compressed;
        las::write(*o.cloud, copy, options, progress);
        const Opened again = openAll(copy);
        QCOMPARE(again.source->pointCount, o.cloud->size() - missing);
        QVERIFY(!again.source->recovered && again.result.missing.empty());
    }
    QVERIFY(lasfiles::readFile(path) == bad.bytes);
}

void LasBadInputTest::otherFiles_data()
{
    QTest::addColumn<QByteArray>("begins");
    QTest::addColumn<QString>("said");
    const auto row = [](const char* name, const QByteArray& begins, const char* said) {
        QTest::newRow(name) << begins << QString(said);
    };
    row("web page", "<!DOCTYPE html>\n<html><head><title>404", "a web page; the link or the login");
    row("web page with a mark", "\xEF\xBB\xBF\r\n  <HTML lang=\"en\">", "a web page");
    row("LFS", "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n",
        "a pointer of Git LFS to one; get the file itself with git lfs pull.");
    row("annex", "/annex/objects/SHA256E-s12--abc.las\n", "a pointer of git-annex");
    row("zip", QByteArray("PK\x03\x04\x14\x00\x00\x00", 8), "a ZIP archive; unpack it first.");
    row("gzip", QByteArray("\x1F\x8B\x08\x00", 4), "a file compressed by gzip; unpack");
    row("bzip2", "BZh91AY&SY", "bzip2");
    row("xz",
        QByteArray("\xFD"
                   "7zXZ\0",
                   6),
        "xz");
    row("Zstandard", QByteArray("\x28\xB5\x2F\xFD\x24", 5), "Zstandard");
    row("7z", QByteArray("7z\xBC\xAF\x27\x1C", 6), "a 7z archive");
    row("tar", QByteArray(257, 'a') + "ustar", "a tar archive");
    row("PDF", "%PDF-1.7\n", "a PDF document.");
    row("E57", "ASTM-E57", "an E57 file; convert it");
    row("PLY", "ply\nformat ascii 1.0\n", "a PLY file; convert it");
    row("PCD", "# .PCD v.7 - Point Cloud Data\n", "a PCD file; convert it");
    row("PNG", "\x89PNG\r\n\x1A\n", "a PNG picture.");
    row("TIFF", QByteArray("II*\0", 4), "a TIFF picture.");
    row("JSON", "{\"error\": \"access denied\"}", "a JSON document.");
    row("XML", "<?xml version=\"1.0\"?><Error/>", "an XML document.");
    row("text", "123.45 678.90 12.3\n123.46 678.91 12.4\n", "a text; points in lines of text must be converted");
    row("zeros", QByteArray(5000, '\0'), "nothing but zero bytes");
    row("something", QByteArray("\x01\x02LASF\xFF", 7), "its signature is not LASF.");
    row("cut", "LASF", "it has 4 bytes, and a header needs 227");
}

void LasBadInputTest::otherFiles()
{
    QFETCH(QByteArray, begins);
    QFETCH(QString, said);
    // However long the rest is
    for (const QByteArray& rest : {QByteArray(), QByteArray(600, begins.back())}) {
        Bytes bytes(std::size_t(begins.size() + rest.size()));
        std::memcpy(bytes.data(), (begins + rest).constData(), bytes.size());
        try {
            las::Reader::open(make("other.las", bytes));
            QFAIL("it was opened");
        } catch (const Error& e) {
            if (begins == "LASF" && !rest.isEmpty()) continue;  // then it is refused by what its header says
            QVERIFY2(QString(e.what()).contains(said), e.what());
        }
    }
}

namespace
{

/// A survey that is as surveys are: coordinates near each other, returns that can be.
Bytes surveyRecords(std::uint8_t format, std::size_t count)
{
    const auto length = lasfiles::recordLength(format);
    Bytes records = lasfiles::randomRecords(format, length, count, 3, true);
    std::mt19937 random(1);
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t k = 0; k < 3; ++k)
            lasfiles::set(records, i * length + 4 * k, std::int32_t(100000 * k + i + random() % 5000));
        const unsigned returns = 1 + random() % 5, number = 1 + random() % returns;
        lasfiles::set(records, i * length + 14, std::uint8_t(number | returns << (format < 6 ? 3 : 4)));
    }
    return records;
}

Bytes withBox(Bytes head, std::size_t count)
{
    for (std::size_t k = 0; k < 3; ++k) {
        lasfiles::set(head, 179 + 16 * k, 0.01 * double(100000 * k + count + 5000));
        lasfiles::set(head, 187 + 16 * k, 0.01 * double(100000 * k));
    }
    return head;
}

}  // namespace

void LasBadInputTest::countBelow_data()
{
    QTest::addColumn<int>("format");
    QTest::addColumn<int>("stated");
    QTest::addColumn<bool>("box");
    QTest::addColumn<QString>("after");
    for (const int format : {1, 3, 6, 8})
        for (const int stated : {0, 1, int(kCount / 2), int(kCount - 1)})
            for (const bool box : {false, true})
                for (const char* after : {"", "part of a record", "padding", "EVLR"})
                    if (format >= 6 || after != QString("EVLR"))
                        QTest::addRow("format %d, %d stated, %s, %s", format, stated, box ? "box" : "no box", after)
                            << format << stated << box << QString(after);
}

void LasBadInputTest::countBelow()
{
    // The data decides: a header that its writer never finished, or that counts half of the points.
    QFETCH(int, format);
    QFETCH(int, stated);
    QFETCH(bool, box);
    QFETCH(QString, after);
    const auto f = std::uint8_t(format);
    const auto length = lasfiles::recordLength(f);
    const Bytes points = surveyRecords(f, kCount);
    Bytes head = lasfiles::header(lasfiles::minorFor(f), f, length, std::uint64_t(stated));
    if (box) head = withBox(head, kCount);
    if (f >= 6) lasfiles::set<std::uint16_t>(head, 6, 16);
    Bytes end;
    if (after == "part of a record") end.assign(points.begin(), points.begin() + length / 2);
    if (after == "padding") end = Bytes(4096);
    if (after == "EVLR") {
        end = lasfiles::record("a", 1, Bytes(10), true);
        lasfiles::set<std::uint64_t>(head, 235, head.size() + points.size());
        lasfiles::set<std::uint32_t>(head, 243, 1);
    }
    const fs::path path = make("below.las", lasfiles::file(head, {}, points, end));
    const Opened o = openAll(path);
    QCOMPARE(o.cloud->size(), PointIndex(kCount));
    QVERIFY(!o.source->recovered && o.result.missing.empty());
    QCOMPARE(QString::fromStdString(o.source->warnings.at(0)),
             QString("The header says %1 points, the file holds 1,065.")
                 .arg(QString::fromStdString(grouped(std::uint64_t(stated)))));

    // What is saved says so, and nothing else of it is lost.
    Progress progress;
    const fs::path copy = fs::path(m_dir.path().toStdString()) / "copy.las";
    las::write(*o.cloud, copy, {}, progress);
    const Bytes written = lasfiles::readFile(copy);
    QVERIFY(std::equal(points.begin(), points.end(), written.begin() + std::ptrdiff_t(head.size())));
    QVERIFY(std::equal(end.begin(), end.end(), written.end() - std::ptrdiff_t(end.size()), written.end()));
    QVERIFY(openAll(copy).source->warnings.empty());
}

void LasBadInputTest::tailsStay_data()
{
    QTest::addColumn<int>("format");
    QTest::addColumn<QString>("what");
    for (const int format : {1, 3, 6})
        for (const char* what : {"zeros", "text", "random", "lost EVLRs", "another file"})
            QTest::addRow("format %d, %s", format, what) << format << QString(what);
}

void LasBadInputTest::tailsStay()
{
    // Bytes after the points that are no points stay what they are, byte for byte, as LAS and through LAZ.
    QFETCH(int, format);
    QFETCH(QString, what);
    const auto f = std::uint8_t(format);
    const auto length = lasfiles::recordLength(f);
    const Bytes points = surveyRecords(f, kCount);
    Bytes tail(4000);
    if (what == "text") std::fill(tail.begin(), tail.end(), std::byte('a'));
    if (what == "random") tail = lasfiles::randomRecords(0, 20, 200, 9);
    if (what == "lost EVLRs") tail = lasfiles::record("a", 1, Bytes(3000), true);
    if (what == "another file") tail = plain(100);
    Bytes head = withBox(lasfiles::header(lasfiles::minorFor(f), f, length, kCount), kCount);
    if (f >= 6) lasfiles::set<std::uint16_t>(head, 6, 16);
    const Bytes bytes = lasfiles::file(head, {}, points, tail);
    const fs::path folder = m_dir.path().toStdString(), path = make("tail.las", bytes);
    const Opened o = openAll(path);
    QCOMPARE(o.cloud->size(), PointIndex(kCount));
    QVERIFY(o.source->warnings.empty());
    Progress progress;
    las::WriteOptions options;
    las::write(*o.cloud, folder / "tail2.las", options, progress);
    QVERIFY(lasfiles::readFile(folder / "tail2.las") == bytes);
    options.compressed = true;
    las::write(*o.cloud, folder / "tail.laz", options, progress);
    options.compressed = false;
    las::write(*openAll(folder / "tail.laz").cloud, folder / "tail3.las", options, progress);
    QVERIFY(lasfiles::readFile(folder / "tail3.las") == bytes);
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
    const fs::path secret = make("secret.las", plain(kCount)), closed = folder / "closed";
    fs::create_directory(closed);
    lasfiles::writeFile(closed / "inside.las", plain(kCount));
    ::chmod(secret.c_str(), 0);
    ::chmod(closed.c_str(), 0);
    const uid_t was = ::geteuid();
    constexpr uid_t kNobody = 65534;
    if (was == 0) QCOMPARE(::chmod(folder.c_str(), 0755), 0);
    if (was == 0) QCOMPARE(::seteuid(kNobody), 0);
    const std::string secretSaid = said(secret), closedSaid = said(closed / "inside.las");
    if (was == 0) QCOMPARE(::seteuid(was), 0);
    ::chmod(closed.c_str(), 0700);
    QVERIFY2(secretSaid.find("cannot be opened") != std::string::npos, secretSaid.c_str());
    QVERIFY2(closedSaid.find("cannot be opened") != std::string::npos, closedSaid.c_str());
    const fs::path broken = PUNCTUM_TEST_DATA;
    for (const char* name : {"broken_version.laz", "broken_type.laz"})
        if (fs::exists(broken / name)) QVERIFY(said(broken / name).starts_with(name));
    const fs::path named = make("line\nbreak \xFF.las", plain(kCount));
    QCOMPARE(openAll(named).cloud->size(), PointIndex(kCount));
    fs::remove(named);  // QTemporaryDir cannot say that name
}

void LasBadInputTest::everyByteOfTheHeaderMayLie()
{
    // Whatever a header says, the end is points, warnings or an Error, soon and without much memory.
    for (const Bytes& good : {plain(kCount), plain14(kCount), laz(kCount, 3, 200), laz(kCount, 7, 200)}) {
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
    for (int format = 0; format <= 10; ++format) QTest::addRow("format %d", format) << format;
}

void LasBadInputTest::mutatedChunksDoNoHarm()
{
    QFETCH(int, format);
    const Bytes good = laz(kCount, std::uint8_t(format), 200, 3);
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
    // 0xFF to the end of the points, and a range coder's beginning that no encoder writes
    for (std::size_t k = 0; k < 40; ++k) {
        Bytes b = good;
        const std::size_t at = begin + random() % (table - begin);
        std::fill(b.begin() + std::ptrdiff_t(at),
                  b.begin() + std::ptrdiff_t(k % 2 == 0 ? table : std::min(at + 4, table)), std::byte(0xFF));
        try {
            openAll(make("erased.laz", b));
        } catch (const Error&) {
        }
    }
    if (format < 6) {
        const Bytes b =
            with<std::uint32_t>(good, begin + lasfiles::recordLength(std::uint8_t(format)) + 3, UINT32_MAX);
        const Opened o = openAll(make("coder.laz", b));
        QCOMPARE(o.result.missing, (std::vector<PointRange>{{0, 200}}));
        QVERIFY(o.result.warnings.front().find("begin as none can") != std::string::npos);
    }
    QVERIFY(found != 0);
}

void LasBadInputTest::damageStaysInItsChunk()
{
    // 47: whatever becomes of a chunk with a flipped bit, the others are as they were, and so are all the file's
    // bytes
    for (const std::uint8_t format : {std::uint8_t(1), std::uint8_t(3), std::uint8_t(6), std::uint8_t(8)}) {
        const Bytes good = laz(kCount, format, 200);
        const auto length = lasfiles::recordLength(format);
        const Bytes points = lasfiles::randomRecords(format, length, kCount, 1, true);
        const auto [first, last] = lasfiles::bad::chunkAt(good, 2);
        std::mt19937 random(format);
        std::size_t found = 0;
        constexpr std::size_t kRounds = 40;
        for (std::size_t round = 0; round < kRounds; ++round) {
            Bytes b = good;
            b[first + random() % (last - first)] ^= std::byte(1 << random() % 8);
            const fs::path path = make("flip.laz", b);
            const auto reader = las::Reader::open(path);
            Bytes got(kCount * length);
            Progress progress;
            const auto result = reader->visitRecords(progress, [&](PointRange r, std::span<const std::byte> bytes) {
                std::memcpy(got.data() + r.first * length, bytes.data(), bytes.size());
            });
            for (const PointRange& r : result.missing) QVERIFY(r.first >= 400 && r.last <= 600);
            found += result.missing.empty() ? 0 : 1;
            const auto same = [&](std::size_t from, std::size_t to) {
                return std::equal(got.begin() + std::ptrdiff_t(from * length),
                                  got.begin() + std::ptrdiff_t(to * length),
                                  points.begin() + std::ptrdiff_t(from * length));
            };
            QVERIFY(same(0, 400) && same(600, kCount));
        }
        // LAZ has no checksum: what is not found are wrong values in chunks that decode to their very end.
        QVERIFY2(found >= kRounds / 4, qPrintable(QString("format %1: %2 found").arg(format).arg(found)));
    }
}

void LasBadInputTest::changedWhileOpen()
{
    // 56: another program cuts, rewrites, replaces or deletes the file between opening and reading
    const auto readAfter = [&](const Bytes& bytes, const std::function<void(const fs::path&)>& change) {
        const fs::path path = make("open.laz", bytes);
        const auto reader = las::Reader::open(path);
        const auto cloud = reader->createCloud();
        change(path);
        Progress progress;
        std::string said;
        try {
            reader->read(*cloud, progress);
        } catch (const Error& e) {
            said = e.what();
        }
        std::error_code ignored;
        fs::remove(path, ignored);
        return said;
    };
    for (const Bytes& bytes : {plain(50000), laz(kCount, 3, 200), laz(kCount, 7, 200)}) {
        QCOMPARE(readAfter(bytes, [](const fs::path&) {}), std::string());
        for (const std::size_t left : {std::size_t(0), std::size_t(300), bytes.size() / 2, bytes.size() - 1}) {
            const std::string said = readAfter(bytes, [&](const fs::path& p) { fs::resize_file(p, left); });
            QVERIFY2(said.starts_with("open.laz: The file ") && said.find('\n') == std::string::npos, said.c_str());
        }
        const std::string said = readAfter(bytes, [&](const fs::path& p) {
            lasfiles::writeFile(p, bytes);
            fs::last_write_time(p, fs::last_write_time(p) + std::chrono::seconds(1));
        });
        QVERIFY2(said.find("changed by another program") != std::string::npos, said.c_str());
        // The opened file lives on without its name.
        QCOMPARE(readAfter(bytes, [](const fs::path& p) { fs::remove(p); }), std::string());
        QCOMPARE(readAfter(bytes,
                           [&](const fs::path& p) {
                               lasfiles::writeFile(p.string() + ".new", Bytes(10));
                               fs::rename(p.string() + ".new", p);
                           }),
                 std::string());
    }
}

void LasBadInputTest::namesOfAllKinds()
{
    // 58: opened, and saved where they are
    const fs::path folder = fs::path(m_dir.path().toStdString()) / "names";
    fs::create_directory(folder);
    for (const std::string& name : {std::string("line\nbreak.las"), std::string("\xFF\xC3(.las"),
                                    std::string(251, 'x') + ".las", std::string("-v.las"), std::string(" .las")}) {
        const fs::path path = folder / name;
        lasfiles::writeFile(path, plain(kCount));
        const auto cloud = openAll(path).cloud;
        cloud->columns()[0]->values<std::int32_t>()[0] = 77;
        Progress progress;
        las::write(*cloud, path, {}, progress);
        QCOMPARE(openAll(path).cloud->rawX()[0], 77);
        // an error names the file in one line that may go to a terminal
        lasfiles::writeFile(path, Bytes(3));
        try {
            las::Reader::open(path);
            QFAIL("it was opened");
        } catch (const Error& e) {
            QVERIFY2(e.what() == printable(e.what()), e.what());
        }
        fs::remove(path);
    }
    QVERIFY(fs::is_empty(folder));
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

QTEST_GUILESS_MAIN(LasBadInputTest)
#include "LasBadInputTest.moc"
