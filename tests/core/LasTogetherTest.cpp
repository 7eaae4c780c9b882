// SPDX-License-Identifier: MIT
// Several files that are saved together, all or none: what fails or is killed at any moment, and what finishes it.
// Called with --save or --save-forever, the test is the program that is killed.
#include "core/Error.h"
#include "core/SummedText.h"
#include "core/las/FinishSaves.h"
#include "core/las/ManifestFiles.h"
#include "core/las/SaveManifest.h"
#include "core/las/SaveTogether.h"
#include "core/task/Progress.h"
#include "tests/core/Faults.h"
#include "tests/core/LasFiles.h"
#include "tests/core/LoadAndSave.h"

#include <QCoreApplication>
#include <QProcess>
#include <QTemporaryDir>
#include <QTest>

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <optional>
#include <random>
#include <thread>

using namespace punctum;
using lasfiles::Bytes;
using lasfiles::load;
namespace fs = std::filesystem;

namespace
{

constexpr std::size_t kPoints = 2500;
constexpr std::uint16_t kLength = 36;
constexpr std::size_t kUserDataAt = 17;  // of a record of format 7
constexpr const char* kParts[] = {"a.las", "b.laz", "c/c.las"};
using Parts = std::array<Bytes, 3>;

Bytes recordsOf(std::size_t part)
{
    return lasfiles::randomRecords(7, kLength, kPoints, std::uint32_t(part + 1), true);
}

void makeParts(const fs::path& folder)
{
    fs::create_directories(folder / "c");
    for (std::size_t k = 0; k < 3; ++k)
        lasfiles::writeFile(folder / kParts[k],
                            las::isCompressedName(kParts[k])
                                ? lasfiles::lazFile(7, kLength, recordsOf(k), 1000)
                                : lasfiles::file(lasfiles::header(4, 7, kLength, kPoints), {}, recordsOf(k)));
}

Parts readParts(const fs::path& folder)
{
    Parts all;
    for (std::size_t k = 0; k < 3; ++k) all[k] = lasfiles::readFile(folder / kParts[k]);
    return all;
}

std::vector<fs::path> pathsOf(const fs::path& folder)
{
    return {folder / kParts[0], folder / kParts[1], folder / kParts[2]};
}

/// Loads the parts and changes every seventh point of each.
std::vector<std::shared_ptr<PointCloud>> loadAndEdit(const fs::path& folder, std::uint8_t value)
{
    std::vector<std::shared_ptr<PointCloud>> clouds;
    for (const fs::path& path : pathsOf(folder)) {
        clouds.push_back(load(path));
        const auto column = clouds.back()->findAttribute("UserData")->columns[0];
        for (std::size_t i = 0; i < kPoints; i += 7) column->values<std::uint8_t>()[i] = value;
    }
    return clouds;
}

std::vector<las::StagedWrite> stageAll(const std::vector<std::shared_ptr<PointCloud>>& clouds,
                                       const fs::path& folder)
{
    Progress progress;
    std::vector<las::StagedWrite> stages;
    for (std::size_t k = 0; k < clouds.size(); ++k) {
        las::WriteOptions options;
        options.compressed = las::isCompressedName(kParts[k]);
        stages.push_back(las::stage(*clouds[k], folder / kParts[k], options, progress));
    }
    return stages;
}

std::vector<las::WriteReport> saveAll(const std::vector<std::shared_ptr<PointCloud>>& clouds,
                                      const fs::path& folder)
{
    return las::commitTogether(stageAll(clouds, folder));
}

/// The value that every seventh point of all parts has: all other points are those of the beginning. Nothing: they
/// are not of one save.
std::optional<int> valueOfAll(const fs::path& folder)
{
    std::optional<int> value;
    for (std::size_t part = 0; part < 3; ++part) {
        const auto cloud = load(folder / kParts[part]);
        const Attribute& data = *cloud->findAttribute("UserData");
        const Bytes records = recordsOf(part);
        for (PointIndex i = 0; i < kPoints; ++i) {
            const auto now = int(data.number(i));
            if (i % 7 != 0 && now != int(records[i * kLength + kUserDataAt])) return {};
            if (i % 7 == 0 && value.value_or(now) != now) return {};
            if (i % 7 == 0) value = now;
        }
    }
    return value;
}

std::vector<std::string> finish(const fs::path& folder)
{
    return las::finishSaves(pathsOf(folder));
}

int saveAndDie(char** arguments)
{
    const fs::path folder = arguments[2];
    const auto clouds = loadAndEdit(folder, 2);
    auto stages = stageAll(clouds, folder);
    const auto kind =
        std::strcmp(arguments[4], "inside") == 0 ? faults::Kind::KillInside : faults::Kind::KillBefore;
    const faults::Armed armed(folder, std::size_t(std::atoi(arguments[3])), kind, 0);
    las::commitTogether(std::move(stages));
    return 0;
}

int saveForever(const fs::path& folder)
{
    for (int value = 1;; value = value % 250 + 1) {
        saveAll(loadAndEdit(folder, std::uint8_t(value)), folder);
        if (::write(STDOUT_FILENO, ".", 1) != 1) return 1;
    }
}

}  // namespace

