// SPDX-License-Identifier: MIT
// punctum raster, contours and outline: files that other programs can read, and sentences for what cannot be.
#include "tests/cli/Program.h"

#include <QJsonArray>
#include <QTemporaryDir>

#include <cmath>

using namespace punctum::test;

class MapsCliTest : public QObject
{
    Q_OBJECT

private:
    QTemporaryDir m_folder;
    QString path(const QString& name) const { return m_folder.filePath(name); }
    QByteArray contents(const QString& name) const
    {
        QFile file(path(name));
        return file.open(QIODevice::ReadOnly) ? file.readAll() : QByteArray();
    }

private slots:
    void initTestCase() { PUNCTUM_EXIT(runPunctum({"sample", path("in.las"), "--points", "100000"}), 0); }

    void makesRasters_data()
    {
        QTest::addColumn<QStringList>("words");
        for (const char* kind : {"dtm", "dsm", "chm", "density", "hillshade", "slope", "aspect"})
            QTest::addRow("%s", kind) << QStringList{"--of", kind};
        QTest::addRow("mean") << QStringList{"--of", "Intensity", "--statistic", "mean"};
        QTest::addRow("p95") << QStringList{"--of", "Z", "--statistic", "p95", "--where", "ReturnNumber == 1"};
        QTest::addRow("classes") << QStringList{"--of", "Classification", "--statistic", "majority"};
    }
    void makesRasters()
    {
        QFETCH(QStringList, words);
        const Outcome run = runPunctum(
            QStringList{"raster", path("in.las"), "-o", path("out.tif"), "--cell", "2", "--json"} + words);
        PUNCTUM_EXIT(run, 0);
        const QJsonObject said = run.json().object();
        QCOMPARE(said["cell"].toDouble(), 2.0);
        QCOMPARE(std::fmod(said["west"].toDouble(), 2.0), 0.0);
        QCOMPARE(std::fmod(said["north"].toDouble(), 2.0), 0.0);
        QVERIFY(said["filled"].toDouble() > 0.3 * said["columns"].toDouble() * said["rows"].toDouble());
        const QByteArray bytes = contents("out.tif");
        QVERIFY(bytes.startsWith("II*") && bytes.contains("LAYOUT=IFDS_BEFORE_DATA"));
        QCOMPARE(double(bytes.size()), said["bytes"].toDouble());
        QFile::remove(path("out.tif"));
    }

    void volumesOfPolygons()
    {
        // areas of one command are read by the other, in either coordinate system
        for (const bool wgs84 : {false, true}) {
            const QString areas = path(wgs84 ? "wgs84.geojson" : "own.geojson");
            QStringList words{"outline", path("in.las"), "-o", areas, "--convex"};
            if (wgs84) words << "--wgs84";
            PUNCTUM_EXIT(runPunctum(words), 0);
            const Outcome run = runPunctum({"volume", path("in.las"), "--polygons", areas, "--json"});
            PUNCTUM_EXIT(run, 0);
            QCOMPARE(run.json()["base"].toString(), QString("outline"));
            const QJsonArray all = run.json()["polygons"].toArray();
            QCOMPARE(all.size(), 1);
            const QJsonObject one = all[0].toObject();
            QCOMPARE(one["name"].toString(), QString("1"));
            const double area = one["area"].toDouble() + one["area_without_surface"].toDouble();
            const Outcome within =
                runPunctum({"volume", path("in.las"), "--within", "Z > -1e9", "--base", "plane", "--json"});
            PUNCTUM_EXIT(within, 0);
            const double wanted =
                within.json()["area"].toDouble() + within.json()["area_without_surface"].toDouble();
            QVERIFY2(std::abs(area / wanted - 1) < (wgs84 ? 1e-3 : 1e-5),
                     qPrintable(QString::number(area / wanted)));
            QVERIFY(one["deviation"].toDouble() > 0 && one["edge"].toDouble() > 0);
        }
    }

