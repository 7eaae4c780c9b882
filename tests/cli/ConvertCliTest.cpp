// SPDX-License-Identifier: MIT
// punctum convert: LAS to LAZ and back, every field of every point as it was, read by LASzip's own API.
#include "tests/cli/LaszipPoints.h"
#include "tests/cli/Program.h"

#include <QTemporaryDir>

#include <unistd.h>

using namespace punctum::test;

namespace
{

std::vector<std::string> pointsOf(const QString& path)
{
    const LaszipFile file(path);
    std::vector<std::string> points;
    file.forEach([&](const laszip_point_struct& p) { points.push_back(fieldsOf(p, file.format())); });
    return points;
}

}  // namespace

class ConvertCliTest : public QObject
{
    Q_OBJECT

private slots:
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

        const auto expected = pointsOf(path);
        QVERIFY(!expected.empty());
        for (const QString& written : {las, laz, back}) {
            const auto points = pointsOf(written);
            QCOMPARE(points.size(), expected.size());
            for (std::size_t k = 0; k < points.size(); ++k)
                QVERIFY2(points[k] == expected[k],
                         qPrintable(QFileInfo(written).fileName() + ", point " + QString::number(k)));
        }
        QCOMPARE(contentOf(back), contentOf(las));
        if (QFileInfo(path).suffix() == "las") QCOMPARE(contentOf(las), contentOf(path));
        // nothing but what was asked for lies there
        QCOMPARE(QDir(folder.path()).entryList(QDir::AllEntries | QDir::Hidden | QDir::NoDotAndDotDot).size(), 3);
    }

    void writesOtherFormats()
    {
        QTemporaryDir folder;
        const QString in = folder.filePath("in.las");
        const QString out = folder.filePath("out.laz");
        PUNCTUM_EXIT(runPunctum({"sample", in, "--points", "5000"}), 0);
        const Outcome run = runPunctum({"convert", in, out, "--las-version", "1.2", "--point-format", "3"});
        PUNCTUM_EXIT(run, 0);
        const LaszipFile file(out);
        QCOMPARE(file.version(), 2);
        QCOMPARE(file.format(), 3);

        const LaszipFile before(in);
        std::vector<std::vector<std::pair<std::string, double>>> expected;
        before.forEach([&](const laszip_point_struct& p) { expected.push_back(numbersOf(p, before)); });
        std::size_t k = 0;
        bool same = true;
        file.forEach([&](const laszip_point_struct& p) {
            std::map<std::string, double> now;
            for (const auto& [name, value] : numbersOf(p, file)) now[name] = value;
            for (const auto& [name, value] : expected[k])
                if (name == "X" || name == "Y" || name == "Z" || name == "GpsTime" || name == "Red" ||
                    name == "Intensity" || name == "Classification")
                    same = same && now[name] == value;
            ++k;
        });
        QCOMPARE(k, std::size_t(5000));
        QVERIFY(same);
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