class LasTogetherTest : public QObject
{
    Q_OBJECT

private slots:
    void init()
    {
        m_dir = std::make_unique<QTemporaryDir>();
        makeParts(folder());
        saveAll(loadAndEdit(folder(), 1), folder());
        m_before = readParts(folder());
    }

    void allGetTheirNames();
    void changedMeanwhileNoneGetsItsName();
    void oneNameTwiceIsRefused();
    void everyStepFails();
    void namesThatCannotBeTaken();
    void killedAtEveryStep();
    void killedAtRandomMoments();
    void whatOthersChangedStays();
    void whatIsGoneIsSaid();
    void onlyOurOwnIsDone_data();
    void onlyOurOwnIsDone();
    void laterVersionsAreLeftAlone();
    void foldersThatDoNotAgree();
    void goingOnIsWaitedFor();
    void manyFilesCostNothing();

private:
    fs::path folder() const { return fs::canonical(m_dir->path().toStdString()); }
    std::vector<std::string> names() const
    {
        std::vector<std::string> all;
        for (const auto& e : fs::recursive_directory_iterator(folder()))
            all.push_back(e.path().filename().string());
        std::sort(all.begin(), all.end());
        return all;
    }
    /// The parts as a save would write them, and what it writes of the manifest.
    struct Decided {
        std::map<fs::path, std::vector<las::ManifestEntry>> folders;
        Parts after;
    };
    /// Stops a save right after it counted.
    Decided decided()
    {
        const auto clouds = loadAndEdit(folder(), 2);
        auto stages = stageAll(clouds, folder());
        Decided d;
        for (std::size_t k = 0; k < 3; ++k) {
            const fs::path target = folder() / kParts[k];
            for (const auto& e : fs::directory_iterator(target.parent_path())) {
                const std::string name = e.path().filename().string();
                if (!name.starts_with("." + target.filename().string() + ".tmp-")) continue;
                const las::File file(e.path());
                const auto old = las::FileStamp::of(target);
                d.folders[target.parent_path()].push_back({name,
                                                           target.filename().string(),
                                                           las::ContentStamp{old->size, old->modified},
                                                           {file.size(), file.stamp().modified},
                                                           las::digestOfFile(file)});
                d.after[k] = lasfiles::readFile(e.path());
                // what stays when a program is killed: its temporary file is another one by then
                fs::rename(e.path(), folder() / ("kept" + std::to_string(k)));
            }
        }
        stages.clear();
        for (std::size_t k = 0, inFirst = 0; k < 3; ++k) {
            const fs::path parent = (folder() / kParts[k]).parent_path();
            const auto& entry = d.folders[parent][parent == folder() ? inFirst++ : 0];
            fs::rename(folder() / ("kept" + std::to_string(k)), parent / entry.temporary);
        }
        return d;
    }

    std::unique_ptr<QTemporaryDir> m_dir;
    Parts m_before;
};

