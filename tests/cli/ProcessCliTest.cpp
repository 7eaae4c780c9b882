// SPDX-License-Identifier: MIT
// punctum process: steps in order, and a file that has their results.
#include "tests/cli/LaszipPoints.h"
#include "tests/cli/Program.h"

#include <QJsonArray>
#include <QTemporaryDir>

#include <cmath>

using namespace punctum::test;

class ProcessCliTest : public QObject
{
    Q_OBJECT

private:
    QTemporaryDir m_folder;
    QString path(const QString& name) const { return m_folder.filePath(name); }

private slots:
    void initTestCase() { PUNCTUM_EXIT(runPunctum({"sample", path("in.las"), "--points", "30000"}), 0); }

    void reclassifiesARange()
    {
        const Outcome run = runPunctum({"process", path("in.las"), "-o", path("out.laz"), "--json", "--step",
                                        "reclassify attribute=Intensity min=1000 max=20000 class=12"});
        PUNCTUM_EXIT(run, 0);
        const LaszipFile before(path("in.las"));
        const LaszipFile after(path("out.laz"));
        struct Seen {
            int intensity;
            int code;
        };
        std::vector<Seen> old;
        before.forEach([&](const laszip_point_struct& p) {
            old.push_back({p.intensity, p.extended_classification});
        });
        std::size_t k = 0;
        std::size_t wrong = 0;
        int changed = 0;
        after.forEach([&](const laszip_point_struct& p) {
            const bool inside = old[k].intensity >= 1000 && old[k].intensity <= 20000;
            const int expected = inside ? 12 : old[k].code;
            wrong += p.extended_classification != expected;
            changed += expected != old[k].code;
            ++k;
        });
        QCOMPARE(k, old.size());
        QCOMPARE(wrong, std::size_t(0));
        QVERIFY(changed > 0);
        QCOMPARE(run.json()["steps"][0]["points_changed"].toInt(), changed);
        QCOMPARE(run.json()["points"].toInt(), 30000);
    }

    /// Columns that lie in files come to the same bytes; nothing of the files is left.
    void worksBeyondTheMemoryBudget()
    {
        PUNCTUM_EXIT(runPunctum({"sample", path("large.las"), "--points", "1000000"}), 0);
        const QStringList words{"process", path("large.las"),
                                "--step",  "reclassify attribute=Intensity min=1000 max=20000 class=12",
                                "--step",  "normals k=6"};
        QTemporaryDir cache;
        qputenv("XDG_CACHE_HOME", cache.path().toUtf8());
        PUNCTUM_EXIT(runPunctum(words + QStringList{"-o", path("whole.laz")}), 0);
        PUNCTUM_EXIT(runPunctum(words + QStringList{"-o", path("paged.laz"), "--memory", "16M"}), 0);
        QVERIFY(!contentOf(path("whole.laz")).isEmpty());
        QVERIFY(contentOf(path("whole.laz")) == contentOf(path("paged.laz")));
        QVERIFY(QDir(cache.path()).exists("punctum"));  // so files were made
        QVERIFY(QDir(cache.path() + "/punctum").isEmpty());
        PUNCTUM_EXIT(runPunctum({"diff", path("whole.laz"), path("paged.laz"), "--memory", "16 MB"}), 0);

        qputenv("XDG_CACHE_HOME", "/proc");  // where nothing can be made
        const Outcome refused = runPunctum(words + QStringList{"-o", path("none.laz"), "--memory", "16M"});
        qunsetenv("XDG_CACHE_HOME");
        PUNCTUM_EXIT(refused, 1);
        QVERIFY2(refused.oneSentence() && refused.err.contains("memory budget"), qPrintable(refused.err));
        QVERIFY(!QFile::exists(path("none.laz")));
        const Outcome wrong = runPunctum({"info", path("in.las"), "--memory", "much"});
        PUNCTUM_EXIT(wrong, 2);
        QVERIFY2(wrong.err.contains("--memory must be a size"), qPrintable(wrong.err));
        PUNCTUM_EXIT(runPunctum({"info", path("in.las"), "--memory", "5M"}), 2);
    }

