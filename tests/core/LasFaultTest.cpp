// SPDX-License-Identifier: MIT
#include "core/Error.h"
#include "core/edit/CloudKey.h"
#include "core/edit/Journal.h"
#include "core/las/AtomicFile.h"
#include "core/las/Leftovers.h"
#include "core/las/Reader.h"
#include "core/las/Repair.h"
#include "core/las/Writer.h"
#include "core/task/Progress.h"
#include "tests/core/BadInputs.h"
#include "tests/core/Complaint.h"
#include "tests/core/Faults.h"

#include <QCoreApplication>
#include <QProcess>
#include <QTemporaryDir>
#include <QTest>

#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/xattr.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <functional>

using namespace punctum;
using lasfiles::Bytes;
namespace fs = std::filesystem;

/// Saves that fail at every step they can fail at: the original stays as it was, nothing is left beside it, and one
/// sentence says why. Saves that are killed at every step.
class LasFaultTest : public QObject
{
    Q_OBJECT

private slots:
    void everyStepFails_data();
    void everyStepFails();
    void killedAtEveryStep_data();
    void killedAtEveryStep();
    void leftoversOfLongNames();
    void fileSizeLimit_data();
    void fileSizeLimit();
    void fullFileSystem();
    void wrongBytesAreFound_data() { kinds(); }
    void wrongBytesAreFound();
    void accessThatCannotBeKept();
    void otherCallsThatFail();
    void readsFail_data();
    void readsFail();

private:
    fs::path folder() const { return fs::canonical(m_dir.path().toStdString()); }
    static void kinds()
    {
        QTest::addColumn<bool>("compressed");
        QTest::newRow("LAS") << false;
        QTest::newRow("LAZ") << true;
    }
    std::vector<std::string> names() const
    {
        std::vector<std::string> all;
        for (const auto& e : fs::directory_iterator(folder())) all.push_back(e.path().filename().string());
        std::sort(all.begin(), all.end());
        return all;
    }
    QTemporaryDir m_dir;
};

namespace
{

constexpr std::size_t kPlainPoints = 31000;      ///< two blocks, which are written one by one
constexpr std::size_t kCompressedPoints = 2500;  ///< three chunks
constexpr std::uint16_t kLength = 36;
constexpr const char* kSaveArgument = "--save";

/// Points, records around them and a tail: every part that a save writes.
Bytes original(bool compressed)
{
    const std::size_t count = compressed ? kCompressedPoints : kPlainPoints;
    const Bytes points = lasfiles::randomRecords(7, kLength, count, 3, true);
    Bytes head = lasfiles::header(4, 7, kLength, count);
    lasfiles::set<std::uint16_t>(head, 6, 16);
    const Bytes evlr = lasfiles::record("late", 1, Bytes(500, std::byte('e')), true);
    if (compressed) {
        Bytes b = lasfiles::lazFile(7, kLength, points, 1000);
        lasfiles::set<std::uint16_t>(b, 6, 16);
        lasfiles::set<std::uint64_t>(b, 235, b.size());
        lasfiles::set<std::uint32_t>(b, 243, 1);
        lasfiles::append(b, evlr);
        return b;
    }
    lasfiles::set<std::uint64_t>(head, 235, head.size() + 54 + 20 + points.size());
    lasfiles::set<std::uint32_t>(head, 243, 1);
    return lasfiles::file(head, {lasfiles::record("early", 1, Bytes(20))}, points, evlr);
}

/// The oldest LAZ: one stream, which says that its items are of version 1, so that LASzip reads it from the file.
Bytes oldStream()
{
    constexpr std::size_t kItemVersion = 38, kItemBytes = 6, kItems = 2;
    Bytes b = lasfiles::lazFile(2, 26, lasfiles::randomRecords(2, 26, kCompressedPoints, 5, true), 50000);
    const std::size_t begin = lasfiles::bad::pointOffset(b);
    b.resize(lasfiles::bad::tableAt(b));
    b.erase(b.begin() + std::ptrdiff_t(begin), b.begin() + std::ptrdiff_t(begin) + 8);
    for (std::size_t k = 0; k < kItems; ++k)
        b = lasfiles::bad::withLaszip<std::uint16_t>(b, kItemVersion + kItemBytes * k, 1);
    return lasfiles::bad::withLaszip<std::uint16_t>(b, 0, 1);
}

std::shared_ptr<PointCloud> loadAndEdit(const fs::path& path)
{
    Progress progress;
    auto cloud = las::load(path, progress);
    const auto classes = cloud->findAttribute("Classification")->columns[0];
    for (std::size_t i = 0; i < cloud->size(); i += 7) classes->values<std::uint8_t>()[i] = 6;
    return cloud;
}

las::WriteReport save(const PointCloud& cloud, const fs::path& path)
{
    las::WriteOptions options;
    options.compressed = las::isCompressedName(path);
    Progress progress;
    return las::write(cloud, path, options, progress);
}

/// What this program does when it runs itself: saves a file and is killed at a step of it.
int saveAndDie(char** arguments)
{
    const fs::path path = arguments[2];
    const auto cloud = loadAndEdit(path);
    const auto kind =
        std::strcmp(arguments[4], "inside") == 0 ? faults::Kind::KillInside : faults::Kind::KillBefore;
    const faults::Armed armed(path.parent_path(), std::size_t(std::atoi(arguments[3])), kind, 0);
    save(*cloud, path);
    return 0;
}

}  // namespace

