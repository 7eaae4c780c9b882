// SPDX-License-Identifier: MIT
#include "core/Error.h"
#include "core/las/AtomicFile.h"
#include "core/las/Reader.h"
#include "core/las/SourceParser.h"
#include "core/las/Writer.h"
#include "core/task/Progress.h"
#include "tests/core/BadInputs.h"
#include "tests/core/LoadAndSave.h"

#include <QTemporaryDir>
#include <QTest>

#include <sys/stat.h>
#include <sys/xattr.h>

#include <mutex>

using namespace punctum;
using lasfiles::Bytes;
using lasfiles::load;
namespace fs = std::filesystem;

/// Saving what came from a file: what is copied as it is, and what the file that is replaced keeps.
class LasSaveTest : public QObject
{
    Q_OBJECT

private slots:
    void uneditedLazIsTheSameFile_data();
    void uneditedLazIsTheSameFile();
    void onlyEditedChunksAreEncoded_data();
    void onlyEditedChunksAreEncoded();
    void chunksAreTakenFromTheFileLastSaved();
    void changedSourceIsNotCopiedFrom();
    void chunksOfDifferentSizes_data();
    void chunksOfDifferentSizes();
    void lostChunksLeaveTheOthers();
    void damagedChunksAreLostWhole();
    void versionsAreNotMixed();
    void indexStaysWithItsPoints();
    void changedTargetIsAsked();
    void protectedTargetIsAsked();
    void linkToNothingIsFollowed();
    void targetThatChangesMeanwhileStays();
    void attributesAndAccessAreKept();
    void indexBesideIsSetAside();
    void copcNameIsNamed();
    void fullDiskIsFoundEarly();

private:
    fs::path temp(const std::string& name) const { return fs::path(m_dir.path().toStdString()) / name; }
    fs::path make(const std::string& name, const Bytes& bytes) const
    {
        lasfiles::writeFile(temp(name), bytes);
        return temp(name);
    }
    static las::WriteReport save(const PointCloud& cloud, const fs::path& path, las::WriteOptions options = {})
    {
        Progress progress;
        options.compressed = las::isCompressedName(path);
        return las::write(cloud, path, options, progress);
    }
    static las::ParsedFile parsed(const fs::path& path) { return las::parseFile(las::File(path)); }
    static void set(PointCloud& cloud, const char* column, PointIndex point, std::uint8_t value)
    {
        for (const auto& c : cloud.columns())
            if (c->name() == column) c->data()[point * c->elementBytes()] = std::byte(value);
    }

    QTemporaryDir m_dir;
};

namespace
{

constexpr std::size_t kChunkSizeAt = 12, kSpecialAt = 16, kItemsAt = 34;
constexpr std::uint32_t kVariable = 0xFFFFFFFF;

bool hasNote(const las::WriteReport& report, const std::string& part)
{
    return std::any_of(report.notes.begin(), report.notes.end(),
                       [&](const std::string& n) { return n.find(part) != std::string::npos; });
}

/// Where the payload of the only record of a file from lasfiles::lazFile is.
std::size_t payloadAt(const Bytes& file)
{
    return lasfiles::get<std::uint16_t>(file, 94) + 54u;
}

Bytes chunkBytes(const Bytes& file, const las::Chunk& chunk)
{
    return {file.begin() + std::ptrdiff_t(chunk.offset), file.begin() + std::ptrdiff_t(chunk.offset + chunk.bytes)};
}

}  // namespace

void LasSaveTest::uneditedLazIsTheSameFile_data()
{
    QTest::addColumn<QString>("file");
    for (const auto& f : lasfiles::sharedFiles(PUNCTUM_TEST_DATA))
        if (las::isCompressedName(f)) QTest::newRow(f.filename().c_str()) << QString::fromStdString(f.string());
    if (lasfiles::sharedFiles(PUNCTUM_TEST_DATA).empty()) QTest::newRow("none") << QString();
}

