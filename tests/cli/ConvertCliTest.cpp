// SPDX-License-Identifier: MIT
// punctum convert: LAS to LAZ and back, every field of every point as it was, read by LASzip's own API.
#include "tests/cli/LaszipPoints.h"
#include "tests/cli/Program.h"

#include <QJsonArray>
#include <QTemporaryDir>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>

using namespace punctum::test;

namespace
{

/// The fields of all points, one after the other.
struct Points {
    std::string fields;
    std::uint64_t count = 0;

    explicit Points(const QString& path)
    {
        const LaszipFile file(path);
        count = file.forEach([&](const laszip_point_struct& p) { appendFields(p, file.format(), fields); });
    }
    /// Number of the first point that is another one there.
    std::uint64_t firstDifference(const Points& other) const
    {
        const auto at = std::mismatch(fields.begin(), fields.end(), other.fields.begin(), other.fields.end()).first;
        return std::uint64_t(at - fields.begin()) * count / std::max<std::size_t>(1, fields.size());
    }
};

}  // namespace

class ConvertCliTest : public QObject
{
    Q_OBJECT

private slots:
    void repairsOrTells_data()
    {
        QTest::addColumn<QString>("name");
        QTest::addColumn<int>("points");
        QTest::addColumn<QString>("said");
        QTest::newRow("count") << "cases/count-zero.las" << 500 << "The header says 0 points, the file holds 500.";
        QTest::newRow("records") << "cases/vlr-count-garbage.las" << 300 << "it says now how many there are";
        QTest::newRow("real records") << "more/bad-vlr-count.las" << -1 << "it says now how many there are";
        QTest::newRow("extended") << "cases/evlr-offset-zero.las" << 100 << "but at 3375; they are read there.";
        QTest::newRow("zeros") << "cases/laz-zero-tail.laz" << -1 << "The header says 4,000 points, the file holds";
        QTest::newRow("1.5") << "more/pdrf10-las15.laz" << -1 << "";
    }
    void repairsOrTells()
    {
        QFETCH(QString, name);
        QFETCH(int, points);
        QFETCH(QString, said);
        if (!QFile::exists(realFile(name))) QSKIP("The file is not here.");
        QTemporaryDir folder;
        const QString laz = folder.filePath("a.laz"), las = folder.filePath("a.las"),
                      back = folder.filePath("b.las");
        const Outcome outcome = runPunctum({"convert", realFile(name), las, "--json"});
        PUNCTUM_EXIT(outcome, 0);
        const auto written = outcome.json().object();
        if (points >= 0) QCOMPARE(written["points"].toInt(), points);
        QVERIFY2(outcome.err.contains(said) || outcome.out.contains(said.toUtf8()), outcome.said());
        // What was written is sound, through LAZ and back.
        PUNCTUM_EXIT(runPunctum({"convert", las, laz}), 0);
        const Outcome again = runPunctum({"convert", laz, back});
        PUNCTUM_EXIT(again, 0);
        QVERIFY(contentOf(back) == contentOf(las));
        QVERIFY(!again.err.contains("The header"));
    }
    void namesWhatIsNoLasFile()
    {
        QTemporaryDir folder;
        const QString page = folder.filePath("a.laz");
        QFile file(page);
        QVERIFY(file.open(QIODevice::WriteOnly));
        file.write("<!DOCTYPE html><html><body>404 Not Found</body></html>");
        file.close();
        const Outcome outcome = runPunctum({"convert", page, folder.filePath("b.las")});
        PUNCTUM_EXIT(outcome, 1);
        QVERIFY2(outcome.err.contains("a.laz: This is not a LAS file but a web page"), outcome.said());
    }
    void protectedFilesAndLinks()
    {
        QTemporaryDir folder;
        const QString in = folder.filePath("in.las"), out = folder.filePath("out.las");
        PUNCTUM_EXIT(runPunctum({"sample", in, "--points", "100"}), 0);
        PUNCTUM_EXIT(runPunctum({"sample", out, "--points", "50"}), 0);
        const QByteArray before = contentOf(out);
        QVERIFY(QFile::setPermissions(out, QFile::ReadOwner | QFile::ReadUser));
        const Outcome refused = runPunctum({"convert", in, out});
        PUNCTUM_EXIT(refused, 1);
        QVERIFY2(refused.err.contains("This file is write-protected. Add --replace-protected"), refused.said());
        QVERIFY(contentOf(out) == before);
        PUNCTUM_EXIT(runPunctum({"convert", in, out, "--replace-protected"}), 0);
        QVERIFY(contentOf(out) == contentOf(in));
        // A link whose file is not there yet
        QVERIFY(QFile::link("real.las", folder.filePath("link.las")));
        PUNCTUM_EXIT(runPunctum({"convert", in, folder.filePath("link.las")}), 0);
        QVERIFY(QFileInfo(folder.filePath("link.las")).isSymLink());
        QVERIFY(contentOf(folder.filePath("real.las")) == contentOf(in));
    }
    void namesThatAreNotUtf8()
    {
        // The shell gives bytes, and so they stay.
        QTemporaryDir folder;
        const QString in = folder.filePath("in.las");
        PUNCTUM_EXIT(runPunctum({"sample", in, "--points", "100"}), 0);
        const std::string directory = folder.path().toStdString(), odd = directory + "/\xE4\xFF.las",
                          other = directory + "/\xE4\xFF.laz", program = PUNCTUM_PROGRAM;
        std::filesystem::copy_file(in.toStdString(), odd);
        const auto sh = [&](const std::string& command) { return std::system((program + command).c_str()); };
        QCOMPARE(sh(" convert '" + odd + "' '" + other + "' > /dev/null"), 0);
        QCOMPARE(sh(" diff '" + odd + "' '" + other + "' > /dev/null"), 0);
        QCOMPARE(sh(" info '" + other + "' > /dev/null"), 0);
        std::filesystem::remove(odd);
        std::filesystem::remove(other);
    }
    void keepsEveryFieldOfEveryPoint_data()
    {
        QTest::addColumn<QString>("path");
        for (const QString& name : realFiles())
            if (!name.startsWith("broken_")) QTest::newRow(qPrintable(name)) << realFile(name);
        if (realFiles().isEmpty()) QTest::newRow("autzen_trim.laz and the others") << QString();
    }
    void keepsEveryFieldOfEveryPoint()
    {
        QFETCH(QString, path);
        if (path.isEmpty()) QSKIP("There is no folder of real files here.");
        QTemporaryDir folder;
        const QString las = folder.filePath("first.las");
        const QString laz = folder.filePath("second.laz");
        const QString back = folder.filePath("third.las");
        PUNCTUM_EXIT(runPunctum({"convert", path, las}), 0);
        PUNCTUM_EXIT(runPunctum({"convert", las, laz}), 0);
        PUNCTUM_EXIT(runPunctum({"convert", laz, back}), 0);

        // byte by byte where nothing need differ, by LASzip's reading where the encoding does
        QVERIFY(contentOf(back) == contentOf(las));
        const Points expected(path);
        QVERIFY(expected.count > 0);
        QStringList toRead{laz};
        if (QFileInfo(path).suffix() == "las")
            QVERIFY(contentOf(las) == contentOf(path));
        else
            toRead << las;
        for (const QString& written : toRead) {
            const Points points(written);
            QCOMPARE(points.count, expected.count);
            QVERIFY2(points.fields == expected.fields, qPrintable(QString("%1 differs at point %2")
                                                                      .arg(QFileInfo(written).fileName())
                                                                      .arg(expected.firstDifference(points))));
        }
        // nothing but what was asked for lies there
        QCOMPARE(QDir(folder.path()).entryList(QDir::AllEntries | QDir::Hidden | QDir::NoDotAndDotDot).size(), 3);
    }