void LasFaultTest::everyStepFails_data()
{
    kinds();
}

void LasFaultTest::everyStepFails()
{
    QFETCH(bool, compressed);
    const fs::path path = folder() / (compressed ? "a.laz" : "a.las");
    const Bytes before = original(compressed);
    lasfiles::writeFile(path, before);
    std::vector<faults::Step> steps;
    {
        const auto cloud = loadAndEdit(path);
        const faults::Armed armed(folder(), 0, faults::Kind::Error, 0);
        save(*cloud, path);
        steps = faults::stepsSeen;
    }
    const Bytes after = lasfiles::readFile(path);
    QVERIFY(after != before);
    const auto count = [&](const char* call) {
        return std::count_if(steps.begin(), steps.end(), [&](const faults::Step& s) { return s.call == call; });
    };
    QVERIFY(count("pwrite") >= 4 && count("fsync") == 2 && count("rename") == 1);

    const std::tuple<faults::Kind, int, const char*> ways[] = {{faults::Kind::Error, ENOSPC, "disk is full"},
                                                               {faults::Kind::Error, EIO, "error"},
                                                               {faults::Kind::Error, EINTR, ""},
                                                               {faults::Kind::Short, 0, ""},
                                                               {faults::Kind::Nothing, 0, "disk is full"}};
    for (std::size_t k = 1; k <= steps.size(); ++k) {
        const faults::Step& step = steps[k - 1];
        for (const auto& [kind, error, said] : ways) {
            if (kind != faults::Kind::Error && step.call != "pwrite") continue;
            lasfiles::writeFile(path, before);
            const auto cloud = loadAndEdit(path);
            const auto beside = names();
            std::string sentence;
            try {
                const faults::Armed armed(folder(), k, kind, error);
                save(*cloud, path);
            } catch (const Error& e) {
                sentence = e.what();
            }
            const std::string where = "step " + std::to_string(k) + ", " + step.call +
                                      (step.folder ? " of the folder" : "") + ", errno " + std::to_string(error) +
                                      ": " + sentence;
            // Interrupted and short writes go on, and a folder that cannot be synced has the file all the same.
            const bool must = !step.folder && kind != faults::Kind::Short && error != EINTR &&
                              (step.call == "pwrite" || step.call == "fsync" || step.call == "rename" ||
                               step.call == "ftruncate" || step.call == "fchmod");
            const bool mustNot = step.call == "pwrite" && !must;
            QVERIFY2(!must || sentence.find(said) != std::string::npos, where.c_str());
            QVERIFY2(!must || !sentence.empty(), where.c_str());
            QVERIFY2(!mustNot || sentence.empty(), where.c_str());
            QVERIFY2(sentence.empty() || (sentence.starts_with(path.filename().string() + ": ") &&
                                          sentence.ends_with('.') && sentence.find('\n') == std::string::npos),
                     where.c_str());
            QVERIFY2(lasfiles::readFile(path) == (sentence.empty() ? after : before), where.c_str());
            QVERIFY2(names() == beside, where.c_str());
            if (!sentence.empty() && error == EIO) {  // the document is as it was: it can be saved now
                save(*cloud, path);
                QVERIFY2(lasfiles::readFile(path) == after, where.c_str());
            }
        }
    }
}

void LasFaultTest::killedAtEveryStep_data()
{
    kinds();
}