void LasSaveTest::uneditedLazIsTheSameFile()
{
    QFETCH(QString, file);
    if (file.isEmpty()) QSKIP("the shared test data is not here");
    const fs::path path = file.toStdString();
    const auto cloud = load(path);
    const auto report = save(*cloud, temp("same.laz"));
    QVERIFY(lasfiles::readFile(temp("same.laz")) == lasfiles::readFile(path));
    QCOMPARE(report.chunksEncoded, std::uint64_t(0));
    QCOMPARE(report.chunksCopied, std::uint64_t(parsed(path).chunks.size()));
    QVERIFY(report.notes.empty());
}

void LasSaveTest::onlyEditedChunksAreEncoded_data()
{
    QTest::addColumn<int>("format");
    QTest::addColumn<int>("extra");
    for (const int format : {0, 3, 5, 6, 7, 10}) QTest::addRow("format %d", format) << format << format % 3;
}

void LasSaveTest::onlyEditedChunksAreEncoded()
{
    QFETCH(int, format);
    QFETCH(int, extra);
    const auto f = std::uint8_t(format);
    const auto length = std::uint16_t(lasfiles::recordLength(f) + extra);
    const std::size_t count = 9500;  // nine chunks of 1000 and a part
    Bytes points = lasfiles::randomRecords(f, length, count, std::uint32_t(format), true);
    const Bytes before = lasfiles::lazFile(f, length, points, 1000);
    const fs::path path = make("edit.laz", before);
    const auto cloud = load(path);
    for (const std::size_t i : {std::size_t(3000), std::size_t(3999), std::size_t(9499)}) {
        set(*cloud, "UserData", i, 77);
        points[i * length + 17] = std::byte(77);
    }
    const auto chunksBefore = parsed(path).chunks;
    const auto report = save(*cloud, path);
    QCOMPARE(report.chunksEncoded, std::uint64_t(2));
    QCOMPARE(report.chunksCopied, std::uint64_t(8));
    QVERIFY(lasfiles::recordsByLaszip(path, f, length, count) == points);
    const Bytes after = lasfiles::readFile(path);
    QVERIFY(after == lasfiles::lazFile(f, length, points, 1000));  // as if LASzip had written all of it
    const auto chunksAfter = parsed(path).chunks;
    QCOMPARE(chunksAfter.size(), chunksBefore.size());
    for (std::size_t k = 0; k < chunksBefore.size(); ++k)
        QCOMPARE(chunkBytes(after, chunksAfter[k]) == chunkBytes(before, chunksBefore[k]), k != 3 && k != 9);
}

void LasSaveTest::chunksAreTakenFromTheFileLastSaved()
{
    const std::size_t count = 5000;
    Bytes points = lasfiles::randomRecords(7, 36, count, 1, true);
    const auto cloud = load(make("first.laz", lasfiles::lazFile(7, 36, points, 1000)));
    set(*cloud, "UserData", 10, 1);
    QCOMPARE(save(*cloud, temp("second.laz")).chunksEncoded, std::uint64_t(1));
    fs::remove(temp("first.laz"));
    set(*cloud, "UserData", 4010, 2);
    auto report = save(*cloud, temp("second.laz"));
    QCOMPARE(report.chunksEncoded, std::uint64_t(1));
    QCOMPARE(report.chunksCopied, std::uint64_t(4));
    points[10 * 36 + 17] = std::byte(1);
    points[4010 * 36 + 17] = std::byte(2);
    QVERIFY(lasfiles::readFile(temp("second.laz")) == lasfiles::lazFile(7, 36, points, 1000));

    // from LAS there is nothing to copy at first, then there is
    const auto plain = load(make("a.las", lasfiles::file(lasfiles::header(4, 7, 36, count), {}, points)));
    QCOMPARE(save(*plain, temp("a.laz")).chunksCopied, std::uint64_t(0));
    QCOMPARE(save(*plain, temp("a.laz")).chunksCopied, std::uint64_t(1));
    QVERIFY(lasfiles::recordsByLaszip(temp("a.laz"), 7, 36, count) == points);
}