void LasTogetherTest::allGetTheirNames()
{
    const auto beside = names();
    const auto clouds = loadAndEdit(folder(), 2);
    auto stages = stageAll(clouds, folder());
    QCOMPARE(readParts(folder()), m_before);
    const auto reports = las::commitTogether(std::move(stages));
    QCOMPARE(reports.size(), std::size_t(3));
    QCOMPARE(names(), beside);
    QCOMPARE(valueOfAll(folder()), std::optional(2));
    for (std::size_t k = 0; k < 3; ++k) {
        QCOMPARE(reports[k].points, PointIndex(kPoints));
        QVERIFY(reports[k].notes.empty());
        const las::CurrentFile current = clouds[k]->source()->current->get();
        QVERIFY(current.saved && current.path == folder() / kParts[k]);
        QVERIFY(las::FileStamp::of(current.path) == current.stamp);
    }
    QVERIFY(finish(folder()).empty());
    // they can be saved again, and new names are taken likewise
    saveAll(clouds, folder());
    fs::create_directories(folder() / "new" / "c");
    saveAll(clouds, folder() / "new");
    QCOMPARE(valueOfAll(folder() / "new"), std::optional(2));
    QVERIFY(las::commitTogether({}).empty());
}

void LasTogetherTest::changedMeanwhileNoneGetsItsName()
{
    const auto beside = names();
    const auto clouds = loadAndEdit(folder(), 2);
    auto stages = stageAll(clouds, folder());
    lasfiles::writeFile(folder() / kParts[1], Bytes(10));
    std::string said;
    try {
        las::commitTogether(std::move(stages));
    } catch (const Error& e) {
        said = e.what();
    }
    QVERIFY2(said.starts_with("b.laz: The file was changed by another program"), said.c_str());
    QCOMPARE(names(), beside);
    QCOMPARE(lasfiles::readFile(folder() / kParts[0]), m_before[0]);
    QCOMPARE(lasfiles::readFile(folder() / kParts[2]), m_before[2]);
    QVERIFY(!clouds[0]->source()->current->get().saved);
}

void LasTogetherTest::oneNameTwiceIsRefused()
{
    const auto beside = names();
    const auto clouds = loadAndEdit(folder(), 2);
    fs::create_symlink("a.las", folder() / "link.las");
    Progress progress;
    std::vector<las::StagedWrite> stages;
    stages.push_back(las::stage(*clouds[0], folder() / "a.las", {}, progress));
    stages.push_back(las::stage(*clouds[2], folder() / "link.las", {}, progress));
    QVERIFY_THROWS_EXCEPTION(Error, las::commitTogether(std::move(stages)));
    fs::remove(folder() / "link.las");
    QCOMPARE(names(), beside);
    QCOMPARE(readParts(folder()), m_before);
}

/// What fails once leaves all as it was, or is no failure at all.
void LasTogetherTest::everyStepFails()
{
    const auto beside = names();
    std::size_t steps = 0, failed = 0;
    {
        const auto clouds = loadAndEdit(folder(), 2);
        auto stages = stageAll(clouds, folder());
        const faults::Armed armed(folder(), 0, faults::Kind::Error, 0);
        las::commitTogether(std::move(stages));
        steps = faults::stepsSeen.size();
        QVERIFY(steps > 12);
    }
    for (const int error : {EIO, ENOSPC, EACCES})
        for (std::size_t k = 1; k <= steps; ++k) {
            makeParts(folder());
            const auto before = readParts(folder());
            std::string said, call;
            {
                const auto clouds = loadAndEdit(folder(), 2);
                auto stages = stageAll(clouds, folder());
                const faults::Armed armed(folder(), k, faults::Kind::Error, error);
                try {
                    las::commitTogether(std::move(stages));
                } catch (const Error& e) {
                    said = e.what();
                }
                call = faults::stepsSeen.at(k - 1).call;
            }
            const std::string where =
                "step " + std::to_string(k) + ", " + call + ", errno " + std::to_string(error) + ": " + said;
            failed += said.empty() ? 0 : 1;
            QVERIFY2(said.empty() || said.find("othing was changed") != std::string::npos, where.c_str());
            if (call == "unlink") QVERIFY2(said.empty(), where.c_str());
            QVERIFY2(finish(folder()).empty(), where.c_str());  // nothing, or a manifest that could not be removed
            QVERIFY2(names() == beside, where.c_str());
            if (said.empty())
                QVERIFY2(valueOfAll(folder()) == 2, where.c_str());
            else
                QVERIFY2(readParts(folder()) == before, where.c_str());
        }
    QVERIFY(failed > 10);
}