    void volumesOfCorners()
    {
        const auto refused = [&](const QStringList& words, const char* why) {
            const Outcome run = runPunctum(QStringList{"volume", path("in.las")} + words);
            return run.exitCode == 2 && run.err.contains(why);
        };
        QVERIFY(refused({}, "--base is needed"));
        QVERIFY(refused({"--base", "plane"}, "needs an area"));
        QVERIFY(refused({"--corners", "1,2:3,4"}, "three corners"));
        QVERIFY(refused({"--corners", "1,2:3,4:5"}, "no corner"));
        QVERIFY(refused({"--classes", "ground", "--base", "3"}, "no classes"));
        QFile bad(path("bad.geojson"));
        for (const char* text :
             {"", "[]", "{}", "{\"type\":\"FeatureCollection\"}",
              "{\"type\":\"Polygon\",\"coordinates\":[[[1,2],[3],[4,5],[1,2]]]}",
              "{\"type\":\"Polygon\",\"coordinates\":7}", "{\"type\":\"Polygon\",\"coordinates\":[[[1,2],[1,2]]]}",
              "{\"type\":\"FeatureCollection\",\"features\":[7,null,{\"geometry\":3}]}"}) {
            QVERIFY(bad.open(QIODevice::WriteOnly) && bad.write(text) >= 0);
            bad.close();
            const Outcome run = runPunctum({"volume", path("in.las"), "--polygons", bad.fileName()});
            QVERIFY2(run.exitCode == 1 && run.err.contains("bad.geojson"), qPrintable(run.err));
        }
        // far from everything
        const Outcome far = runPunctum({"volume", path("in.las"), "--corners", "1,2:3,4:5,9"});
        QCOMPARE(far.exitCode, 1);
        QVERIFY2(far.err.contains("no surface along the outline"), qPrintable(far.err));
    }

    void aPresetFits()
    {
        const Outcome run = runPunctum({"raster", path("in.las"), "-o", path("fit.tif"), "--of", "dsm", "--json"});
        PUNCTUM_EXIT(run, 0);
        const double cell = run.json()["cell"].toDouble();
        QVERIFY2(cell > 0.1 && cell < 20, qPrintable(QString::number(cell)));
    }

    void drawsContoursAndOutlines()
    {
        for (const char* name : {"c.geojson", "c.dxf"}) {
            const Outcome run =
                runPunctum({"contours", path("in.las"), "-o", path(name), "--step", "2", "--cell", "2", "--json"});
            PUNCTUM_EXIT(run, 0);
            QVERIFY(run.json()["contours"].toInt() > 3);
        }
        const QJsonObject lines = QJsonDocument::fromJson(contents("c.geojson")).object();
        QVERIFY(lines["features"].toArray().size() > 3);
        for (const auto& f : lines["features"].toArray()) {
            const double height = f.toObject()["properties"].toObject()["elevation"].toDouble();
            QCOMPARE(std::fmod(height, 2.0), 0.0);
        }
        QVERIFY(contents("c.dxf").contains("CONTOUR_INDEX"));
        const Outcome areas = runPunctum(
            {"outline", path("in.las"), "-o", path("o.geojson"), "--where", "Classification == 2", "--json"});
        PUNCTUM_EXIT(areas, 0);
        QVERIFY(areas.json()["areas"].toInt() > 0);
        QVERIFY(areas.json()["area"].toDouble() > 0);
        const Outcome hull = runPunctum({"outline", path("in.las"), "-o", path("h.dxf"), "--convex"});
        PUNCTUM_EXIT(hull, 0);
        QCOMPARE(hull.out, (path("h.dxf") + ": 1 area\n").toUtf8());
    }

    void listsTrees()
    {
        PUNCTUM_EXIT(runPunctum({"process", path("in.las"), "-o", path("trees.laz"), "--step", "trees"}), 0);
        const Outcome run = runPunctum({"trees", path("trees.laz"), "-o", path("t.csv"), "--json"});
        PUNCTUM_EXIT(run, 0);
        const int trees = run.json()["trees"].toInt();
        QVERIFY(trees > 10);
        const QList<QByteArray> lines = contents("t.csv").trimmed().split('\n');
        QCOMPARE(lines.size(), trees + 1);
        QCOMPARE(lines[0], QByteArray("id,x,y,z,height,crown_area,points"));
        for (int k = 1; k < lines.size(); ++k) {
            const QList<QByteArray> values = lines[k].split(',');
            QCOMPARE(values.size(), 7);
            QCOMPARE(values[0].toInt(), k);
            QVERIFY(values[4].toDouble() >= 2 && values[6].toInt() >= 1);
        }
        PUNCTUM_EXIT(runPunctum({"trees", path("trees.laz"), "-o", path("t.geojson")}), 0);
        const QJsonArray features = QJsonDocument::fromJson(contents("t.geojson")).object()["features"].toArray();
        QCOMPARE(features.size(), trees);
        const QJsonObject first = features[0].toObject();
        QCOMPARE(first["geometry"].toObject()["type"].toString(), QStringLiteral("Point"));
        QCOMPARE(first["geometry"].toObject()["coordinates"].toArray()[0].toDouble(),
                 lines[1].split(',')[1].toDouble());
        QCOMPARE(first["properties"].toObject()["points"].toInt(), lines[1].split(',')[6].toInt());
        PUNCTUM_EXIT(runPunctum({"trees", path("trees.laz"), "-o", path("t.dxf"), "--id", "TreeId"}), 0);
        QCOMPARE(contents("t.dxf").count("POINT\n"), trees);
    }