    void addsNormalsThatLookUp()
    {
        PUNCTUM_EXIT(runPunctum({"process", path("in.las"), "-o", path("normals.las"), "--step", "normals k=12"}),
                     0);
        const Outcome info = runPunctum({"info", "--json", path("normals.las")});
        PUNCTUM_EXIT(info, 0);
        std::map<QString, QJsonObject> attributes;
        for (const auto& a : info.json()["attributes"].toArray())
            attributes[a.toObject()["name"].toString()] = a.toObject();
        for (const char* name : {"NormalX", "NormalY", "NormalZ"}) QVERIFY2(attributes.contains(name), name);
        QVERIFY(attributes["NormalZ"]["min"].toDouble() >= 0);
        QVERIFY(attributes["NormalZ"]["max"].toDouble() <= 1.0001);
        QVERIFY(attributes["NormalZ"]["mean"].toDouble() > 0.5);  // a landscape is mostly flat
        // what was there before is there still
        const LaszipFile before(path("in.las"));
        const LaszipFile after(path("normals.las"));
        QCOMPARE(after.recordLength(), before.recordLength() + 12);
    }

    // Meters along X and Y, heights in survey feet: the slope is one of 45 degrees.
    void lengthsAreTrue()
    {
        const QString slope = QStringLiteral(PUNCTUM_TEST_DATA "/cases/slope-m-ftus.las");
        if (!QFile::exists(slope)) QSKIP("slope-m-ftus.las is not here.");
        const Outcome run =
            runPunctum({"process", slope, "-o", path("slope.las"), "--json", "--step", "normals radius=3"});
        PUNCTUM_EXIT(run, 0);
        QCOMPARE(run.json()["steps"][0]["length_unit"].toString(), QStringLiteral("m"));
        const Outcome info = runPunctum({"info", "--json", path("slope.las")});
        for (const auto& a : info.json()["attributes"].toArray())
            if (a.toObject()["name"] == QLatin1String("NormalZ"))
                QVERIFY(std::abs(a.toObject()["mean"].toDouble() - 0.707) < 0.01);
        const Outcome told = runPunctum({"process", slope, "-o", path("slope.las"), "--step", "normals radius=3"});
        QVERIFY2(told.err.contains(QLatin1String("(lengths in m)")), qPrintable(told.err));
    }

    void marksOutliersThenReclassifies()
    {
        // in order: what the first step made 7 the second one makes 18; unquoted, as a shell may hand it over
        const Outcome run = runPunctum({"process", path("in.las"), "--step", "outliers", "k=8", "deviations=1.0",
                                        "class=7", "--step", "reclassify", "attribute=Classification", "min=7",
                                        "max=7", "class=18", "-o", path("two.las")});
        PUNCTUM_EXIT(run, 0);
        int sevens = 0;
        int eighteens = 0;
        LaszipFile(path("two.las")).forEach([&](const laszip_point_struct& p) {
            sevens += p.extended_classification == 7;
            eighteens += p.extended_classification == 18;
        });
        QCOMPARE(sevens, 0);
        QVERIFY(eighteens > 0 && eighteens < 15000);
    }

    void listsItsSteps()
    {
        const Outcome text = runPunctum({"process", "--list-steps"});
        PUNCTUM_EXIT(text, 0);
        for (const char* name : {"normals", "outliers", "reclassify", "deviations=", "radius="})
            QVERIFY2(text.out.contains(name), name);
        const Outcome json = runPunctum({"process", "--list-steps", "--json"});
        PUNCTUM_EXIT(json, 0);
        const QJsonArray steps = json.json().array();
        QVERIFY(steps.size() >= 3);
        for (const auto& step : steps) {
            QVERIFY(!step.toObject()["help"].toString().isEmpty());
            QVERIFY(step.toObject()["name"] == QLatin1String("restore") ||
                    !step.toObject()["parameters"].toArray().isEmpty());
        }
    }

    void deletes()
    {
        const QString real = realFile("autzen_trim.laz");
        if (!QFile::exists(real)) QSKIP("autzen_trim.laz is not here.");
        const Outcome run = runPunctum({"process", real, "-o", path("left.laz"), "--step",
                                        "delete where='Classification == 1'", "--step", "set rule='UserData = 3'"});
        PUNCTUM_EXIT(run, 0);
        QVERIFY2(run.err.contains("were deleted are left out"), run.said());
        std::uint64_t others = 0;
        LaszipFile(real).forEach([&](const laszip_point_struct& p) { others += p.classification != 1; });
        QVERIFY(others > 0);
        QCOMPARE(LaszipFile(path("left.laz")).forEach([](const laszip_point_struct& p) {
            QVERIFY(p.classification != 1);
            QCOMPARE(int(p.user_data), 3);
        }),
                 others);
        const Outcome diff = runPunctum({"diff", real, path("left.laz")});
        PUNCTUM_EXIT(diff, 1);
        QVERIFY2(diff.out.contains("lacks") && diff.out.contains("UserData") && !diff.out.contains("Intensity"),
                 diff.said());
        PUNCTUM_EXIT(runPunctum({"process", real, "-o", path("no.laz"), "--step", "delete"}), 2);
    }