void LasSaveTest::changedSourceIsNotCopiedFrom()
{
    const std::size_t count = 3000;
    const Bytes points = lasfiles::randomRecords(1, 28, count, 2, true);
    const Bytes other = lasfiles::randomRecords(1, 28, count, 3, true);
    const Bytes laz = lasfiles::lazFile(1, 28, points, 1000);
    const fs::path path = make("source.laz", laz);
    const auto cloud = load(path);
    make("source.laz", lasfiles::lazFile(1, 28, other, 1000));
    const auto report = save(*cloud, temp("kept.laz"));
    QCOMPARE(report.chunksCopied, std::uint64_t(0));
    QVERIFY(lasfiles::readFile(temp("kept.laz")) == laz);
    las::WriteOptions options;
    options.copyChunks = false;
    QCOMPARE(save(*load(path), temp("kept.laz"), options).chunksCopied, std::uint64_t(0));
}

void LasSaveTest::chunksOfDifferentSizes_data()
{
    QTest::addColumn<quint32>("stored");
    QTest::newRow("variable") << quint32(kVariable);
    QTest::newRow("variable, said by 0") << quint32(0);
}

void LasSaveTest::chunksOfDifferentSizes()
{
    QFETCH(quint32, stored);
    // made by hand: three chunks of LASzip's, and a table that says their points
    const Bytes points = lasfiles::randomRecords(3, 34, 1723, 4, true);
    Bytes file = lasfiles::lazFile(3, 34, Bytes(points.begin(), points.begin() + 1000 * 34));
    const std::size_t begin = lasfiles::get<std::uint32_t>(file, 96);
    file.resize(begin + 8);
    std::vector<las::ChunkEntry> entries;
    std::size_t first = 0;
    for (const std::size_t n : {std::size_t(1000), std::size_t(1), std::size_t(722)}) {
        const Bytes part(points.begin() + std::ptrdiff_t(first * 34),
                         points.begin() + std::ptrdiff_t((first + n) * 34));
        Bytes chunk = lasfiles::compressedByLaszip(3, 34, part, 50000);
        chunk.resize(std::size_t(lasfiles::get<std::int64_t>(chunk, 0)));
        chunk.erase(chunk.begin(), chunk.begin() + 8);
        lasfiles::append(file, chunk);
        entries.push_back({std::uint32_t(n), std::uint32_t(chunk.size())});
        first += n;
    }
    lasfiles::set<std::int64_t>(file, begin, std::int64_t(file.size()));
    lasfiles::append(file, las::encodeChunkTable(entries, true));
    lasfiles::set<std::uint32_t>(file, 107, 1723);
    lasfiles::set<std::uint32_t>(file, payloadAt(file) + kChunkSizeAt, stored);
    const fs::path path = make("variable.laz", file);
    const auto cloud = load(path);
    QCOMPARE(save(*cloud, temp("same.laz")).chunksCopied, std::uint64_t(3));
    QVERIFY(lasfiles::readFile(temp("same.laz")) == file);

    Bytes edited = points;
    edited[1000 * 34 + 17] = std::byte(9);
    set(*cloud, "UserData", 1000, 9);
    QCOMPARE(save(*cloud, temp("edited.laz")).chunksEncoded, std::uint64_t(1));
    QVERIFY(lasfiles::recordsByLaszip(temp("edited.laz"), 3, 34, 1723) == edited);
    QCOMPARE(lasfiles::get<std::uint32_t>(lasfiles::readFile(temp("edited.laz")), payloadAt(file) + kChunkSizeAt),
             stored);
}

