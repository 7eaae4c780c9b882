// SPDX-License-Identifier: MIT
// punctum sample: a survey that any reader can read, the same for the same seed.
#include "tests/cli/LaszipPoints.h"
#include "tests/cli/Program.h"

#include <QJsonArray>
#include <QTemporaryDir>

#include <set>

using namespace punctum::test;

class SampleCliTest : public QObject
{
    Q_OBJECT

private slots:
    void writesALifelikeSurvey()
    {
        QTemporaryDir folder;
        const QString path = folder.filePath("survey.laz");
        PUNCTUM_EXIT(runPunctum({"sample", path, "--points", "500000"}), 0);
        const LaszipFile file(path);
        QCOMPARE(file.version(), 4);
        QCOMPARE(file.format(), 7);
        std::set<int> classes;
        std::set<int> returns;
        std::set<int> reds;
        double firstTime = 0;
        double lastTime = 0;
        const auto count = file.forEach([&](const laszip_point_struct& p) {
            classes.insert(p.extended_classification);
            returns.insert(p.extended_number_of_returns);
            reds.insert(p.rgb[0]);
            if (firstTime == 0) firstTime = p.gps_time;
            lastTime = p.gps_time;
            QVERIFY(p.extended_return_number >= 1 && p.extended_return_number <= p.extended_number_of_returns);
        });
        QCOMPARE(count, std::uint64_t(500'000));
        QVERIFY(classes.contains(2) && classes.contains(5) && classes.contains(6));
        QVERIFY(returns.size() >= 3);
        QVERIFY(reds.size() > 100);
        QVERIFY(lastTime != firstTime);

        const Outcome info = runPunctum({"info", "--json", path});
        PUNCTUM_EXIT(info, 0);
        std::set<QString> extra;
        for (const auto& a : info.json()["attributes"].toArray())
            if (!a.toObject()["standard"].toBool()) extra.insert(a.toObject()["name"].toString());
        QVERIFY(extra.contains("Reflectance") && extra.contains("Deviation"));
        QVERIFY(info.json()["crs"].toString().contains("UTM"));
        QVERIFY(info.json()["warnings"].toArray().isEmpty());
    }

    void dependsOnTheSeedAlone()
    {
        QTemporaryDir folder;
        const auto points = [&](const QString& name, const QStringList& more) {
            const QString path = folder.filePath(name);
            if (runPunctum(QStringList{"sample", path, "--points", "20000"} + more).exitCode != 0)
                return QByteArray();
            const QByteArray bytes = contentOf(path);
            std::uint32_t offset = 0;
            std::memcpy(&offset, bytes.constData() + 96, 4);
            return bytes.mid(offset);
        };
        const QByteArray first = points("a.las", {"--seed", "7"});
        QVERIFY(!first.isEmpty());
        QVERIFY(points("b.las", {"--seed", "7"}) == first);
        QVERIFY(points("c.las", {"--seed", "8"}) != first);
        QVERIFY(points("d.las", {}) == points("e.las", {"--seed", "1"}));
    }
};

QTEST_GUILESS_MAIN(SampleCliTest)
#include "SampleCliTest.moc"