    // What the first step changes no longer belongs to those that the second one may change.
    void changesOnlyWithin()
    {
        const Outcome run =
            runPunctum({"process", path("in.las"), "-o", path("within.las"), "--json", "--within",
                        "Classification == 2", "--step", "reclassify attribute=Intensity min=0 max=20000 class=12",
                        "--step", "set rule='UserData = 9'", "--step", "delete"});
        PUNCTUM_EXIT(run, 0);
        struct Seen {
            int code, intensity, user;
            bool operator==(const Seen&) const = default;
        };
        const auto all = [](const QString& file) {
            std::vector<Seen> seen;
            LaszipFile(file).forEach([&](const laszip_point_struct& p) {
                seen.push_back({p.extended_classification, p.intensity, p.user_data});
            });
            return seen;
        };
        std::vector<Seen> expected;
        int changed = 0, ground = 0;
        for (Seen point : all(path("in.las"))) {
            ground += point.code == 2;
            if (point.code == 2 && point.intensity <= 20000) point.code = 12, ++changed;
            if (point.code != 2) expected.push_back(point);
        }
        QVERIFY(changed > 0 && changed < ground);
        QVERIFY(all(path("within.las")) == expected);
        const QJsonDocument report = run.json();
        QCOMPARE(report["steps"][0]["points_within"].toInt(), ground);
        QCOMPARE(report["steps"][0]["points_changed"].toInt(), changed);
        QCOMPARE(report["steps"][1]["points_within"].toInt(), ground - changed);
        // before any file is read: there is none
        for (const QStringList& wrong : {QStringList{"--step", "remove attribute=Extra", "--within", "Z > 3"},
                                         QStringList{"--step", "outliers", "--within", "Z >"}}) {
            const Outcome refused =
                runPunctum(QStringList{"process", path("none.las"), "-o", path("x.las")} + wrong);
            PUNCTUM_EXIT(refused, 2);
            QVERIFY2(refused.oneSentence() && !refused.err.contains("none.las"), refused.said());
        }
    }

    void upgradesOnlyWhenTold()
    {
        const QString three = realFile("autzen_trim.las");
        if (!QFile::exists(three)) QSKIP("autzen_trim.las is not here.");
        QStringList arguments{"process",        three,    "-o",
                              path("high.las"), "--step", "reclassify attribute=Z min=-1e9 max=1e9 class=64"};
        const Outcome refused = runPunctum(arguments);
        PUNCTUM_EXIT(refused, 1);
        QVERIFY2(refused.err.contains("110,000 points have a class above 31"), refused.said());
        QVERIFY2(refused.err.contains("--upgrade"), refused.said());
        QVERIFY(!QFile::exists(path("high.las")));
        const Outcome upgraded = runPunctum(arguments << "--upgrade");
        PUNCTUM_EXIT(upgraded, 0);
        QVERIFY2(upgraded.err.contains("point format 7 of LAS 1.4"), upgraded.said());
        const LaszipFile file(path("high.las"));
        QCOMPARE(file.format(), 7);
        QCOMPARE(file.forEach([](const laszip_point_struct& p) { QCOMPARE(int(p.extended_classification), 64); }),
                 std::uint64_t(110000));
        // where nothing needs it, it changes nothing
        PUNCTUM_EXIT(runPunctum({"convert", three, path("same.las"), "--upgrade"}), 0);
        QVERIFY(contentOf(path("same.las")) == contentOf(three));
    }

    void saysWhatIsWrong_data()
    {
        QTest::addColumn<QString>("step");
        QTest::addColumn<int>("exitCode");
        QTest::newRow("unknown step") << "polish k=3" << 2;
        QTest::newRow("unknown key") << "normals neighbors=3" << 2;
        QTest::newRow("value out of bounds") << "normals k=-1" << 2;
        QTest::newRow("not a number") << "normals k=many" << 2;
        QTest::newRow("value missing") << "reclassify attribute=Z min=1 max=2" << 2;
        QTest::newRow("unknown attribute") << "reclassify attribute=Zest min=1 max=2 class=3" << 1;
    }
    void saysWhatIsWrong()
    {
        QFETCH(QString, step);
        QFETCH(int, exitCode);
        const Outcome run = runPunctum({"process", path("in.las"), "-o", path("wrong.las"), "--step", step});
        PUNCTUM_EXIT(run, exitCode);
        QVERIFY2(run.oneSentence(), run.said());
        QVERIFY(!QFile::exists(path("wrong.las")));
    }
};

QTEST_GUILESS_MAIN(ProcessCliTest)
#include "ProcessCliTest.moc"
