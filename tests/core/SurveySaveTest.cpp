// SPDX-License-Identifier: MIT
// A survey of three files that is edited and saved by a program that is killed at any moment: what opens it next
// finds all files of one save, and the edits since in the journal. Called with --edit, the test is that program.
#include "core/session/Session.h"
#include "tests/core/LasFiles.h"
#include "tests/core/LoadAndSave.h"

#include <QCoreApplication>
#include <QProcess>
#include <QTemporaryDir>
#include <QTest>

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <random>
#include <string_view>

using namespace punctum;
using lasfiles::Bytes;
namespace fs = std::filesystem;

namespace
{

constexpr std::size_t kPoints = 1201;  // of each file
constexpr std::size_t kAll = 3 * kPoints;
constexpr PointIndex kStep = 7;
constexpr int kEditsBetweenSaves = 2;

std::vector<fs::path> filesOf(const fs::path& folder)
{
    return {folder / "a.las", folder / "b.laz", folder / "c" / "c.las"};
}

void makeFiles(const fs::path& folder)
{
    fs::create_directories(folder / "c");
    std::uint32_t seed = 0;
    for (const fs::path& path : filesOf(folder)) {
        const std::uint8_t format = seed == 2 ? 1 : 7;
        const std::uint16_t length = lasfiles::recordLength(format);
        const Bytes records = lasfiles::randomRecords(format, length, kPoints, ++seed, true);
        lasfiles::writeFile(
            path, las::isCompressedName(path)
                      ? lasfiles::lazFile(format, length, records, 500)
                      : lasfiles::file(lasfiles::header(lasfiles::minorFor(format), format, length, kPoints), {},
                                       records));
    }
}

struct Work {
    Progress progress{};
    std::shared_ptr<Session> session;

    Work(const fs::path& folder, const fs::path& journals)
    {
        HistoryRoom room;
        room.folder = journals;
        session = Session::open(filesOf(folder), room, progress);
        session->read(progress);
    }
    /// The n-th edit, from 1: of points in all files.
    void edit(int n)
    {
        auto points = std::make_shared<PointSet>(kAll);
        for (PointIndex i = PointIndex(n) % kStep; i < kAll; i += kStep) points->insert(i);
        session->edit({"set", {{"rule", "UserData = " + std::to_string(n % 256)}}, points}, progress);
    }
    void save() { session->save({{}, {}, false, {}, {}}, progress); }
};

using Values = std::vector<int>;

Values valuesOf(const PointCloud& cloud)
{
    const Attribute& attribute = *cloud.findAttribute("UserData");
    Values values(kAll);
    for (PointIndex i = 0; i < kAll; ++i) values[i] = int(attribute.number(i));
    return values;
}

Values after(Values values, int edits)
{
    for (int n = 1; n <= edits; ++n)
        for (PointIndex i = PointIndex(n) % kStep; i < kAll; i += kStep) values[i] = n % 256;
    return values;
}

/// Edits and saves until it is killed, and says after each edit that it is there.
int editForever(const fs::path& folder, const fs::path& journals)
{
    Work work(folder, journals);
    for (int n = 1;; ++n) {
        work.edit(n);
        if (const auto warnings = work.session->takeWarnings(); !warnings.empty()) {
            qWarning("%d: %s", n, warnings.front().c_str());
            return 2;
        }
        if (::write(STDOUT_FILENO, ".", 1) != 1) return 1;
        if (n % kEditsBetweenSaves == 0) work.save();
    }
}

}  // namespace