    void writesOtherFormats()
    {
        const QString in = realFile("autzen_trim.las");
        if (!QFile::exists(in)) QSKIP("autzen_trim.las is not here.");
        QTemporaryDir folder;
        const QString seven = folder.filePath("seven.laz");
        const QString three = folder.filePath("three.las");
        PUNCTUM_EXIT(runPunctum({"convert", in, seven, "--las-version", "1.4", "--point-format", "7"}), 0);
        PUNCTUM_EXIT(runPunctum({"convert", seven, three, "--las-version", "1.2", "--point-format", "3"}), 0);
        const LaszipFile before(in);
        const LaszipFile between(seven);
        QCOMPARE(between.version(), 4);
        QCOMPARE(between.format(), 7);
        QCOMPARE(LaszipFile(three).version(), 2);

        const auto names = namesOf(3);
        const auto wideNames = namesOf(7);
        std::vector<std::vector<double>> expected;
        std::vector<double> values;
        before.forEach([&](const laszip_point_struct& p) {
            valuesOf(p, before, values);
            expected.push_back(values);
        });
        std::size_t k = 0;
        std::map<std::string, int> wrong;
        between.forEach([&](const laszip_point_struct& p) {
            valuesOf(p, between, values);
            for (std::size_t w = 0, n = 0; w < wideNames.size(); ++w) {
                if (wideNames[w] == "Overlap" || wideNames[w] == "ScannerChannel") continue;
                // whole degrees become steps of 0.006 degrees
                const double allowed = names[n] == "ScanAngle" ? 0.0031 : 0.0;
                wrong[names[n]] += std::abs(values[w] - expected[k][n]) > allowed;
                ++n;
            }
            ++k;
        });
        QCOMPARE(k, expected.size());
        for (const auto& [name, count] : wrong) QVERIFY2(count == 0, name.c_str());
        QVERIFY(Points(three).fields == Points(in).fields);
    }