void LasFaultTest::killedAtEveryStep()
{
    QFETCH(bool, compressed);
    const fs::path path = folder() / (compressed ? "k.laz" : "k.las");
    const Bytes before = original(compressed);
    lasfiles::writeFile(path, before);
    save(*loadAndEdit(path), path);
    const Bytes after = lasfiles::readFile(path);
    int replaced = 0, left = 0;
    for (const char* where : {"before", "inside"}) {
        bool ended = false;
        for (int k = 1; !ended; ++k) {
            QVERIFY(k < 100);
            lasfiles::writeFile(path, before);
            const auto beside = names();
            QProcess process;
            process.start(QCoreApplication::applicationFilePath(),
                          {kSaveArgument, QString::fromStdString(path.string()), QString::number(k), where});
            QVERIFY(process.waitForFinished(60000));
            ended = process.exitStatus() == QProcess::NormalExit;
            if (ended) QCOMPARE(process.exitCode(), 0);
            const Bytes now = lasfiles::readFile(path);
            QVERIFY2(now == before || now == after, where);
            replaced += now == after ? 1 : 0;

            auto more = names();
            QVERIFY(more.size() <= beside.size() + 1);
            if (more.size() == beside.size()) continue;
            std::erase_if(more, [&](const std::string& n) {
                return std::find(beside.begin(), beside.end(), n) != beside.end();
            });
            QVERIFY(more.size() == 1 && more[0].starts_with("." + path.filename().string() + ".tmp-"));
            ++left;
            // What is left is named when the file is opened and when it is saved, and is not touched.
            const auto reader = las::Reader::open(path);
            QVERIFY(mentions(reader->source()->warnings, more[0]));
            QVERIFY(!reader->source()->recovered);
            QVERIFY(mentions(save(*loadAndEdit(path), path).notes, more[0]));
            QVERIFY(lasfiles::readFile(path) == after);
            QVERIFY(fs::remove(folder() / more[0]));
            QVERIFY(!mentions(las::Reader::open(path)->source()->warnings, "cut off"));
        }
    }
    QVERIFY(left > 5 && replaced >= 2);
}

void LasFaultTest::leftoversOfLongNames()
{
    // Other files are no leftovers: of a running process, of another name, of another form.
    const fs::path path = folder() / "b.las";
    lasfiles::writeFile(path, original(false));
    for (const std::string& name :
         {".b.las.tmp-" + std::to_string(::getpid()) + "-0123abcd", std::string(".b.las.tmp-1-0123abcd"),
          std::string(".bb.las.tmp-999999999-0123abcd"), std::string(".b.las.tmp-x"),
          std::string(".b.las.tmp-999999999-0123abc"), std::string(".b.las.tmp-999999999-0123abcg")})
        lasfiles::writeFile(folder() / name, Bytes(1));
    QVERIFY(las::Reader::open(path)->source()->warnings.empty());
    lasfiles::writeFile(folder() / ".b.las.tmp-999999999-0123abcd", Bytes(1));
    QVERIFY(mentions(las::Reader::open(path)->source()->warnings, ".b.las.tmp-999999999-0123abcd"));

    // For many files a folder is looked through once.
    las::FolderLeftovers once;
    QCOMPARE(once.of(path).size(), std::size_t(1));
    QVERIFY(once.of(folder() / "c.las").empty());
    QVERIFY(!mentions(las::Reader::open(path, nullptr)->source()->warnings, "cut off"));
    QVERIFY(mentions(las::Reader::open(path, &once)->source()->warnings, ".b.las.tmp-999999999-0123abcd"));

    // A name that leaves no room for more has its leftovers under a common one.
    const fs::path longName = folder() / (std::string(251, 'x') + ".las");
    lasfiles::writeFile(longName, original(false));
    QVERIFY(las::Reader::open(longName)->source()->warnings.empty());
    lasfiles::writeFile(folder() / ".punctum.tmp-999999999-0123abcd", Bytes(1));
    QVERIFY(mentions(las::Reader::open(longName)->source()->warnings, ".punctum.tmp-999999999"));
}

void LasFaultTest::fileSizeLimit_data()
{
    kinds();
}

