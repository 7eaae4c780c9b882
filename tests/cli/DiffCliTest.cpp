// SPDX-License-Identifier: MIT
// punctum diff: says exactly what differs, in text and in JSON, and by its exit code.
#include "tests/cli/LaszipPoints.h"
#include "tests/cli/Program.h"

#include <QJsonArray>
#include <QTemporaryDir>

using namespace punctum::test;

class DiffCliTest : public QObject
{
    Q_OBJECT

private:
    QTemporaryDir m_folder;
    Outcome run(const QStringList& arguments) const { return runPunctum(arguments, m_folder.path()); }

private slots:
    void initTestCase()
    {
        PUNCTUM_EXIT(run({"sample", "a.las", "--points", "20000"}), 0);
        PUNCTUM_EXIT(run({"convert", "a.las", "a.laz"}), 0);
    }

    void equalFilesExitWith0()
    {
        const Outcome same = run({"diff", "a.laz", "a.laz", "--bytes"});
        PUNCTUM_EXIT(same, 0);
        QVERIFY(same.out.contains("hold the same"));
        QVERIFY(!same.out.contains("Stored"));
        QVERIFY(same.err.isEmpty());
    }

    void lasAndLazDifferInTheContainerOnly()
    {
        const Outcome text = run({"diff", "a.las", "a.laz"});
        PUNCTUM_EXIT(text, 0);
        QVERIFY2(text.out.contains("hold the same") && text.out.contains("Stored as LAS and LAZ"), text.out);
        const Outcome strict = run({"diff", "a.las", "a.laz", "--bytes", "--json"});
        PUNCTUM_EXIT(strict, 1);
        QVERIFY(strict.err.isEmpty());
        const QJsonDocument json = strict.json();
        QCOMPARE(json["equal"].toBool(), true);
        QCOMPARE(json["container"]["equal"].toBool(), false);
        QCOMPARE(json["container"]["a"].toString(), "LAS");
        QCOMPARE(json["container"]["b"].toString(), "LAZ");
        QVERIFY(json["container"]["first_differing_byte"].isDouble());
        QCOMPARE(json["points"]["compared"].toInt(), 20000);
        for (const char* list : {"header", "attributes", "vlrs", "other_bytes"})
            QVERIFY2(json[list].isArray() && json[list].toArray().isEmpty(), list);
    }

    void anEditOfOneClassIsAllThatDiffers_data()
    {
        QTest::addColumn<QString>("out");
        QTest::newRow("LAZ") << "edited.laz";
        QTest::newRow("LAS") << "edited.las";
    }
    void anEditOfOneClassIsAllThatDiffers()
    {
        QFETCH(QString, out);
        PUNCTUM_EXIT(run({"process", "a.laz", "-o", out, "--step",
                          "reclassify attribute=Intensity min=10000 max=30000 class=9"}),
                     0);
        // how many points that are, by LASzip's own reading
        std::vector<int> before;
        LaszipFile(m_folder.filePath("a.laz")).forEach([&](const laszip_point_struct& p) {
            before.push_back(p.extended_classification);
        });
        int expected = 0, first = -1, at = 0;
        LaszipFile(m_folder.filePath(out)).forEach([&](const laszip_point_struct& p) {
            if (p.extended_classification != before[std::size_t(at)]) {
                if (expected++ == 0) first = at;
            }
            ++at;
        });
        QVERIFY(expected > 0 && expected < 20000);

        const Outcome diff = run({"diff", "a.laz", out, "--json"});
        PUNCTUM_EXIT(diff, 1);
        QVERIFY(diff.err.isEmpty());
        const QJsonDocument json = diff.json();
        QCOMPARE(json["equal"].toBool(), false);
        QCOMPARE(json["points"]["differing"].toInt(), expected);
        const QJsonArray attributes = json["attributes"].toArray();
        QCOMPARE(attributes.size(), 1);
        QCOMPARE(attributes[0]["name"].toString(), "Classification");
        QCOMPARE(attributes[0]["change"].toString(), "changed");
        QCOMPARE(attributes[0]["differing_points"].toInt(), expected);
        QCOMPARE(attributes[0]["first_point"].toInt(), first);
        QCOMPARE(attributes[0]["first_a"].toInt(), before[std::size_t(first)]);
        QCOMPARE(attributes[0]["first_b"].toInt(), 9);
        QVERIFY2(json["header"].toArray().isEmpty() && json["vlrs"].toArray().isEmpty(), diff.out);

        const Outcome text = run({"diff", "a.laz", out});
        PUNCTUM_EXIT(text, 1);
        QVERIFY2(text.out.startsWith("a.laz and " + out.toUtf8() + " differ.\n"), text.out);
        QVERIFY2(text.out.contains("Classification"), text.out);
    }

