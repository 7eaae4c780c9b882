// SPDX-License-Identifier: MIT
// punctum bench: the keys that the documents promise, with figures that can be true.
#include "tests/cli/Program.h"

#include <QTemporaryDir>

using namespace punctum::test;

namespace
{

/// Whether this is {"median", "min", "max"} in order, all of them at least `least`.
bool isFigure(const QJsonValue& value, double least = 0)
{
    const double low = value["min"].toDouble(-1);
    const double middle = value["median"].toDouble(-1);
    const double high = value["max"].toDouble(-1);
    return low >= least && low <= middle && middle <= high;
}

}  // namespace

class BenchCliTest : public QObject
{
    Q_OBJECT

private:
    QTemporaryDir m_folder;
    QString path(const QString& name) const { return m_folder.filePath(name); }

private slots:
    void initTestCase()
    {
        PUNCTUM_EXIT(runPunctum({"sample", path("in.las"), "--points", "200000"}), 0);
        PUNCTUM_EXIT(runPunctum({"convert", path("in.las"), path("in.laz")}), 0);
    }

    void measuresLoading()
    {
        for (const char* name : {"in.las", "in.laz"}) {
            const Outcome run = runPunctum({"bench", "load", path(name), "--json", "--rounds", "3"});
            PUNCTUM_EXIT(run, 0);
            const QJsonObject figures = run.json().object();
            QCOMPARE(figures["points"].toInt(), 200'000);
            for (const char* key : {"seconds", "mpts_per_s", "first_image_ms"})
                QVERIFY2(isFigure(figures[key], 1e-6), key);
            QVERIFY(isFigure(figures["rss_bytes_per_point"]));
            const bool laz = QString(name).endsWith(".laz");
            QCOMPARE(figures.contains("laszip_loop_mpts_per_s"), laz);
            QCOMPARE(figures.contains("ratio_to_laszip_loop"), laz);
            QCOMPARE(figures.contains("bare_deinterleave_mpts_per_s"), !laz);
        }
    }

    void measuresOpening()
    {
        QVERIFY(QDir().mkpath(path("tiles")));
        for (const char* name : {"tiles/a.laz", "tiles/b.laz"}) QVERIFY(QFile::copy(path("in.laz"), path(name)));
        const Outcome run =
            runPunctum({"bench", "open", path("tiles"), "--json", "--rounds", "1", "--memory", "16M"});
        PUNCTUM_EXIT(run, 0);
        const QJsonObject figures = run.json().object();
        QCOMPARE(figures["parts"].toInt(), 2);
        QCOMPARE(figures["points"].toInt(), 400'000);
        for (const char* when : {"cold", "again"})
            for (const char* key : {"headers_ms", "first_picture_ms", "overview_ms", "complete_ms", "points_drawn",
                                    "street_ms", "street_from", "street_read_ms", "peak_rss_mb"})
                QVERIFY2(isFigure(figures[when][key], 1e-6), key);
    }

    void measuresDrawing()
    {
        const Outcome run =
            runPunctum({"bench", "render", path("in.las"), "--json", "--rounds", "1", "--size", "320x200"});
        PUNCTUM_EXIT(run, 0);
        const QJsonObject figures = run.json().object();
        for (const char* key : {"brute_force_ms", "mpts_per_s", "converge_ms"})
            QVERIFY2(isFigure(figures[key], 1e-6), key);
        for (const char* key : {"frame_ms", "frame_ms_p95"}) QVERIFY2(isFigure(figures["orbit"][key], 1e-6), key);
        QVERIFY(isFigure(figures["orbit"]["coverage"], 0.5));
        QVERIFY(figures["orbit"]["coverage"]["max"].toDouble() <= 1.001);
        QCOMPARE(figures["idle_frames"]["max"].toInt(), 0);
        QCOMPARE(figures["backend"].toString(), QString("cpu"));
        for (const char* key : {"reproject", "fill", "resolve"})
            QVERIFY2(isFigure(figures["passes"][key], 1e-6), key);
        QCOMPARE(figures["passes"]["stream"]["max"].toDouble() < 10, true);
        QCOMPARE(figures["bytes_up"]["max"].toInt(), 0);
        QCOMPARE(figures["bytes_down"]["max"].toInt(), 0);
        QCOMPARE(figures["holes_closed"].toBool(), false);
    }

    // What the window draws with: holes are closed, and with OpenGL no picture comes back.
    void measuresTheWindow_data()
    {
        QTest::addColumn<QString>("backend");
        for (const char* backend : {"cpu", "gl-compute", "gl-points"}) QTest::newRow(backend) << backend;
    }
    void measuresTheWindow()
    {
        QFETCH(QString, backend);
        const Outcome run =
            runPunctum({"bench", "render", path("in.las"), "--json", "--rounds", "1", "--size", "160x100",
                        "--budget-points", "20000", "--backend", backend, "--as-window"});
        if (run.exitCode != 0 && run.err.contains("OpenGL")) QSKIP("This machine has no OpenGL.");
        PUNCTUM_EXIT(run, 0);
        const QJsonObject figures = run.json().object();
        QCOMPARE(figures["backend"].toString(), backend);
        QVERIFY(figures["as_window"].toBool() && figures["holes_closed"].toBool());
        for (const char* key : {"reproject", "fill", "resolve"})
            QVERIFY2(isFigure(figures["passes"][key], 1e-6), key);
        QVERIFY(figures["bytes_down"]["max"].toDouble() <= (backend == "cpu" ? 0 : 64));
    }

    // A step runs beside the turn, and ends with it however long it would take.
    void measuresATurnBesideAStep()
    {
        const Outcome run =
            runPunctum({"bench", "render", path("in.las"), "--json", "--rounds", "1", "--size", "160x100",
                        "--budget-points", "20000", "--backend", "cpu", "--while", "normals k=16"});
        PUNCTUM_EXIT(run, 0);
        const QJsonObject figures = run.json().object();
        QCOMPARE(figures["step"].toString(), QStringLiteral("normals k=16"));
        QVERIFY(isFigure(figures["orbit"]["frame_ms_p95"], 1e-6) && figures["while"]["runs"].isObject());
        const Outcome wrong = runPunctum({"bench", "render", path("in.las"), "--while", "normals k=0"});
        PUNCTUM_EXIT(wrong, 2);
    }

    void measuresTheRest_data()
    {
        QTest::addColumn<QStringList>("arguments");
        QTest::addColumn<QStringList>("keys");
        QTest::newRow("save") << QStringList{"save"}
                              << QStringList{"seconds", "mpts_per_s", "write_seconds", "write_mpts_per_s"};
        QTest::newRow("save as LAZ") << QStringList{"save", "--as", "laz"}
                                     << QStringList{"seconds", "write_mpts_per_s", "laszip_loop_mpts_per_s",
                                                    "ratio_to_laszip_loop"};
        QTest::newRow("attribute") << QStringList{"attribute"}
                                   << QStringList{"switch_visible_ms", "switch_all_ms", "mpts_per_s",
                                                  "turning_frame_ms_p95"};
        QTest::newRow("view") << QStringList{"view", "--share", "0.2"}
                              << QStringList{"full_picture_ms", "points_read", "brute_force_ms"};
        QTest::newRow("section") << QStringList{"view", "--section", "0.01"}
                                 << QStringList{"full_picture_ms", "points_read", "brute_force_ms"};
        QTest::newRow("section in the file's order")
            << QStringList{"view", "--section", "0.01", "--file-order"}
            << QStringList{"full_picture_ms", "points_read", "brute_force_ms"};
        QTest::newRow("order") << QStringList{"order", "--size", "320x200"} << QStringList{};
        QTest::newRow("edit") << QStringList{"edit"} << QStringList{"points_changed", "visible_ms", "undo_ms"};
        QTest::newRow("select") << QStringList{"select"}
                                << QStringList{"polygon_ms",     "shown_ms",           "rule_mpts_per_s",
                                               "brush.frame_ms", "brush.frame_ms_p95", "brush.behind_ms"};
        QTest::newRow("process") << QStringList{"process", "--step", "reclassify attribute=Z min=0 max=1 class=2"}
                                 << QStringList{"seconds", "mpts_per_s"};
    }
    void measuresTheRest()
    {
        QFETCH(QStringList, arguments);
        QFETCH(QStringList, keys);
        const Outcome run =
            runPunctum(QStringList{"bench"} + arguments + QStringList{path("in.las"), "--json", "--rounds", "3"});
        PUNCTUM_EXIT(run, 0);
        QCOMPARE(run.json()["points"].toInt(), 200'000);
        for (const QString& key : keys) {
            QJsonValue figure = run.json().object();
            for (const QString& part : key.split('.')) figure = figure[part];
            QVERIFY2(isFigure(figure, 1e-9), qPrintable(key));
        }
    }

    void printsText()
    {
        const Outcome run = runPunctum({"bench", "load", path("in.las"), "--rounds", "1"});
        PUNCTUM_EXIT(run, 0);
        QVERIFY(run.out.contains("mpts_per_s"));
    }
};

QTEST_GUILESS_MAIN(BenchCliTest)
#include "BenchCliTest.moc"
