// SPDX-License-Identifier: MIT
// punctum extract and punctum replay; and that a rule on a LAZ file changes what it says, and nothing else.
#include "core/Error.h"
#include "core/edit/History.h"
#include "core/edit/Journal.h"
#include "core/expression/Condition.h"
#include "core/las/Reader.h"
#include "core/las/Writer.h"
#include "core/steps/MakeCommand.h"
#include "core/task/Progress.h"
#include "tests/cli/Program.h"

#include <QJsonArray>
#include <QJsonObject>
#include <QTemporaryDir>
#include <QTest>

using namespace punctum;
using namespace punctum::test;

class EditCliTest : public QObject
{
    Q_OBJECT

private:
    QTemporaryDir m_folder;
    QString path(const QString& name) const { return m_folder.filePath(name); }
    std::shared_ptr<PointCloud> load(const QString& name) const
    {
        Progress progress;
        return las::load(path(name).toStdString(), progress);
    }

private slots:
    void initTestCase() { PUNCTUM_EXIT(runPunctum({"sample", path("in.laz"), "--points", "60000"}), 0); }

    void aRuleChangesWhatItSaysAndNothingElse()
    {
        PUNCTUM_EXIT(runPunctum({"process", path("in.laz"), "-o", path("ruled.laz"), "--step", "set",
                                 "rule=Classification = 2 if Z > 200 and Classification not in (2, 6)"}),
                     0);
        const auto before = load("in.laz"), after = load("ruled.laz");
        const Attribute classes = *before->findAttribute("Classification"), z = *before->findAttribute("Z"),
                        now = *after->findAttribute("Classification");
        PointIndex changed = 0;
        for (PointIndex i = 0; i < before->size(); ++i) {
            const double code = classes.number(i);
            const bool holds = z.number(i) > 200 && code != 2 && code != 6;
            QCOMPARE(now.number(i), holds ? 2.0 : code);
            changed += holds ? 1 : 0;
        }
        QVERIFY(changed > 100);
        const Outcome diff = runPunctum({"diff", path("in.laz"), path("ruled.laz"), "--json"});
        PUNCTUM_EXIT(diff, 1);
        const QJsonArray attributes = diff.json()["attributes"].toArray();
        QCOMPARE(attributes.size(), 1);
        QCOMPARE(attributes[0].toObject()["name"].toString(), QStringLiteral("Classification"));
    }

    void wrongRulesAreWrongUsage()
    {
        const Outcome wrong = runPunctum(
            {"process", path("in.laz"), "-o", path("no.laz"), "--step", "set rule='Classification = 2 if Z >'"});
        PUNCTUM_EXIT(wrong, 2);
        QVERIFY2(wrong.err.contains("Column 26: a value is missing"), qPrintable(wrong.err));
        const Outcome missing =
            runPunctum({"process", path("in.laz"), "-o", path("no.laz"), "--step", "set rule='Clasification = 2'"});
        PUNCTUM_EXIT(missing, 1);
        QVERIFY2(missing.err.contains("did you mean Classification?"), qPrintable(missing.err));
        QVERIFY(!QFile::exists(path("no.laz")));
    }

    void extractsWhatTheConditionNames_data()
    {
        QTest::addColumn<QString>("out");
        QTest::newRow("LAS") << "part.las";
        QTest::newRow("LAZ") << "part.laz";
    }
    void extractsWhatTheConditionNames()
    {
        QFETCH(QString, out);
        const Outcome run = runPunctum({"extract", path("in.laz"), "-o", path(out), "--where",
                                        "Classification in (2, 6) and Intensity > 20000", "--json"});
        PUNCTUM_EXIT(run, 0);
        const auto all = load("in.laz"), part = load(out);
        Progress progress;
        const auto points = expression::select(
            *all, expression::Condition("Classification in (2, 6) and Intensity > 20000", *all), progress);
        QCOMPARE(part->size(), points->count());
        QCOMPARE(PointIndex(run.json()["points"].toInteger()), points->count());
        QVERIFY(part->size() > 100);
        QCOMPARE(part->attributes().size(), all->attributes().size());
        for (const Attribute& a : all->attributes()) {
            const Attribute* const b = part->findAttribute(a.name);
            QVERIFY(b != nullptr);
            PointIndex k = 0;
            points->forEach([&](PointIndex i) {
                for (std::uint32_t c = 0; c < a.components; ++c)
                    if (a.value(i, c) != b->value(k, c)) QFAIL(a.name.c_str());
                ++k;
            });
        }
        PUNCTUM_EXIT(runPunctum({"info", path(out)}), 0);
    }