    void namesNewAttributesRecordsAndHeaderFields()
    {
        PUNCTUM_EXIT(run({"process", "a.laz", "-o", "n.laz", "--step", "normals k=8"}), 0);
        const Outcome diff = run({"diff", "a.laz", "n.laz", "--json"});
        PUNCTUM_EXIT(diff, 1);
        const QJsonDocument json = diff.json();
        QCOMPARE(json["points"]["differing"].toInt(), 0);
        QStringList added;
        for (const auto& a : json["attributes"].toArray()) {
            QCOMPARE(a.toObject()["change"].toString(), "only_in_b");
            added << a.toObject()["name"].toString();
        }
        QCOMPARE(added, QStringList({"NormalX", "NormalY", "NormalZ"}));
        QVERIFY(diff.out.contains("\"LASF_Spec\""));
        QStringList fields;
        for (const auto& f : json["header"].toArray()) fields << f.toObject()["field"].toString();
        QVERIFY2(fields.contains("record_length"), diff.out);
    }

    void realFilesAgainstTheirCopies_data()
    {
        QTest::addColumn<QString>("path");
        for (const QString& name : realFiles())
            if (!name.startsWith("broken_")) QTest::newRow(qPrintable(name)) << realFile(name);
        if (realFiles().isEmpty()) QTest::newRow("autzen_trim.laz and the others") << QString();
    }
    void realFilesAgainstTheirCopies()
    {
        QFETCH(QString, path);
        if (path.isEmpty()) QSKIP("There is no folder of real files here.");
        PUNCTUM_EXIT(run({"convert", path, "copy.las"}), 0);
        const Outcome diff = run({"diff", path, "copy.las", "--json"});
        QVERIFY(diff.exitCode == 0 || diff.exitCode == 1);
        const QJsonDocument json = diff.json();
        QVERIFY2(json["attributes"].toArray().isEmpty(), diff.out);
        QCOMPARE(json["points"]["differing"].toInt(), 0);
        QCOMPARE(json["points"]["a"].toInt(), json["points"]["b"].toInt());
        // only an index of the old container may be gone, and a count with it
        for (const auto& record : json["vlrs"].toArray()) {
            const QString user = record.toObject()["user_id"].toString();
            QVERIFY2(user == "copc" || user == "LAStools", diff.out);
        }
        if (json["vlrs"].toArray().isEmpty()) PUNCTUM_EXIT(diff, 0);
    }

    void unusableFilesAndUsage()
    {
        const Outcome missing = run({"diff", "a.las", "none.las"});
        PUNCTUM_EXIT(missing, 1);
        QVERIFY2(missing.oneSentence() && missing.err.contains("none.las"), missing.said());
        QVERIFY(missing.out.isEmpty());
        for (const QStringList& arguments :
             {QStringList{"diff"}, QStringList{"diff", "a.las"}, QStringList{"diff", "a.las", "a.laz", "a.las"},
              QStringList{"diff", "a.las", "a.laz", "--loosely"}}) {
            const Outcome usage = run(arguments);
            PUNCTUM_EXIT(usage, 2);
            QVERIFY2(usage.oneSentence(), usage.said());
        }
    }
};

QTEST_GUILESS_MAIN(DiffCliTest)
#include "DiffCliTest.moc"
