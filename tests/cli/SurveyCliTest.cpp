// SPDX-License-Identifier: MIT
// Folders and virtual point clouds on the command line: many files as one survey.
#include "tests/cli/LaszipPoints.h"
#include "tests/cli/Program.h"

#include <QDir>
#include <QFile>
#include <QFileInfo>
#include <QImage>
#include <QJsonArray>
#include <QTemporaryDir>

using namespace punctum::test;

class SurveyCliTest : public QObject
{
    Q_OBJECT

private:
    static constexpr int kTiles = 5, kPoints = 4000;

    QTemporaryDir m_folder;
    QString path(const QString& name) const { return m_folder.filePath(name); }

    /// The same file again, `shift` steps of a tile to the east: the offset and the box of the header move.
    void copyShifted(const QString& from, const QString& to, int shift)
    {
        QFile in(from);
        QVERIFY(in.open(QIODevice::ReadOnly));
        QByteArray bytes = in.readAll();
        double offset = 0, max = 0, min = 0;
        std::memcpy(&offset, bytes.data() + 155, 8);
        std::memcpy(&max, bytes.data() + 179, 8);
        std::memcpy(&min, bytes.data() + 187, 8);
        const double move = std::ceil(max - min) * shift;
        for (double* v : {&offset, &max, &min}) *v += move;
        std::memcpy(bytes.data() + 155, &offset, 8);
        std::memcpy(bytes.data() + 179, &max, 8);
        std::memcpy(bytes.data() + 187, &min, 8);
        QFile out(to);
        QVERIFY(out.open(QIODevice::WriteOnly));
        QCOMPARE(out.write(bytes), bytes.size());
    }

private slots:
    void initTestCase()
    {
        PUNCTUM_EXIT(runPunctum({"sample", path("base.laz"), "--points", QString::number(kPoints)}), 0);
        QVERIFY(QDir(m_folder.path()).mkdir("tiles"));
        for (int k = 0; k < kTiles; ++k) copyShifted(path("base.laz"), path(QString("tiles/t%1.laz").arg(k)), k);
    }

    void aFolderIsProcessedIntoAnother()
    {
        const Outcome run = runPunctum({"process", path("tiles"), "-o", path("out"), "--json", "--step",
                                        "set rule='UserData = 77 if Intensity > 1000'"});
        PUNCTUM_EXIT(run, 0);
        QCOMPARE(run.json()["points"].toInt(), kTiles * kPoints);
        const int changed = run.json()["steps"][0]["points_changed"].toInt();
        QVERIFY(changed > 0);
        const Outcome diff = runPunctum({"diff", path("tiles"), path("out"), "--json"});
        PUNCTUM_EXIT(diff, 1);
        QCOMPARE(diff.json()["files"].toInt(), kTiles);
        QCOMPARE(diff.json()["differing_files"].toArray().size(), kTiles);
        QCOMPARE(diff.json()["points"]["differing"].toInt(), changed);
        int counted = 0;
        for (int k = 0; k < kTiles; ++k) {
            const LaszipFile file(path(QString("out/t%1.laz").arg(k)));
            QCOMPARE(file.forEach([&](const laszip_point_struct& p) { counted += p.user_data == 77; }),
                     std::uint64_t(kPoints));
        }
        QVERIFY(counted >= changed);
        PUNCTUM_EXIT(runPunctum({"diff", path("tiles"), path("tiles")}), 0);
    }

    void aFolderIsPutTogether()
    {
        PUNCTUM_EXIT(runPunctum({"convert", path("tiles"), path("one.las")}), 0);
        const LaszipFile one(path("one.las"));
        QCOMPARE(one.count(), std::uint64_t(kTiles * kPoints));
        // the points of the tiles, in their order, in places of their own
        std::vector<std::array<double, 3>> expected;
        for (int k = 0; k < kTiles; ++k) {
            const LaszipFile tile(path(QString("tiles/t%1.laz").arg(k)));
            tile.forEach([&](const laszip_point_struct& p) {
                expected.push_back({p.X * tile.scale(0) + tile.offset(0), p.Y * tile.scale(1) + tile.offset(1),
                                    p.Z * tile.scale(2) + tile.offset(2)});
            });
        }
        std::size_t at = 0, wrong = 0;
        one.forEach([&](const laszip_point_struct& p) {
            const std::array<double, 3> here{p.X * one.scale(0) + one.offset(0), p.Y * one.scale(1) + one.offset(1),
                                             p.Z * one.scale(2) + one.offset(2)};
            for (std::size_t a = 0; a < 3; ++a) wrong += std::abs(here[a] - expected[at][a]) > 1e-6;
            ++at;
        });
        QCOMPARE(at, expected.size());
        QCOMPARE(wrong, std::size_t(0));
    }