    void refusesFormatsThatWouldLoseSomething()
    {
        // what an older format has no room for is named, and nothing is written
        QTemporaryDir folder;
        PUNCTUM_EXIT(runPunctum({"sample", "in.las", "--points", "5000"}, folder.path()), 0);
        const Outcome run = runPunctum({"convert", "in.las", "out.las", "--point-format", "1"}, folder.path());
        PUNCTUM_EXIT(run, 1);
        QVERIFY2(run.oneSentence(), run.said());
        QVERIFY(!QFile::exists(folder.filePath("out.las")));
        QVERIFY2(run.err.contains("scan angle that is no whole degree") &&
                     run.err.contains("Add --lossy to write point format 1 of LAS 1.4 all the same."),
                 run.said());
        const Outcome lossy = runPunctum(
            {"convert", "in.las", "out.las", "--point-format", "1", "--las-version", "1.2", "--lossy", "--json"},
            folder.path());
        PUNCTUM_EXIT(lossy, 0);
        QStringList kinds;
        for (const QJsonValue& loss : lossy.json()["losses"].toArray()) {
            const QJsonObject told = loss.toObject();
            QVERIFY(told["points"].toInt() > 0 && !told["becomes"].toString().isEmpty());
            kinds << told["what"].toString();
        }
        QVERIFY2(kinds.contains("a scan angle that is no whole degree") && kinds.contains("colors"),
                 qPrintable(kinds.join(", ")));
        QCOMPARE(LaszipFile(folder.filePath("out.las")).version(), 2);
        QCOMPARE(LaszipFile(folder.filePath("out.las")).format(), 1);
    }