void LasFaultTest::fileSizeLimit()
{
    QFETCH(bool, compressed);
    const fs::path path = folder() / (compressed ? "l.laz" : "l.las");
    const Bytes before = original(compressed);
    lasfiles::writeFile(path, before);
    save(*loadAndEdit(path), path);
    const Bytes after = lasfiles::readFile(path);
    lasfiles::writeFile(path, before);
    const auto cloud = loadAndEdit(path);
    const auto beside = names();
    const std::size_t head = lasfiles::get<std::uint32_t>(after, 96);
    std::vector<std::size_t> limits = {0,
                                       1,
                                       226,
                                       375,
                                       head - 1,
                                       head,
                                       head + 1,
                                       head + 9,
                                       after.size() - 561,
                                       after.size() - 560,
                                       after.size() - 1};
    for (std::size_t k = 1; k < 20; ++k) limits.push_back(after.size() * k / 20);
    struct rlimit was {
    };
    QCOMPARE(::getrlimit(RLIMIT_FSIZE, &was), 0);
    for (const std::size_t limit : limits) {
        const struct rlimit low {
            rlim_t(limit), was.rlim_max
        };
        std::string said;
        ::setrlimit(RLIMIT_FSIZE, &low);
        try {
            save(*cloud, path);
        } catch (const Error& e) {
            said = e.what();
        }
        ::setrlimit(RLIMIT_FSIZE, &was);
        QVERIFY2(said.find("too large for this disk; nothing was changed.") != std::string::npos,
                 (std::to_string(limit) + ": " + said).c_str());
        QVERIFY(lasfiles::readFile(path) == before);
        QCOMPARE(names(), beside);
    }
    save(*cloud, path);
    QVERIFY(lasfiles::readFile(path) == after);
}