void LasTogetherTest::namesThatCannotBeTaken()
{
    const auto beside = names();
    for (const std::size_t taken : {0, 1, 2}) {
        makeParts(folder());
        const auto before = readParts(folder());
        const auto clouds = loadAndEdit(folder(), 2);
        std::string said;
        {
            auto stages = stageAll(clouds, folder());
            const faults::Armed armed(folder(), 0, faults::Kind::Error, EACCES);
            faults::failingCall = "rename";
            faults::failingCallSkips = taken + 1;  // the first is that of the manifest in the folder c
            try {
                las::commitTogether(std::move(stages));
            } catch (const Error& e) {
                said = e.what();
            }
        }
        if (taken == 0) {
            QVERIFY2(said.find("nothing was changed") != std::string::npos, said.c_str());
            QCOMPARE(readParts(folder()), before);
            QVERIFY(finish(folder()).empty());
            QCOMPARE(names(), beside);
            continue;
        }
        QVERIFY2(said.find(taken == 1 ? "these are saved: a.las. The others" : "these are saved: a.las, b.laz.") !=
                     std::string::npos,
                 said.c_str());
        QVERIFY(clouds[0]->source()->current->get().saved && !clouds[2]->source()->current->get().saved);
        QVERIFY(!valueOfAll(folder()));
        // who looks at a file that waits for its name hears of it; and it can still not be finished
        {
            const faults::Armed armed(folder(), 0, faults::Kind::Error, EACCES);
            faults::failingCall = "rename";
            const auto sentences = finish(folder());
            QCOMPARE(sentences.size(), std::size_t(1));
            QVERIFY(sentences[0].find("cannot be finished (Permission denied)") != std::string::npos);
        }
        const auto sentences = finish(folder());
        QCOMPARE(sentences.size(), std::size_t(1));
        QVERIFY2(sentences[0].find("A save of 3 files was cut off; it is finished now") == 0, sentences[0].c_str());
        QCOMPARE(valueOfAll(folder()), std::optional(2));
        QCOMPARE(names(), beside);
    }
}

void LasTogetherTest::killedAtEveryStep()
{
    const auto beside = names();
    const Parts before = m_before;
    int olds = 0, news = 0, finished = 0;
    for (const char* where : {"before", "inside"}) {
        bool ended = false;
        for (int k = 1; !ended; ++k) {
            QVERIFY(k < 100);
            for (std::size_t part = 0; part < 3; ++part) lasfiles::writeFile(folder() / kParts[part], before[part]);
            QProcess process;
            process.start(QCoreApplication::applicationFilePath(),
                          {QStringLiteral("--save"), QString::fromStdString(folder().string()), QString::number(k),
                           QString::fromLatin1(where)});
            QVERIFY(process.waitForFinished(60000));
            ended = process.exitStatus() == QProcess::NormalExit;
            if (ended) QCOMPARE(process.exitCode(), 0);
            const std::string at = std::string(where) + " step " + std::to_string(k);
            for (std::size_t part = 0; part < 3; ++part) load(folder() / kParts[part]);  // each is whole
            const bool half = !valueOfAll(folder());
            const auto opened = finish(half && k % 2 == 0 ? folder() / "c" / ".." : folder());
            const auto value = valueOfAll(folder());
            QVERIFY2(value == 1 || value == 2, at.c_str());
            QVERIFY2(!half || (value == 2 && opened.size() == 1), at.c_str());
            (value == 1 ? olds : news) += 1;
            finished += opened.empty() ? 0 : 1;
            // what was written of a save that did not count is named, and nothing else is left
            for (const std::string& name : names()) {
                QVERIFY2(!name.starts_with(".punctum-save") && !name.starts_with("..punctum"), at.c_str());
                if (name.find(".tmp-") == std::string::npos) continue;
                QVERIFY2(value == 1, at.c_str());
            }
            for (const auto& e : fs::recursive_directory_iterator(folder()))
                if (e.path().filename().string().find(".tmp-") != std::string::npos) fs::remove(e.path());
            QCOMPARE(names(), beside);
        }
    }
    qInfo("%d old, %d new, %d told", olds, news, finished);
    QVERIFY(olds > 5 && news > 5 && finished > 5);
}