    void writesTheNewestVersion()
    {
        QTemporaryDir folder;
        PUNCTUM_EXIT(runPunctum({"sample", "in.las", "--points", "1000"}, folder.path()), 0);
        PUNCTUM_EXIT(runPunctum({"convert", "in.las", "new.laz", "--las-version", "1.5"}, folder.path()), 0);
        const Outcome info = runPunctum({"info", "new.laz", "--json"}, folder.path());
        QCOMPARE(info.json()["las_version"].toString(), QString("1.5"));
        QCOMPARE(info.json()["warnings"].toArray().size(), 0);
        QCOMPARE(info.json()["units"].toObject()["horizontal"].toString(), QString("m"));
        QVERIFY(info.json()["header_gps_time"].toArray()[1].toDouble() > 0);
        QCOMPARE(info.json()["header_gps_time"].toArray(), info.json()["gps_time"].toArray());
        QCOMPARE(info.json()["time_offset"].toInt(-1), 0);
        PUNCTUM_EXIT(runPunctum({"convert", "new.laz", "old.las", "--las-version", "1.4"}, folder.path()), 0);
        const Outcome diff = runPunctum({"diff", "in.las", "old.las", "--json"}, folder.path());
        QVERIFY(diff.json()["attributes"].toArray().isEmpty());
    }

    void reportsInJson()
    {
        QTemporaryDir folder;
        PUNCTUM_EXIT(runPunctum({"sample", "in.las", "--points", "1000"}, folder.path()), 0);
        const Outcome run = runPunctum({"convert", "in.las", "out.laz", "--json", "--no-verify"}, folder.path());
        PUNCTUM_EXIT(run, 0);
        QCOMPARE(run.json()["points"].toInt(), 1000);
        QCOMPARE(run.json()["file"].toString(), QString("out.laz"));
        QCOMPARE(qint64(run.json()["bytes"].toDouble()), QFileInfo(folder.filePath("out.laz")).size());
        QVERIFY(run.json()["notes"].isArray());
    }

    void replacesItsOwnInput()
    {
        QTemporaryDir folder;
        PUNCTUM_EXIT(runPunctum({"sample", "a.las", "--points", "3000"}, folder.path()), 0);
        const auto before = contentOf(folder.filePath("a.las"));
        PUNCTUM_EXIT(runPunctum({"convert", "a.las", "a.las"}, folder.path()), 0);
        QCOMPARE(contentOf(folder.filePath("a.las")), before);
    }

    void leavesNothingWhereTheDiskIsFull()
    {
        QTemporaryDir folder;
        PUNCTUM_EXIT(runPunctum({"sample", "a.las", "--points", "50000"}, folder.path()), 0);
        // a limit on the size of files, in KiB, fails the same writes that a full disk does
        const QString command = QString("ulimit -f 100; exec '%1' convert a.las %2").arg(PUNCTUM_PROGRAM);
        for (const char* out : {"b.las", "b.laz", "a.las"}) {
            const auto before = contentOf(folder.filePath("a.las"));
            const Outcome run = runProgram("/bin/bash", {"-c", command.arg(out)}, folder.path());
            PUNCTUM_EXIT(run, 1);
            QVERIFY2(run.oneSentence(), run.said());
            QCOMPARE(QDir(folder.path()).entryList(QDir::AllEntries | QDir::Hidden | QDir::NoDotAndDotDot),
                     QStringList{"a.las"});
            QCOMPARE(contentOf(folder.filePath("a.las")), before);
        }
    }

    void refusesTruncatedOriginalsAsTargets()
    {
        QTemporaryDir folder;
        PUNCTUM_EXIT(runPunctum({"sample", "whole.las", "--points", "3000"}, folder.path()), 0);
        QFile cut(folder.filePath("cut.las"));
        QVERIFY(QFile::copy(folder.filePath("whole.las"), cut.fileName()) && cut.resize(cut.size() / 2));
        const auto before = contentOf(cut.fileName());
        const Outcome run = runPunctum({"convert", "cut.las", "cut.las"}, folder.path());
        PUNCTUM_EXIT(run, 1);
        QVERIFY2(run.err.contains("another name"), run.said());
        QCOMPARE(contentOf(cut.fileName()), before);
    }
};

QTEST_GUILESS_MAIN(ConvertCliTest)
#include "ConvertCliTest.moc"
