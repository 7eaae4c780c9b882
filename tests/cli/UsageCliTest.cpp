// SPDX-License-Identifier: MIT
// How the program behaves as a program: exit codes, help, one sentence for each failure, nothing left behind.
#include "tests/cli/Program.h"

#include <QElapsedTimer>
#include <QRegularExpression>
#include <QTemporaryDir>

#include <csignal>

using namespace punctum::test;

namespace
{

const QStringList kCommands{"info", "repair", "convert", "diff", "render", "process", "sample", "bench"};
const QStringList kBenchmarks{"load", "save", "render", "attribute", "edit", "process"};

/// Every command line that has a help of its own.
QList<QStringList> helpful()
{
    QList<QStringList> all{{}};
    for (const QString& command : kCommands) all << QStringList{command};
    for (const QString& what : kBenchmarks) all << QStringList{"bench", what};
    return all;
}

}  // namespace

class UsageCliTest : public QObject
{
    Q_OBJECT

private:
    QTemporaryDir m_folder;
    QString path(const QString& name) const { return m_folder.filePath(name); }
    QStringList entries(const QString& folder) const
    {
        return QDir(folder).entryList(QDir::AllEntries | QDir::Hidden | QDir::NoDotAndDotDot);
    }

private slots:
    void initTestCase()
    {
        PUNCTUM_EXIT(runPunctum({"sample", path("in.las"), "--points", "20000"}), 0);
        PUNCTUM_EXIT(runPunctum({"sample", path("in.laz"), "--points", "20000"}), 0);
    }

    void helpsWithEverything()
    {
        for (const QStringList& command : helpful()) {
            const Outcome run = runPunctum(command + QStringList{"--help"});
            PUNCTUM_EXIT(run, 0);
            QVERIFY(run.out.contains("--help") && run.out.contains("Usage:"));
            QVERIFY(run.err.isEmpty());
            QCOMPARE(runPunctum(command + QStringList{"-h"}).out, run.out);
            const Outcome version = runPunctum(command + QStringList{"--version"});
            PUNCTUM_EXIT(version, 0);
            QVERIFY(QRegularExpression("^punctum \\d+\\.\\d+\\.\\d+\n$").match(version.out).hasMatch());
        }
        const QByteArray help = runPunctum({"--help"}).out;
        for (const QString& command : kCommands) QVERIFY(help.contains(command.toUtf8()));
        for (const char* option : {"--backend", "--order", "--budget", "--budget-points"})
            QVERIFY(help.contains(option));
    }

    void saysWhatAValueMustBe()
    {
        const auto said = [](const QStringList& words) {
            const Outcome run = runPunctum(QStringList{"render", "a.las", "-o", "a.png"} + words);
            return run.exitCode == 2 && run.oneSentence() ? run.err : QString();
        };
        QVERIFY(said({"--point-size", "0"}).contains("--point-size must be from 0.1 to 64, not \"0\". See"));
        QVERIFY(said({"--normals", "up"}).contains("--normals must be one of lit, colors, not \"up\". See"));
        QVERIFY(said({"--bands", "5", "--bands", "6"}).contains("--bands is given more than once. See"));
    }

    void hasAManPageThatNamesEveryOption()
    {
        QString page = QString::fromUtf8(contentOf(QString(PUNCTUM_SOURCE_DIR) + "/packaging/punctum.1"));
        QVERIFY(!page.isEmpty());
        page.replace("\\-", "-");
        const QRegularExpression option("(?<![\\w-])--[a-z][a-z-]+");
        for (const QStringList& command : helpful()) {
            const QString help = QString::fromUtf8(runPunctum(command + QStringList{"--help"}).out);
            for (auto found = option.globalMatch(help); found.hasNext();) {
                const QString name = found.next().captured();
                QVERIFY2(page.contains(name), qPrintable("punctum " + command.join(' ') + ": " + name));
            }
        }
        for (const QString& command : kCommands + kBenchmarks)
            QVERIFY2(page.contains(command), qPrintable(command));
    }