void LasSaveTest::lostChunksLeaveTheOthers()
{
    for (const std::size_t lost : {std::size_t(4), std::size_t(9)}) {
        const std::size_t count = 1000;
        Bytes points = lasfiles::randomRecords(6, 30, count, 8);
        Bytes laz = lasfiles::lazFile(6, 30, points, 100);
        const auto chunk = parsed(make("good.laz", laz)).chunks[lost];
        lasfiles::set<std::uint32_t>(laz, std::size_t(chunk.offset) + 30 + 4, 0x80000000);  // a layer's size
        const auto cloud = load(make("bad.laz", laz));
        const auto report = save(*cloud, temp("rest.laz"));
        QCOMPARE(report.points, PointIndex(900));
        QCOMPARE(report.chunksCopied, std::uint64_t(9));
        const auto at = points.begin() + std::ptrdiff_t(lost * 100 * 30);
        points.erase(at, at + 100 * 30);
        QVERIFY(lasfiles::recordsByLaszip(temp("rest.laz"), 6, 30, 900) == points);
        // without the last one, the others are all of a size
        const Bytes rest = lasfiles::readFile(temp("rest.laz"));
        QCOMPARE(lasfiles::get<std::uint32_t>(rest, payloadAt(rest) + kChunkSizeAt), 100u);
        // what was saved is a file like any other
        QCOMPARE(save(*cloud, temp("rest.laz")).chunksCopied, std::uint64_t(9));
        QVERIFY(lasfiles::readFile(temp("rest.laz")) == rest);
    }
}

void LasSaveTest::damagedChunksAreLostWhole()
{
    // What decodes long after the damage is not what was written: none of the chunk's points arrives, though there
    // are more of them than arrive at once.
    const std::size_t count = 150000;
    Bytes points = lasfiles::randomRecords(0, 20, count, 9, true);
    Bytes laz = lasfiles::lazFile(0, 20, points, 70000);
    const auto chunk = parsed(make("whole.laz", laz)).chunks[0];
    laz[std::size_t(chunk.offset + chunk.bytes * 3 / 100)] ^= std::byte(0x55);
    const auto reader = las::Reader::open(make("part.laz", laz));
    const auto cloud = reader->createCloud();
    std::mutex mutex;
    PointIndex first = count, arrived = 0;
    Progress progress;
    const auto result = reader->read(*cloud, progress, [&](PointRange r) {
        const std::lock_guard lock(mutex);
        first = std::min(first, r.first);
        arrived += r.size();
    });
    QCOMPARE(result.missing, (std::vector<PointRange>{{0, 70000}}));
    QCOMPARE(first, PointIndex(70000));
    QCOMPARE(arrived, PointIndex(80000));
    QVERIFY_EXCEPTION_THROWN(save(*cloud, temp("part.laz")), Error);  // the original stays
    const auto report = save(*cloud, temp("rest.laz"));
    QCOMPARE(report.chunksCopied, std::uint64_t(2));
    points.erase(points.begin(), points.begin() + 70000 * 20);
    QVERIFY(lasfiles::recordsByLaszip(temp("rest.laz"), 0, 20, points.size() / 20) == points);
}

void LasSaveTest::versionsAreNotMixed()
{
    // Version 4 of the layered items differs from 3, which LASzip writes, only where scanner channels change.
    const std::size_t count = 3000;
    Bytes points = lasfiles::randomRecords(6, 30, count, 5, true);
    for (std::size_t i = 0; i < count; ++i) points[i * 30 + 15] &= std::byte(0xCF);
    Bytes laz = lasfiles::lazFile(6, 30, points, 1000);
    lasfiles::set<std::uint16_t>(laz, payloadAt(laz) + kItemsAt + 4, 4);
    const auto cloud = load(make("four.laz", laz));
    auto report = save(*cloud, temp("same.laz"));
    QCOMPARE(report.chunksCopied, std::uint64_t(3));
    QVERIFY(lasfiles::readFile(temp("same.laz")) == laz);

    set(*cloud, "UserData", 2500, 1);
    points[2500 * 30 + 17] = std::byte(1);
    report = save(*cloud, temp("three.laz"));
    QCOMPARE(report.chunksCopied, std::uint64_t(0));
    QCOMPARE(report.chunksEncoded, std::uint64_t(3));
    QVERIFY(lasfiles::readFile(temp("three.laz")) == lasfiles::lazFile(6, 30, points, 1000));
}