    /// A picture of a folder, of a .vpc and of the files by name is one and the same, and that of one file of them
    /// all.
    void aSurveyIsDrawn()
    {
        QFile vpc(path("survey.vpc"));
        QVERIFY(vpc.open(QIODevice::WriteOnly));
        QJsonArray features;
        QStringList files;
        for (int k = 0; k < kTiles; ++k) {
            const QString name = QString("tiles/t%1.laz").arg(k);
            files << path(name);
            const QJsonObject asset{{"href", "./" + name}, {"roles", QJsonArray{"data"}}};
            features.append(QJsonObject{
                {"type", "Feature"}, {"stac_version", "1.0.0"}, {"assets", QJsonObject{{"data", asset}}}});
        }
        vpc.write(QJsonDocument(QJsonObject{{"type", "FeatureCollection"}, {"features", features}}).toJson());
        vpc.close();
        QList<QStringList> ways{{path("tiles")}, {path("survey.vpc")}, files, {path("one.las")}};
        if (!QFile::exists(path("one.las")))
            PUNCTUM_EXIT(runPunctum({"convert", path("tiles"), path("one.las")}), 0);
        QImage first;
        for (const QStringList& way : ways) {
            PUNCTUM_EXIT(runPunctum(QStringList{"render"} + way +
                                    QStringList{"-o", path("p.png"), "--size", "320x200", "--backend", "cpu",
                                                "--attribute", "Intensity", "--view", "top", "--brute-force"}),
                         0);
            const QImage picture(path("p.png"));
            QVERIFY(!picture.isNull());
            if (first.isNull()) first = picture;
            QVERIFY2(picture == first, qPrintable(way.first()));
        }
    }

    void whatCannotBeWrittenLeavesNothing()
    {
        const Outcome lossy = runPunctum({"convert", path("tiles"), path("never"), "--point-format", "0"});
        PUNCTUM_EXIT(lossy, 1);
        QVERIFY2(lossy.err.contains("--lossy"), qPrintable(lossy.err));
        QVERIFY(!QFileInfo::exists(path("never")));
        QFile plain(path("plain"));
        QVERIFY(plain.open(QIODevice::WriteOnly) && plain.write("mine") == 4);
        plain.close();
        const Outcome taken = runPunctum({"convert", path("tiles"), path("plain")});
        PUNCTUM_EXIT(taken, 1);
        QVERIFY2(taken.err.contains("plain: This is a file"), qPrintable(taken.err));
        QCOMPARE(QFileInfo(path("plain")).size(), qint64(4));
    }

    void whatCannotBeIsSaid()
    {
        QVERIFY(QDir(m_folder.path()).mkdir("empty"));
        const Outcome none = runPunctum({"info", path("empty")});
        PUNCTUM_EXIT(none, 1);
        QVERIFY(none.err.contains("There is no LAS or LAZ file in it."));
        PUNCTUM_EXIT(runPunctum({"process", path("tiles"), "-o", path("x/y/z/"), "--step", "normals k=8"}), 1);
        QVERIFY(!QFile::exists(path("x")));
        // info tells of each file
        const Outcome info = runPunctum({"info", path("tiles"), "--json"});
        PUNCTUM_EXIT(info, 0);
        QCOMPARE(QJsonDocument::fromJson(info.out).array().size(), kTiles);
        // a file of the survey may be replaced by its new self, not by all of them
        const Outcome over = runPunctum({"convert", path("tiles"), path("tiles/t0.laz")});
        PUNCTUM_EXIT(over, 1);
        QVERIFY(over.err.contains("choose another name"));
    }
};

QTEST_GUILESS_MAIN(SurveyCliTest)
#include "SurveyCliTest.moc"