    void exitsWith2OnWrongUsage_data()
    {
        QTest::addColumn<QStringList>("arguments");
        const QString in = path("in.las");
        QTest::newRow("unknown command") << QStringList{"inof", in};
        QTest::newRow("unknown option") << QStringList{"--frobnicate"};
        QTest::newRow("unknown option of a command") << QStringList{"info", "--frobnicate", in};
        QTest::newRow("info without file") << QStringList{"info"};
        QTest::newRow("convert without target") << QStringList{"convert", in};
        QTest::newRow("convert to no cloud") << QStringList{"convert", in, path("out.txt")};
        QTest::newRow("convert to LAS 1.7") << QStringList{"convert", in, path("out.las"), "--las-version", "1.7"};
        QTest::newRow("convert to format 11")
            << QStringList{"convert", in, path("out.las"), "--point-format", "11"};
        QTest::newRow("render without picture") << QStringList{"render", in};
        QTest::newRow("render to no picture") << QStringList{"render", in, "-o", path("out.doc")};
        const QStringList render{"render", in, "-o", path("out.png")};
        QTest::newRow("size") << render + QStringList{"--size", "big"};
        QTest::newRow("size of nothing") << render + QStringList{"--size", "0x100"};
        QTest::newRow("size of too much") << render + QStringList{"--size", "100000x100000"};
        QTest::newRow("3 samples") << render + QStringList{"--samples", "3"};
        QTest::newRow("backend") << render + QStringList{"--backend", "abacus"};
        QTest::newRow("color map") << render + QStringList{"--color-map", "mud"};
        QTest::newRow("range") << render + QStringList{"--range", "5"};
        QTest::newRow("range upside down") << render + QStringList{"--range", "5:1"};
        QTest::newRow("view") << render + QStringList{"--view", "inside"};
        QTest::newRow("background") << render + QStringList{"--background", "greenish"};
        QTest::newRow("bands") << render + QStringList{"--bands", "1"};
        QTest::newRow("process without step") << QStringList{"process", in, "-o", path("out.las")};
        QTest::newRow("process without target") << QStringList{"process", in, "--step", "normals"};
        QTest::newRow("sample without points") << QStringList{"sample", path("out.las")};
        QTest::newRow("sample of no points") << QStringList{"sample", path("out.las"), "--points", "0"};
        QTest::newRow("sample of less than none") << QStringList{"sample", path("out.las"), "--points", "-5"};
        QTest::newRow("bench without subject") << QStringList{"bench"};
        QTest::newRow("bench of nothing known") << QStringList{"bench", "coffee", in};
        QTest::newRow("bench process without step") << QStringList{"bench", "process", in};
    }
    void exitsWith2OnWrongUsage()
    {
        QFETCH(QStringList, arguments);
        const QStringList before = entries(m_folder.path());
        const Outcome run = runPunctum(arguments);
        PUNCTUM_EXIT(run, 2);
        QVERIFY2(run.oneSentence(), run.said());
        QVERIFY2(run.err.contains("--help"), run.said());
        QVERIFY(run.out.isEmpty());
        QCOMPARE(entries(m_folder.path()), before);
    }

    void saysWhyAFileCannotBeRead_data()
    {
        QTest::addColumn<QString>("file");
        const auto make = [this](const QString& name, const QByteArray& content) {
            QFile file(path(name));
            if (file.open(QIODevice::WriteOnly)) file.write(content);
        };
        make("empty.las", {});
        make("foreign.las", "%PDF-1.7 this is no point cloud at all, but it is long enough to hold a header. " +
                                QByteArray(400, 'x'));
        make("header.las", contentOf(path("in.las")).left(200));
        make("header.laz", contentOf(path("in.laz")).left(300));
        QDir().mkdir(path("folder.las"));
        for (const char* name : {"missing.las", "missing/in.las", "empty.las", "foreign.las", "header.las",
                                 "header.laz", "folder.las"})
            QTest::newRow(name) << path(name);
        QTest::newRow("/dev/zero") << "/dev/zero";
    }
    void saysWhyAFileCannotBeRead()
    {
        QFETCH(QString, file);
        const QList<QStringList> commands{{"info", file},
                                          {"convert", file, path("out.las")},
                                          {"render", file, "-o", path("out.png")},
                                          {"process", file, "-o", path("out.las"), "--step", "normals k=8"},
                                          {"bench", "load", file}};
        for (const QStringList& command : commands) {
            const Outcome run = runPunctum(command);
            PUNCTUM_EXIT(run, 1);
            QVERIFY2(run.oneSentence(), run.said());
            QVERIFY2(run.err.contains(QFileInfo(file).fileName()), run.said());
        }
        QVERIFY(!QFile::exists(path("out.las")) && !QFile::exists(path("out.png")));
    }

    void readsWhatATruncatedFileStillHas()
    {
        for (const char* name : {"in.las", "in.laz"}) {
            const QByteArray whole = contentOf(path(name));
            QFile cut(path(QString("cut-") + name));
            QVERIFY(cut.open(QIODevice::WriteOnly) && cut.write(whole.left(whole.size() * 2 / 3)) > 0);
            cut.close();
            const Outcome run = runPunctum({"info", "--json", cut.fileName()});
            if (run.exitCode == 1) {  // nothing of it could be saved: then it says so
                QVERIFY2(run.oneSentence(), run.said());
                continue;
            }
            PUNCTUM_EXIT(run, 0);
            QVERIFY(run.json()["points"].toInt() + run.json()["missing_points"].toInt() > 0);
            QVERIFY(run.out.contains("\"warnings\": [\n"));
        }
    }