void LasFaultTest::fullFileSystem()
{
    const fs::path disk = folder() / "disk";
    fs::create_directory(disk);
    if (::mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=128k") != 0) QSKIP("no file system can be mounted here");
    struct Unmount {
        fs::path path;
        ~Unmount() { ::umount(path.c_str()); }
    };
    const Unmount unmount{disk};
    const fs::path source = folder() / "big.las";
    lasfiles::writeFile(source, original(false));
    const auto cloud = loadAndEdit(source);
    for (const char* name : {"small.las", "small.laz"}) {
        const fs::path target = disk / name;
        const Bytes small(1000, std::byte('s'));
        lasfiles::writeFile(target, small);
        std::string said;
        try {
            save(*cloud, target);
        } catch (const Error& e) {
            said = e.what();
        }
        QVERIFY2(said.starts_with(std::string(name) + ": ") && (said.find("disk is full") != std::string::npos ||
                                                                said.find("not enough room") != std::string::npos),
                 said.c_str());
        QVERIFY(lasfiles::readFile(target) == small);
        fs::remove(target);
        QVERIFY(fs::is_empty(disk));
    }
}

void LasFaultTest::wrongBytesAreFound()
{
    QFETCH(bool, compressed);
    const std::string ending = compressed ? ".laz" : ".las";
    const fs::path path = folder() / ("w" + ending), repaired = folder() / ("repaired" + ending);
    Bytes before = original(compressed);
    lasfiles::set<std::uint32_t>(before, 107, 77);  // a fault to repair: formats 6 to 10 have no legacy count
    const auto saves = [&] { save(*loadAndEdit(path), path); };
    const auto repairs = [&] {
        Progress progress;
        las::repair(path, repaired, progress);
    };
    for (const std::function<void()>& work : {std::function<void()>(saves), std::function<void()>(repairs)}) {
        lasfiles::writeFile(path, before);
        std::size_t steps = 0;
        {
            const faults::Armed armed(folder(), 0, faults::Kind::Error, 0);
            work();
            steps = faults::stepsSeen.size();
        }
        fs::remove(repaired);
        std::size_t found = 0;
        for (std::size_t k = 1; k <= steps; ++k) {
            lasfiles::writeFile(path, before);
            const auto beside = names();
            std::string call, said;
            try {
                const faults::Armed armed(folder(), k, faults::Kind::Wrong, 0);
                work();
            } catch (const Error& e) {
                said = e.what();
            }
            call = faults::stepsSeen.at(k - 1).call;
            if (call != "pwrite") {
                fs::remove(repaired);
                continue;
            }
            const std::string where = "step " + std::to_string(k) + ": " + said;
            QVERIFY2(!said.empty() && said.find('\n') == std::string::npos, where.c_str());
            QVERIFY2(lasfiles::readFile(path) == before && names() == beside, where.c_str());
            ++found;
        }
        QVERIFY(found >= 2);
    }
}

void LasFaultTest::accessThatCannotBeKept()
{
    const fs::path path = folder() / "access.las";
    lasfiles::writeFile(path, original(false));
    const bool attributes = ::setxattr(path.c_str(), "user.origin", "x", 1, 0) == 0;
    QCOMPARE(::chmod(path.c_str(), 0664), 0);
    const auto saved = [&](const char* call) {
        const auto cloud = loadAndEdit(path);
        const faults::Armed armed(folder(), 0, faults::Kind::Error, EPERM);
        faults::failingCall = call;
        return save(*cloud, path).notes;
    };
    const auto mode = [&] { return unsigned(fs::status(path).permissions()); };
    if (attributes) QVERIFY(mentions(saved("fsetxattr"), "could not be kept: user.origin."));
    QCOMPARE(mode(), 0664u);
    const auto notes = saved("fchown");
    QVERIFY(mentions(notes, "now belongs to you") && mentions(notes, "its group has none now"));
    QCOMPARE(mode(), 0604u);
}

void LasFaultTest::otherCallsThatFail()
{
    const fs::path path = folder() / "a.journal";
    const auto told = [&](const char* call, int error, const std::function<void()>& work) -> std::string {
        const faults::Armed armed(folder(), 0, faults::Kind::Error, error);
        faults::failingCall = call;
        try {
            work();
        } catch (const Error& e) {
            return e.what();
        }
        return {};
    };
    const auto begin = [&] { Journal::create(path, {1, 1}, "a"); };
    const auto goOn = [&] { Journal::resume(path); };
    QVERIFY(told("fsync", EIO, begin).find("the journal cannot be written") != std::string::npos);
    QVERIFY(told("fsync", EINVAL, begin).empty());  // nothing to be synced there
    QVERIFY(told("ftruncate", EIO, goOn).find("the journal cannot be written") != std::string::npos);
    las::AtomicFile file(folder() / "a.las", 0);
    QVERIFY(told("ftruncate", ENOSPC, [&] { file.resize(0); }).find("disk is full") != std::string::npos);
    const faults::Armed armed(folder(), 1, faults::Kind::Error, EINTR);
    file.resize(10);
    QCOMPARE(fs::file_size(file.temporary()), std::uintmax_t(10));
    QCOMPARE(faults::stepsSeen.size(), std::size_t(2));
}

void LasFaultTest::readsFail_data()
{
    QTest::addColumn<QString>("kind");
    for (const char* kind : {"LAS", "LAZ", "one stream"}) QTest::newRow(kind) << kind;
}

void LasFaultTest::readsFail()
{
    // A disk that cannot be read is no damage of the file: whatever is read when, the sentence says what it is.
    QFETCH(QString, kind);
    const bool saves = kind != "one stream";
    const std::string ending = kind == "LAS" ? ".las" : ".laz";
    const fs::path path = folder() / ("r" + ending), copy = folder() / ("copy" + ending);
    lasfiles::writeFile(path, saves ? original(kind == "LAZ") : oldStream());
    const auto work = [&] {
        const auto cloud = loadAndEdit(path);
        if (saves) save(*cloud, copy);
    };
    std::size_t steps = 0;
    {
        const faults::Armed armed(folder(), 0, faults::Kind::Error, 0, true);
        work();
        steps = faults::stepsSeen.size();
    }
    const Bytes whole = saves ? lasfiles::readFile(copy) : Bytes();
    fs::remove(copy);
    const auto beside = names();
    QVERIFY(steps > 5);
    std::size_t refused = 0;
    const std::tuple<faults::Kind, int> ways[] = {
        {faults::Kind::Error, EIO}, {faults::Kind::Error, EINTR}, {faults::Kind::Short, 0}};
    for (std::size_t k = 1; k <= steps; ++k)
        for (const auto& [fault, error] : ways) {
            std::string said;
            try {
                const faults::Armed armed(folder(), k, fault, error, true);
                work();
            } catch (const Error& e) {
                said = e.what();
            }
            const std::string where =
                "read " + std::to_string(k) + ", errno " + std::to_string(error) + ": " + said;
            if (said.empty()) {  // chunks of the file that cannot be copied are compressed anew
                QVERIFY2(error != EIO || kind == "LAZ", where.c_str());
                QVERIFY2(!saves || lasfiles::readFile(copy) == whole, where.c_str());
                fs::remove(copy);
            } else {
                QVERIFY2(error == EIO, where.c_str());
                QVERIFY2(said.find("cannot be read: Input/output error") != std::string::npos, where.c_str());
                ++refused;
            }
            QVERIFY2(names() == beside, where.c_str());
        }
    QVERIFY(refused > steps / 2);
}

int main(int argc, char** argv)
{
    if (argc == 5 && std::strcmp(argv[1], kSaveArgument) == 0) return saveAndDie(argv);
    QCoreApplication app(argc, argv);
    LasFaultTest test;
    return QTest::qExec(&test, argc, argv);
}

#include "LasFaultTest.moc"