void LasSaveTest::indexStaysWithItsPoints()
{
    // LAStools' index, as an EVLR and as bytes behind the table that the laszip record points at
    const std::size_t count = 2000;
    const Bytes points = lasfiles::randomRecords(6, 30, count, 6, true);
    Bytes laz = lasfiles::lazFile(6, 30, points, 1000);
    const Bytes index = lasfiles::record("LAStools", 30, Bytes(99, std::byte('i')), true);
    lasfiles::set<std::int64_t>(laz, payloadAt(laz) + kSpecialAt, 1);
    lasfiles::set<std::int64_t>(laz, payloadAt(laz) + kSpecialAt + 8, std::int64_t(laz.size()));
    Bytes asTail = laz;
    lasfiles::append(asTail, index);
    Bytes asEvlr = lasfiles::lazFile(6, 30, points, 1000);
    lasfiles::set<std::uint64_t>(asEvlr, 235, asEvlr.size());
    lasfiles::set<std::uint32_t>(asEvlr, 243, 1);
    lasfiles::append(asEvlr, index);
    for (const Bytes& file : {asTail, asEvlr}) {
        const auto cloud = load(make("indexed.laz", file));
        for (int k = 0; k < 2; ++k) {
            QVERIFY(save(*cloud, temp("same.laz")).notes.empty());
            QVERIFY(lasfiles::readFile(temp("same.laz")) == file);
        }
        set(*cloud, "UserData", 500, 1);
        QVERIFY(hasNote(save(*cloud, temp("edited.laz")), "index"));
        const Bytes edited = lasfiles::readFile(temp("edited.laz"));
        QCOMPARE(lasfiles::get<std::int64_t>(edited, payloadAt(edited) + kSpecialAt), std::int64_t(-1));
        QCOMPARE(lasfiles::get<std::int64_t>(edited, payloadAt(edited) + kSpecialAt + 8), std::int64_t(-1));
        QCOMPARE(lasfiles::get<std::uint32_t>(edited, 243), 0u);
    }
}

void LasSaveTest::changedTargetIsAsked()
{
    const Bytes points = lasfiles::randomRecords(0, 20, 100, 1);
    const Bytes mine = lasfiles::file(lasfiles::header(2, 0, 20, 100), {}, points);
    const Bytes theirs = lasfiles::file(lasfiles::header(2, 0, 20, 50), {}, Bytes(50 * 20));
    const fs::path path = make("shared.las", mine);
    fs::create_symlink("shared.las", temp("other name.las"));
    const auto cloud = load(path);
    make("shared.las", theirs);
    for (const char* name : {"shared.las", "other name.las"}) {
        try {
            save(*cloud, temp(name));
            QFAIL("the changed file was replaced");
        } catch (const las::WriteQuestion& question) {
            QCOMPARE(question.kind(), las::WriteQuestion::Kind::TargetChanged);
            QVERIFY(std::string(question.what()).find("Another program changed this file") != std::string::npos);
        }
        QVERIFY(lasfiles::readFile(path) == theirs);
    }
    las::WriteOptions options;
    options.overwriteChanged = true;
    save(*cloud, path, options);
    QVERIFY(lasfiles::readFile(path) == mine);
    save(*cloud, path);  // it is ours again

    // a new file in its place is as much of a change, no file is none
    fs::rename(path, temp("away.las"));
    fs::copy_file(temp("away.las"), path);
    QVERIFY_EXCEPTION_THROWN(save(*cloud, path), las::WriteQuestion);
    fs::remove(path);
    save(*cloud, path);
    // another file than the cloud's own is replaced without a question: whoever chose its name was asked
    save(*cloud, make("elsewhere.las", theirs));
    QVERIFY(lasfiles::readFile(temp("elsewhere.las")) == mine);
}