    void saysWhyAFileCannotBeWritten()
    {
        const QList<QStringList> commands{
            {"convert", path("in.las"), path("none/out.las")},
            {"render", path("in.las"), "-o", path("none/out.png")},
            {"process", path("in.las"), "-o", path("none/out.las"), "--step", "normals k=8"},
            {"sample", path("none/out.las"), "--points", "1000"},
            {"sample", "/proc/out.las", "--points", "1000"},
            {"render", path("in.las"), "-o", "/proc/out.png", "--size", "9x9"}};
        for (const QStringList& command : commands) {
            const Outcome run = runPunctum(command);
            PUNCTUM_EXIT(run, 1);
            QVERIFY2(run.oneSentence(), run.said());
        }
        QVERIFY(!QFile::exists(path("none")));
        // results that cannot be printed are a failure too
        const QString command = QString("exec '%1' info --json in.las > /dev/full").arg(PUNCTUM_PROGRAM);
        PUNCTUM_EXIT(runProgram("/bin/bash", {"-c", command}, m_folder.path()), 1);
    }

    void cancelsOnCtrlC()
    {
        QDir().mkdir(path("cancelled"));
        QProcess process;
        process.setProcessEnvironment(noDisplay());
        process.start(PUNCTUM_PROGRAM, {"sample", path("cancelled/out.laz"), "--points", "20000000"});
        QVERIFY(process.waitForStarted());
        QTest::qWait(700);
        QCOMPARE(process.state(), QProcess::Running);
        QElapsedTimer timer;
        timer.start();
        QCOMPARE(kill(pid_t(process.processId()), SIGINT), 0);
        QVERIFY(process.waitForFinished(20'000));
        // the work answers within 0.1 s; giving back its memory on a busy machine takes longer
        QVERIFY2(timer.elapsed() < 10000, qPrintable(QString::number(timer.elapsed())));
        QCOMPARE(process.exitStatus(), QProcess::NormalExit);
        QCOMPARE(process.exitCode(), 1);
        QVERIFY(process.readAllStandardError().contains("Cancelled"));
        QCOMPARE(entries(path("cancelled")), QStringList());
    }

    void namesTheWayWithoutADisplay()
    {
        for (const QStringList& arguments : {QStringList{}, QStringList{path("in.las")}, QStringList{"./info"}}) {
            const Outcome run = runPunctum(arguments);
            PUNCTUM_EXIT(run, 1);
            QVERIFY2(run.oneSentence(), run.said());
            QVERIFY2(run.err.contains("punctum render"), run.said());
        }
    }

    void saysSoWhenTheDisplayCannotBeReached()
    {
        QProcess process;
        QProcessEnvironment environment = noDisplay();
        environment.insert("DISPLAY", ":54321");
        process.setProcessEnvironment(environment);
        process.start(PUNCTUM_PROGRAM, {path("in.las")});
        QVERIFY(process.waitForFinished(kTimeout));
        QCOMPARE(process.exitStatus(), QProcess::NormalExit);
        QCOMPARE(process.exitCode(), 1);
        const QByteArray said = process.readAllStandardError();
        QVERIFY2(said.count('\n') == 1 && said.contains("punctum render"), said);
    }

    void opensTheWindow()
    {
        QProcess process;
        QProcessEnvironment environment = noDisplay();
        environment.insert("QT_QPA_PLATFORM", "offscreen");
        environment.insert("HOME", m_folder.path());
        environment.insert("XDG_CONFIG_HOME", path("config"));
        process.setProcessEnvironment(environment);
        process.start(PUNCTUM_PROGRAM, {path("in.las")});
        QVERIFY(process.waitForStarted());
        QVERIFY2(!process.waitForFinished(2000), process.readAllStandardError());
        process.terminate();
        QVERIFY(process.waitForFinished(kTimeout));
    }

    void readsAFileWithTheNameOfACommand()
    {
        QVERIFY(QFile::copy(path("in.las"), path("info")));
        const Outcome run = runPunctum({"info", "--json", "./info"}, m_folder.path());
        PUNCTUM_EXIT(run, 0);
        QCOMPARE(run.json()["points"].toInt(), 20000);
    }
};

QTEST_GUILESS_MAIN(UsageCliTest)
#include "UsageCliTest.moc"