void LasTogetherTest::killedAtRandomMoments()
{
    std::mt19937_64 random(std::random_device{}());
    int found = 0, most = 0;
    for (int round = 0; round < 100; ++round) {
        QProcess child;
        child.setProcessChannelMode(QProcess::ForwardedErrorChannel);
        child.start(QCoreApplication::applicationFilePath(),
                    {QStringLiteral("--save-forever"), QString::fromStdString(folder().string())});
        QVERIFY(child.waitForReadyRead(30'000));
        QTest::qSleep(int(random() % 120));
        ::kill(pid_t(child.processId()), SIGKILL);
        child.waitForFinished();
        QCOMPARE(child.exitStatus(), QProcess::CrashExit);
        const auto said = int(child.readAllStandardOutput().size());
        const bool half = !valueOfAll(folder());
        const auto sentences = finish(folder());
        const auto value = valueOfAll(folder());
        const std::string at = "round " + std::to_string(round) + " after " + std::to_string(said) + " saves";
        QVERIFY2(value && (*value == said || *value == said + 1), at.c_str());
        QVERIFY2(!half || !sentences.empty(), at.c_str());
        found += sentences.empty() ? 0 : 1;
        most = std::max(most, said);
        for (const auto& e : fs::recursive_directory_iterator(folder()))
            if (e.path().filename().string().find(".tmp-") != std::string::npos) fs::remove(e.path());
        QCOMPARE(names().size(), std::size_t(4));
    }
    qInfo("up to %d saves before the kill; %d were finished afterwards, or had not counted yet", most, found);
}

void LasTogetherTest::whatOthersChangedStays()
{
    const Decided d = decided();
    {
        const las::ManifestFiles manifests(folder() / "a.las", d.folders);
    }
    const Bytes other(5000, std::byte('o'));
    lasfiles::writeFile(folder() / "a.las", other);
    const auto sentences = finish(folder());
    QCOMPARE(sentences.size(), std::size_t(2));
    QVERIFY2(sentences[0].find("b.laz, c.las got what was saved") != std::string::npos, sentences[0].c_str());
    QVERIFY2(sentences[1].find("left as they are: a.las. What was saved is beside them: .a.las.tmp-") !=
                 std::string::npos,
             sentences[1].c_str());
    QCOMPARE(lasfiles::readFile(folder() / "a.las"), other);
    QCOMPARE(lasfiles::readFile(folder() / "b.laz"), d.after[1]);
    QCOMPARE(lasfiles::readFile(folder() / "c/c.las"), d.after[2]);
    QVERIFY(finish(folder()).empty());
    QCOMPARE(names().size(), std::size_t(5));
}

void LasTogetherTest::whatIsGoneIsSaid()
{
    const Decided d = decided();
    {
        const las::ManifestFiles manifests(folder() / "a.las", d.folders);
    }
    const auto& first = d.folders.at(folder());
    fs::remove(folder() / first[0].temporary);
    Bytes damaged = lasfiles::readFile(folder() / first[1].temporary);
    damaged[0] ^= std::byte(1);
    const auto time = fs::last_write_time(folder() / first[1].temporary);
    lasfiles::writeFile(folder() / first[1].temporary, damaged);
    fs::last_write_time(folder() / first[1].temporary, time);
    lasfiles::writeFile(folder() / "c" / "c.lax", Bytes(1));
    const auto sentences = finish(folder());
    QCOMPARE(sentences.size(), std::size_t(3));
    QVERIFY2(sentences[1].find("is gone or damaged: a.las, b.laz.") != std::string::npos, sentences[1].c_str());
    QVERIFY2(sentences[2].find("remove c.lax.") != std::string::npos, sentences[2].c_str());
    QCOMPARE(lasfiles::readFile(folder() / "a.las"), m_before[0]);
    QCOMPARE(lasfiles::readFile(folder() / "b.laz"), m_before[1]);
    QCOMPARE(lasfiles::readFile(folder() / "c/c.las"), d.after[2]);
}

void LasTogetherTest::onlyOurOwnIsDone_data()
{
    QTest::addColumn<QString>("line");  // %1: of the sound one
    QTest::addColumn<bool>("stays");
    const char* const contents = " 3 4 5 6 00000000";
    QTest::newRow("another folder") << QString("file .a.las.tmp-1-01234567 ../a.las") + contents << true;
    QTest::newRow("from another folder") << QString("file c/.a.las.tmp-1-01234567 a.las") + contents << true;
    QTest::newRow("absolute") << QString("file .a.las.tmp-1-01234567 /etc/passwd") + contents << true;
    QTest::newRow("the folder itself") << QString("file ..tmp-1-01234567 .") + contents << true;
    QTest::newRow("no temporary file") << QString("file b.laz a.las") + contents << true;
    QTest::newRow("of another") << QString("file .b.laz.tmp-1-01234567 a.las") + contents << true;
    QTest::newRow("no name") << QString("file % a.las") + contents << true;
    QTest::newRow("NUL") << QString("file .a.las.tmp-1-01234567 a.las%00") + contents << true;
    QTest::newRow("no number") << QString("file .a.las.tmp-1-01234567 a.las x 4 5 6 00000000") << true;
    QTest::newRow("a number too large")
        << QString("file .a.las.tmp-1-01234567 a.las 99999999999999999999999 4 5 6 00000000") << true;
    QTest::newRow("too few words") << QString("file .a.las.tmp-1-01234567 a.las 3 4 5 6") << true;
    QTest::newRow("another word") << QString("delete .a.las.tmp-1-01234567 a.las") << true;
    QTest::newRow("a folder that is none") << QString("folder c") << true;
    QTest::newRow("its own folder") << QString("folder %1") << false;
    QTest::newRow("twice the end") << QString("end 3") << true;
}

void LasTogetherTest::onlyOurOwnIsDone()
{
    QFETCH(QString, line);
    QFETCH(bool, stays);
    const std::string asked =
        line.replace("%1", QString::fromStdString(escapedWord(folder().string()))).toStdString();
    const auto beside = names();
    std::uint32_t sum = 0;
    std::string text = summed("punctum-save 1", sum);
    text += summed(asked, sum);
    text += summed("end 1", sum);
    const fs::path manifest = folder() / ".punctum-save-999999999-01234567";
    const auto bytes = std::as_bytes(std::span(text));
    lasfiles::writeFile(manifest, Bytes(bytes.begin(), bytes.end()));
    const auto sentences = finish(folder());
    QCOMPARE(sentences.size(), stays ? std::size_t(1) : std::size_t(0));
    if (stays) QVERIFY2(sentences[0].find("not to be trusted") != std::string::npos, sentences[0].c_str());
    QCOMPARE(fs::exists(manifest), stays);
    fs::remove(manifest);
    QCOMPARE(names(), beside);
    QCOMPARE(readParts(folder()), m_before);
}

void LasTogetherTest::laterVersionsAreLeftAlone()
{
    std::uint32_t sum = 0;
    const std::string text = summed("punctum-save 2", sum);
    const fs::path manifest = folder() / ".punctum-save-999999999-01234567";
    const auto write = [&](const std::string& what) {
        const auto bytes = std::as_bytes(std::span(what));
        lasfiles::writeFile(manifest, Bytes(bytes.begin(), bytes.end()));
    };
    write(text);
    QCOMPARE(finish(folder()).size(), std::size_t(1));
    QVERIFY(fs::exists(manifest));
    // cut off at every byte, one of ours never counted
    const Decided d = decided();
    const std::string whole = las::manifestText({{}, {}, d.folders.at(folder()), 2});
    for (std::size_t n = 0; n < whole.size(); n += 7) {
        write(whole.substr(0, n));
        QCOMPARE(finish(folder()),
                 std::vector<std::string>{"A save of several files was cut off before it counted: they are as they "
                                          "were before."});
        QVERIFY(!fs::exists(manifest));
    }
    std::string flipped = whole;
    flipped[whole.find("file ") + 20] ^= 1;
    write(flipped);
    QCOMPARE(finish(folder()).size(), std::size_t(1));
    QCOMPARE(readParts(folder()), m_before);
    write(whole);
    QCOMPARE(finish(folder()).size(), std::size_t(1));
    QCOMPARE(lasfiles::readFile(folder() / "a.las"), d.after[0]);
}

void LasTogetherTest::foldersThatDoNotAgree()
{
    const std::string name = ".punctum-save-999999999-01234567";
    const auto write = [&](const fs::path& where, const las::SaveManifest& manifest) {
        const std::string text = las::manifestText(manifest);
        const auto bytes = std::as_bytes(std::span(text));
        lasfiles::writeFile(where / name, Bytes(bytes.begin(), bytes.end()));
    };
    const Decided d = decided();
    const fs::path c = folder() / "c";
    const auto& inC = d.folders.at(c);
    // the one that decides is gone: it did not count
    write(c, {folder(), {}, inC, 3});
    QCOMPARE(finish(folder()).size(), std::size_t(1));
    QVERIFY(!fs::exists(c / name));
    // it decides of others alone
    write(c, {folder(), {}, inC, 3});
    write(folder(), {{}, {}, d.folders.at(folder()), 3});
    QVERIFY(las::finishSaves(std::vector{c})[0].find("not to be trusted") != std::string::npos);
    // its folder is not there
    write(c, {"/nowhere/at/all", {}, inC, 3});
    QVERIFY(las::finishSaves(std::vector{c})[0].find("/nowhere/at/all, which is not there now") !=
            std::string::npos);
    QVERIFY(fs::exists(c / name));
    QCOMPARE(readParts(folder()), m_before);
    // and here another folder is not there: what is here is finished, and the rest later
    write(folder(), {{}, {"/nowhere/at/all", c}, d.folders.at(folder()), 3});
    write(c, {folder(), {}, inC, 3});
    QCOMPARE(las::finishSaves(std::vector{c}).size(), std::size_t(2));
    QCOMPARE(readParts(folder()), d.after);
    QVERIFY(fs::exists(folder() / name) && fs::exists(c / name));
    write(folder(), {{}, {c}, d.folders.at(folder()), 3});
    QVERIFY(finish(folder()).empty());  // all have their names: nothing to be said
    QVERIFY(!fs::exists(folder() / name) && !fs::exists(c / name));
}

void LasTogetherTest::goingOnIsWaitedFor()
{
    const Decided d = decided();
    auto manifests = std::make_unique<las::ManifestFiles>(folder() / "a.las", d.folders);
    std::thread ends([&] {
        QTest::qSleep(150);
        manifests.reset();
    });
    const auto begun = std::chrono::steady_clock::now();
    const auto sentences = finish(folder());
    const auto waited = std::chrono::steady_clock::now() - begun;
    ends.join();
    QVERIFY(waited > std::chrono::milliseconds(100));
    QCOMPARE(sentences.size(), std::size_t(1));
    QCOMPARE(readParts(folder()), d.after);
    QCOMPARE(names().size(), std::size_t(4));
}

void LasTogetherTest::manyFilesCostNothing()
{
    constexpr int kMany = 10'000;
    const fs::path many = folder() / "many";
    fs::create_directory(many);
    std::vector<fs::path> paths;
    for (int k = 0; k < kMany; ++k) {
        paths.push_back(many / (std::to_string(k) + ".laz"));
        lasfiles::writeFile(paths.back(), Bytes(1));
    }
    const auto begun = std::chrono::steady_clock::now();
    QVERIFY(las::finishSaves(paths).empty());
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - begun;
    qInfo("%d files of one folder: %.1f ms", kMany, took.count());
    QVERIFY2(took.count() < 2000, std::to_string(took.count()).c_str());
}

int main(int argc, char** argv)
{
    if (argc == 5 && std::strcmp(argv[1], "--save") == 0) return saveAndDie(argv);
    if (argc == 3 && std::strcmp(argv[1], "--save-forever") == 0) return saveForever(argv[2]);
    QCoreApplication application(argc, argv);
    LasTogetherTest test;
    return QTest::qExec(&test, argc, argv);
}

#include "LasTogetherTest.moc"