void LasSaveTest::protectedTargetIsAsked()
{
    // Renaming over a file needs no right to write to it, so the program must look.
    const auto cloud = load(make("free.las", lasfiles::bad::plain(10)));
    const Bytes old(33, std::byte('o'));
    const fs::path target = make("protected.las", old);
    ::chmod(target.c_str(), 0444);
    fs::create_symlink("protected.las", temp("protected link.las"));
    for (const char* name : {"protected.las", "protected link.las"}) {
        try {
            save(*cloud, temp(name));
            QFAIL("it was replaced");
        } catch (const las::WriteQuestion& question) {
            QCOMPARE(question.kind(), las::WriteQuestion::Kind::TargetProtected);
            QCOMPARE(QString(question.what()), QString(name) + ": This file is write-protected.");
        }
        QVERIFY_EXCEPTION_THROWN(las::AtomicFile(temp(name)), Error);
    }
    QVERIFY(lasfiles::readFile(target) == old);
    las::WriteOptions options;
    options.replaceProtected = true;
    save(*cloud, target, options);
    QVERIFY(lasfiles::readFile(target) == lasfiles::bad::plain(10));
    struct stat s {
    };
    QCOMPARE(::stat(target.c_str(), &s), 0);
    QCOMPARE(s.st_mode & 07777, mode_t(0444));
}

void LasSaveTest::linkToNothingIsFollowed()
{
    // The file is made where the link leads to, through another link, and the links stay.
    const auto cloud = load(make("linked.las", lasfiles::bad::plain(10)));
    const fs::path folder = temp("elsewhere");
    fs::create_directory(folder);
    fs::create_symlink("elsewhere/second.las", temp("first.las"));
    fs::create_symlink(folder / "real.las", folder / "second.las");
    save(*cloud, temp("first.las"));
    QVERIFY(fs::is_symlink(temp("first.las")) && fs::is_symlink(folder / "second.las"));
    QVERIFY(!fs::is_symlink(folder / "real.las"));
    QVERIFY(lasfiles::readFile(folder / "real.las") == lasfiles::bad::plain(10));
    fs::create_symlink("nowhere/a.las", temp("nowhere.las"));
    fs::create_symlink("circle.las", temp("circle.las"));
    QVERIFY_EXCEPTION_THROWN(save(*cloud, temp("nowhere.las")), Error);
    QVERIFY_EXCEPTION_THROWN(save(*cloud, temp("circle.las")), Error);
    QVERIFY(fs::is_symlink(temp("nowhere.las")) && fs::is_symlink(temp("circle.las")));
}

void LasSaveTest::targetThatChangesMeanwhileStays()
{
    const fs::path target = make("target.las", Bytes(10));
    const auto files = [&] { return std::distance(fs::directory_iterator(target.parent_path()), {}); };
    const auto before = files();
    {
        las::AtomicFile file(target);
        file.writeAt(0, Bytes(5));
        make("target.las", Bytes(11));
        QVERIFY_EXCEPTION_THROWN(file.commit(), Error);
    }
    {
        las::AtomicFile file(temp("new.las"));
        QVERIFY(!file.replaces());
        make("new.las", Bytes(12));
        QVERIFY_EXCEPTION_THROWN(file.commit(), Error);
    }
    QCOMPARE(lasfiles::readFile(target), Bytes(11));
    QCOMPARE(lasfiles::readFile(temp("new.las")), Bytes(12));
    QCOMPARE(files(), before + 1);
}