    void extractRefusesWhatWouldLosePoints()
    {
        PUNCTUM_EXIT(runPunctum({"extract", path("in.laz"), "-o", path("in.laz"), "--where", "Z > 0"}), 2);
        PUNCTUM_EXIT(runPunctum({"extract", path("in.laz"), "-o", path("x.laz"), "--where", "Z >"}), 2);
        const Outcome none = runPunctum({"extract", path("in.laz"), "-o", path("none.las"), "--where", "Z > 1e9"});
        PUNCTUM_EXIT(none, 0);
        QCOMPARE(load("none.las")->size(), PointIndex(0));
    }

    void replaysAJournal()
    {
        const std::string journal = path("edits.journal").toStdString();
        Progress progress;
        {
            const auto cloud = load("in.laz");
            History history(cloud);
            history.setJournal(Journal::create(journal, keyOf(*cloud, progress), "in.laz"));
            auto some = std::make_shared<PointSet>(cloud->size());
            for (PointIndex i = 100; i < cloud->size(); i += 7) some->insert(i);
            history.push(makeCommand({"set", {{"rule", "Classification = 9 if Z > 190"}}, some}, *cloud, progress));
            history.push(makeCommand({"set", {{"rule", "UserData = 7"}}, nullptr}, *cloud, progress));
            history.undo();
            history.push(makeCommand({"normals", {{"k", "8"}}, nullptr}, *cloud, progress));
            las::WriteOptions write;
            write.compressed = true;
            las::write(*cloud, path("expected.laz").toStdString(), write, progress);
        }
        const Outcome list = runPunctum({"replay", path("edits.journal"), "--list", "--json"});
        PUNCTUM_EXIT(list, 0);
        QCOMPARE(list.json()["entries"].toArray().size(), 4);
        QCOMPARE(list.json()["in_force"].toArray().size(), 2);
        PUNCTUM_EXIT(runPunctum({"replay", path("edits.journal"), path("in.laz"), "-o", path("again.laz")}), 0);
        PUNCTUM_EXIT(runPunctum({"diff", path("expected.laz"), path("again.laz")}), 0);

        // cut in its last line: what is before is done, and told
        const QByteArray whole = contentOf(path("edits.journal"));
        QFile cut(path("cut.journal"));
        QVERIFY(cut.open(QIODevice::WriteOnly) && cut.write(whole.left(whole.size() - 4)) > 0);
        cut.close();
        const Outcome part = runPunctum({"replay", path("cut.journal"), path("in.laz"), "-o", path("part.laz")});
        PUNCTUM_EXIT(part, 1);
        QVERIFY2(part.err.contains("cut off in line 6; the 3 entries before can be used."), qPrintable(part.err));
        PUNCTUM_EXIT(runPunctum({"replay", path("edits.journal"), path("again.laz"), "-o", path("x.laz")}), 1);
        QVERIFY(!QFile::exists(path("x.laz")));
        PUNCTUM_EXIT(runPunctum({"replay", path("in.laz"), path("in.laz"), "-o", path("x.laz")}), 1);
    }
};

QTEST_GUILESS_MAIN(EditCliTest)
#include "EditCliTest.moc"