    void saysWhatIsWrong_data()
    {
        QTest::addColumn<QStringList>("words");
        QTest::addColumn<int>("code");
        const QString in = path("in.las");
        QTest::addRow("ending") << QStringList{"raster", in, "-o", path("x.png"), "--of", "dtm"} << 2;
        QTest::addRow("statistic") << QStringList{"raster", in,  "-o",          path("x.tif"),
                                                  "--of",   "Z", "--statistic", "x"}
                                   << 2;
        QTest::addRow("statistic of dtm")
            << QStringList{"raster", in, "-o", path("x.tif"), "--of", "dtm", "--statistic", "max"} << 2;
        QTest::addRow("cell") << QStringList{"raster", in, "-o", path("x.tif"), "--of", "dtm", "--cell", "0"} << 2;
        QTest::addRow("condition") << QStringList{"raster", in, "-o", path("x.tif"), "--of", "Z", "--where", "Z >"}
                                   << 2;
        QTest::addRow("too small") << QStringList{"raster", in, "-o", path("x.tif"), "--of", "Z", "--cell", "1e-5"}
                                   << 1;
        QTest::addRow("attribute") << QStringList{"raster", in, "-o", path("x.tif"), "--of", "Wetness"} << 1;
        QTest::addRow("no ground") << QStringList{"raster", in,    "-o",       path("x.tif"),
                                                  "--of",   "dtm", "--ground", "200"}
                                   << 1;
        QTest::addRow("no point") << QStringList{"raster", in,  "-o",      path("x.tif"),
                                                 "--of",   "Z", "--where", "Z > 1e9"}
                                  << 1;
        QTest::addRow("folder") << QStringList{"raster", in, "-o", path("no/x.tif"), "--of", "Z"} << 1;
        QTest::addRow("step") << QStringList{"contours", in, "-o", path("x.dxf")} << 2;
        QTest::addRow("shape") << QStringList{"contours", in, "-o", path("x.shp"), "--step", "1"} << 2;
        QTest::addRow("no trees") << QStringList{"trees", in, "-o", path("x.csv")} << 1;
        QTest::addRow("no class") << QStringList{"outline",     in,        "-o",
                                                 path("x.dxf"), "--where", "Classification == 77"}
                                  << 1;
        QTest::addRow("no numbers") << QStringList{"trees", in, "-o", path("x.csv"), "--id", "UserData"} << 1;
        QTest::addRow("table") << QStringList{"trees", in, "-o", path("x.tif")} << 2;
        QTest::addRow("dxf") << QStringList{"outline", in, "-o", path("x.dxf"), "--wgs84"} << 1;
    }
    void saysWhatIsWrong()
    {
        QFETCH(QStringList, words);
        QFETCH(int, code);
        const Outcome run = runPunctum(words);
        PUNCTUM_EXIT(run, code);
        QVERIFY2(run.oneSentence(), run.said());
        for (const char* name : {"x.tif", "x.png", "x.dxf", "x.shp", "x.csv"}) QVERIFY(!QFile::exists(path(name)));
    }

    /// Heights in feet above meters: the slope is one of 45 degrees.
    void slopesAreTrue()
    {
        const QString slope = QStringLiteral(PUNCTUM_TEST_DATA "/cases/slope-m-ftus.las");
        if (!QFile::exists(slope)) QSKIP("slope-m-ftus.las is not here.");
        const Outcome run =
            runPunctum({"raster", slope, "-o", path("slope.tif"), "--of", "slope", "--surface", "dsm", "--json"});
        PUNCTUM_EXIT(run, 0);
        const Outcome map = runPunctum({"raster", slope, "-o", path("slope2.tif"), "--of", "dsm", "--json"});
        PUNCTUM_EXIT(map, 0);
        QVERIFY(run.json()["filled"].toInt() > 0);
    }
};

QTEST_GUILESS_MAIN(MapsCliTest)
#include "MapsCliTest.moc"