void LasSaveTest::attributesAndAccessAreKept()
{
    const auto cloud = load(make("a.las", lasfiles::file(lasfiles::header(2, 0, 20, 1), {}, Bytes(20))));
    const fs::path target = make("attributes.las", Bytes(1));
    ::chmod(target.c_str(), 0604);
    const std::string text(200, 'o'), empty;
    if (::setxattr(target.c_str(), "user.origin", text.data(), text.size(), 0) != 0)
        QSKIP("the file system for temporary files has no extended attributes");
    ::setxattr(target.c_str(), "user.empty", empty.data(), 0, 0);
    // version 2; owner rw, user 1234 r, group none, mask r, others r (acl(5), as the kernel stores it)
    struct Entry {
        std::uint16_t tag, rights;
        std::uint32_t id;
    };
    constexpr std::uint32_t kNobody = 0xFFFFFFFF;
    const Entry entries[] = {{1, 6, kNobody}, {2, 4, 1234}, {4, 0, kNobody}, {16, 4, kNobody}, {32, 4, kNobody}};
    Bytes list(4);
    list[0] = std::byte(2);
    const auto* p = reinterpret_cast<const std::byte*>(entries);
    list.insert(list.end(), p, p + sizeof entries);
    const bool lists = ::setxattr(target.c_str(), "system.posix_acl_access", list.data(), list.size(), 0) == 0;

    const auto report = save(*cloud, target);
    QVERIFY(report.notes.empty());
    const auto value = [&](const char* name) {
        std::string v(1000, '?');
        const auto n = ::getxattr(target.c_str(), name, v.data(), v.size());
        return n < 0 ? std::string("none") : v.substr(0, std::size_t(n));
    };
    QCOMPARE(value("user.origin"), text);
    QCOMPARE(value("user.empty"), empty);
    struct stat s {
    };
    QCOMPARE(::stat(target.c_str(), &s), 0);
    QCOMPARE(s.st_mode & 0777u, lists ? 0644u : 0604u);
    if (lists)
        QVERIFY(value("system.posix_acl_access") == std::string(reinterpret_cast<char*>(list.data()), list.size()));
    QVERIFY(lasfiles::readFile(target) == lasfiles::readFile(temp("a.las")));
}

void LasSaveTest::indexBesideIsSetAside()
{
    const auto cloud = load(make("i.las", lasfiles::file(lasfiles::header(2, 0, 20, 1), {}, Bytes(20))));
    make("i.lax", Bytes(7, std::byte('x')));
    QVERIFY(hasNote(save(*cloud, temp("i.las")), ".lax.old"));
    QVERIFY(!fs::exists(temp("i.lax")));
    QCOMPARE(lasfiles::readFile(temp("i.lax.old")), Bytes(7, std::byte('x')));
    // beside a new name it belongs to nobody we know
    make("j.lax", Bytes(8));
    QVERIFY(hasNote(save(*cloud, temp("j.las")), "another file"));
    QVERIFY(fs::exists(temp("j.lax")));
    // the name that it would get is taken by a folder
    save(*cloud, temp("l.las"));
    make("l.lax", Bytes(8));
    fs::create_directories(temp("l.lax.old/folder"));
    QVERIFY(hasNote(save(*cloud, temp("l.las")), "should be removed"));
    QVERIFY(fs::exists(temp("l.lax")));
    // a copy of all chunks leaves it right
    save(*cloud, temp("k.laz"));
    make("k.lax", Bytes(9));
    const auto same = load(temp("k.laz"));
    QVERIFY(save(*same, temp("k.laz")).notes.empty());
    QVERIFY(fs::exists(temp("k.lax")));
    set(*same, "UserData", 0, 1);
    QVERIFY(hasNote(save(*same, temp("k.laz")), ".lax.old"));
}

void LasSaveTest::copcNameIsNamed()
{
    const auto cloud = load(make("c.las", lasfiles::file(lasfiles::header(2, 0, 20, 1), {}, Bytes(20))));
    QVERIFY(hasNote(save(*cloud, temp("c.COPC.laz")), "copc"));
    QVERIFY(save(*cloud, temp("c.laz")).notes.empty());
}

void LasSaveTest::fullDiskIsFoundEarly()
{
    QVERIFY_EXCEPTION_THROWN(las::AtomicFile(temp("huge.las"), std::uint64_t(1) << 60), Error);
    QVERIFY(!fs::exists(temp("huge.las")));
}

QTEST_GUILESS_MAIN(LasSaveTest)
#include "LasSaveTest.moc"