class SurveySaveTest : public QObject
{
    Q_OBJECT
private slots:
    /// Files that others change or take away while the survey is open: asked about, or written again, and no point
    /// is lost.
    void filesThatGoMeanwhile()
    {
        const QTemporaryDir dir;
        const fs::path folder = fs::canonical(dir.path().toStdString());
        makeFiles(folder);
        const std::vector<fs::path> files = filesOf(folder);
        Work work(folder, folder / "journals");
        int n = 0;
        // one becomes shorter, another is replaced by one of the same size: nothing is written before somebody says
        // so
        for (const bool shorter : {true, false}) {
            work.edit(++n);
            const Values edited = valuesOf(*work.session->cloud());
            const std::array<Bytes, 3> before{lasfiles::readFile(files[0]), lasfiles::readFile(files[1]),
                                              lasfiles::readFile(files[2])};
            if (shorter) {
                fs::resize_file(files[1], before[1].size() / 2);
            } else {
                fs::remove(files[1]);
                lasfiles::writeFile(files[1], Bytes(before[1].size()));
            }
            const Bytes theirs = lasfiles::readFile(files[1]);
            try {
                work.save();
                QFAIL("it was not asked");
            } catch (const las::WriteQuestion& question) {
                QVERIFY(question.kind() == las::WriteQuestion::Kind::TargetChanged);
                QVERIFY(question.file() == files[1]);
                QVERIFY2(
                    std::string(question.what()).find("Another program changed this file") != std::string::npos,
                    question.what());
            }
            QVERIFY(lasfiles::readFile(files[0]) == before[0] && lasfiles::readFile(files[1]) == theirs &&
                    lasfiles::readFile(files[2]) == before[2]);
            QVERIFY(valuesOf(*work.session->cloud()) == edited);
            SaveRequest request{{}, {}, false, {}, {}};
            request.options.overwriteChanged = true;
            work.session->save(request, work.progress);
            QVERIFY(valuesOf(*Work(folder, {}).session->cloud()) == edited);
        }
        // one that is gone is written again
        fs::remove(files[0]);
        fs::remove(files[1]);
        work.edit(++n);
        work.save();
        QVERIFY(valuesOf(*Work(folder, {}).session->cloud()) == valuesOf(*work.session->cloud()));
    }

    void nothingIsLostAndNothingIsHalf()
    {
        std::mt19937_64 random(std::random_device{}());
        int most = 0, fromJournal = 0, finished = 0;
        for (int round = 0; round < 100; ++round) {
            const QTemporaryDir dir;
            const fs::path folder = fs::canonical(dir.path().toStdString()), journals = folder / "journals";
            makeFiles(folder);
            const Values before = valuesOf(*Work(folder, {}).session->cloud());
            QProcess child;
            child.setProcessChannelMode(QProcess::ForwardedErrorChannel);
            child.start(QCoreApplication::applicationFilePath(),
                        {QStringLiteral("--edit"), QString::fromStdString(folder.string()),
                         QString::fromStdString(journals.string())});
            QVERIFY(child.waitForReadyRead(30'000));
            QTest::qSleep(int(random() % 100));
            ::kill(pid_t(child.processId()), SIGKILL);
            child.waitForFinished();
            QCOMPARE(child.exitStatus(), QProcess::CrashExit);
            const auto said = int(child.readAllStandardOutput().size());

            // whatever a file is opened with, it is whole
            for (const fs::path& path : filesOf(folder)) lasfiles::load(path);
            Work work(folder, journals);
            const auto& warnings = work.session->survey().warnings();
            finished += std::count_if(warnings.begin(), warnings.end(), [](const std::string& warning) {
                return warning.find("it is finished now") != std::string::npos;
            });
            // all files are of one save: of one that was made after every second edit
            const Values saved = valuesOf(*work.session->cloud());
            int inFiles = -1;
            for (int n = 0; n <= said + 1; n += kEditsBetweenSaves)
                if (saved == after(before, n)) inFiles = n;
            const std::string at = "round " + std::to_string(round) + " after " + std::to_string(said) + " edits";
            QVERIFY2(inFiles >= 0, at.c_str());
            // and the edits since are in the journal
            if (const auto journal = work.session->findJournal(work.progress)) {
                const Replayed replayed = work.session->recover(*journal, work.progress);
                QVERIFY2(replayed.stopped.empty(), (at + ": " + replayed.stopped).c_str());
                ++fromJournal;
            }
            const Values now = valuesOf(*work.session->cloud());
            QVERIFY2(now == after(before, said) || now == after(before, said + 1), at.c_str());
            // it goes on from there
            work.edit(said + 2);
            work.save();
            QVERIFY2(valuesOf(*Work(folder, {}).session->cloud()) == valuesOf(*work.session->cloud()), at.c_str());
            most = std::max(most, said);
        }
        qInfo("up to %d edits before the kill; %d journals were followed, %d saves finished", most, fromJournal,
              finished);
        QVERIFY(most > 2 && fromJournal > 10);
    }
};

int main(int argc, char** argv)
{
    if (argc == 4 && std::string_view(argv[1]) == "--edit") return editForever(argv[2], argv[3]);
    QCoreApplication application(argc, argv);
    SurveySaveTest test;
    return QTest::qExec(&test, argc, argv);
}
#include "SurveySaveTest.moc"
