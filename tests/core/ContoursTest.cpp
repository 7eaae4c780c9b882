// SPDX-License-Identifier: MIT
// Contours and outlines: places, heights, no crossing; as GeoJSON and DXF, read back.
#include "MadeCloud.h"
#include "core/Error.h"
#include "core/raster/Contours.h"
#include "core/raster/Crossings.h"
#include "core/raster/Maps.h"
#include "core/raster/VectorFiles.h"
#include "core/task/Progress.h"

#include <QFile>
#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>
#include <QTemporaryDir>
#include <QTest>

#include <cmath>
#include <random>
#include <set>

using namespace punctum;

namespace
{

double ringArea(const std::vector<glm::dvec2>& ring)
{
    double sum = 0;
    for (std::size_t k = 0; k < ring.size(); ++k) {
        const glm::dvec2 a = ring[k] - ring[0], b = ring[(k + 1) % ring.size()] - ring[0];
        sum += a.x * b.y - a.y * b.x;
    }
    return sum / 2;
}

/// Rough ground: sums of waves and some noise, with holes.
Raster rough(std::size_t side, unsigned seed)
{
    Raster raster(RasterFrame{1.0, -100, 300, side, side});
    std::mt19937 random(seed);
    for (std::size_t r = 0; r < side; ++r)
        for (std::size_t c = 0; c < side; ++c) {
            if (std::hypot(double(c) - 40, double(r) - 60) < 9) continue;
            raster.at(c, r) =
                float(8 * std::sin(double(c) / 11) + 6 * std::cos(double(r) / 13) + double(random() % 1000) / 1500);
        }
    return raster;
}

VectorMap someMap()
{
    VectorMap map;
    map.lines.push_back({12.5, true, false, {{500000.25, 4000000.5}, {500010, 4000020}, {500030, 4000000}}});
    map.lines.push_back({13.0, false, true, {{500000, 4000000}, {500004, 4000000}, {500004, 4000004}}});
    map.areas.push_back({{{{0, 0}, {10, 0}, {10, 10}, {0, 10}}, {{2, 2}, {2, 4}, {4, 4}, {4, 2}}}, 96});
    return map;
}

}  // namespace

class ContoursTest : public QObject
{
    Q_OBJECT

private slots:
    void conesHaveCircles()
    {
        Raster cone(RasterFrame{0.5, 0, 200, 200, 200});
        for (std::size_t r = 0; r < 200; ++r)
            for (std::size_t c = 0; c < 200; ++c) {
                const glm::dvec2 p = cone.frame().middle(c, r) - glm::dvec2(50, 50);
                cone.at(c, r) = float(100 - std::hypot(p.x, p.y));
            }
        Progress progress;
        ContourOptions options;
        options.step = 5;
        options.simplify = 0;
        const auto lines = contoursOf(cone, options, progress);
        int closed = 0;
        for (const ContourLine& line : lines) {
            const double radius = 100 - line.height;
            for (const glm::dvec2& p : line.points)
                QVERIFY(std::abs(std::hypot(p.x - 50, p.y - 50) - radius) < 0.02);
            QCOMPARE(line.index, std::fmod(line.height, 25.0) == 0.0);
            if (!line.closed) continue;
            ++closed;
            // higher ground on the left: the hill's top is inside, so it goes counterclockwise
            QVERIFY(std::abs(ringArea(line.points) / (M_PI * radius * radius) - 1) < 0.02);
        }
        QCOMPARE(closed, 9);  // 55 to 95
    }

    void heightsLieBetweenTheCells()
    {
        const Raster ground = rough(120, 2);
        Progress progress;
        ContourOptions options;
        options.simplify = 0;
        const auto lines = contoursOf(ground, options, progress);
        QVERIFY(lines.size() > 20);
        for (const ContourLine& line : lines) {
            QVERIFY(line.points.size() >= 2);
            for (const glm::dvec2& p : line.points) {
                // each point is between two cells, one above and one below
                const double c = p.x - (-100 + 0.5), r = 300 - 0.5 - p.y;
                const auto c0 = std::size_t(std::floor(c + 1e-9)), r0 = std::size_t(std::floor(r + 1e-9));
                const auto c1 = std::size_t(std::ceil(c - 1e-9)), r1 = std::size_t(std::ceil(r - 1e-9));
                const double a = double(ground.at(c0, r0)), b = double(ground.at(c1, r1));
                QVERIFY(std::min(a, b) <= line.height && line.height <= std::max(a, b));
                const double t = std::max(c - double(c0), r - double(r0));
                QVERIFY(std::abs(a + (b - a) * t - line.height) < 1e-3);
            }
            // open ones end at the edge or at the hole, nowhere else
            if (line.closed) continue;
            for (const glm::dvec2& p : {line.points.front(), line.points.back()}) {
                const double c = p.x + 99.5, r = 299.5 - p.y;
                const bool atEdge = c < 0.01 || r < 0.01 || c > 118.99 || r > 118.99;
                QVERIFY(atEdge || std::hypot(c - 40, r - 60) < 11.5);
            }
        }
        const std::vector<bool> crossing = crossingLines(lines, 1.0, progress);
        QCOMPARE(std::count(crossing.begin(), crossing.end(), true), 0);
    }

    void simplifiedOnesDoNotCross_data()
    {
        QTest::addColumn<double>("simplify");
        for (const double s : {0.1, 0.5, 2.0}) QTest::addRow("%g", s) << s;
    }
    void simplifiedOnesDoNotCross()
    {
        QFETCH(double, simplify);
        const Raster ground = rough(150, 4);
        Progress progress;
        ContourOptions options;
        options.step = 0.25;
        options.simplify = 0;
        const auto all = contoursOf(ground, options, progress);
        options.simplify = simplify;
        const auto fewer = contoursOf(ground, options, progress);
        QCOMPARE(fewer.size(), all.size());
        std::size_t before = 0, after = 0;
        for (std::size_t k = 0; k < all.size(); ++k) {
            before += all[k].points.size();
            after += fewer[k].points.size();
            QCOMPARE(fewer[k].height, all[k].height);
            if (!all[k].closed) {
                QVERIFY(fewer[k].points.front() == all[k].points.front());
                QVERIFY(fewer[k].points.back() == all[k].points.back());
            }
        }
        QVERIFY2(after < before, qPrintable(QString("%1 of %2").arg(after).arg(before)));
        const std::vector<bool> crossing = crossingLines(fewer, 1.0, progress);
        QCOMPARE(std::count(crossing.begin(), crossing.end(), true), 0);
        // and the check itself sees one: the same line once more, a little turned
        auto crossed = fewer;
        ContourLine line = crossed[0];
        line.points = {{line.points[0].x - 1, line.points[0].y - 1}, {line.points[0].x + 1, line.points[0].y + 1}};
        line.closed = false;
        crossed.push_back(line);
        const std::vector<bool> seen = crossingLines(crossed, 1.0, progress);
        QVERIFY(seen[0] && seen.back());
    }

    void degenerateAndWrong()
    {
        Progress progress;
        ContourOptions options;
        QVERIFY(contoursOf(Raster(RasterFrame{1, 0, 1, 1, 1}, 3.5f), options, progress).empty());
        QVERIFY(contoursOf(Raster(RasterFrame{1, 0, 9, 9, 9}), options, progress).empty());
        QVERIFY(contoursOf(Raster(RasterFrame{1, 0, 9, 9, 9}, 3.0f), options, progress).empty());
        options.step = 0;
        QVERIFY_THROWS_EXCEPTION(Error, contoursOf(rough(20, 1), options, progress));
        options.step = 1e-9;
        QVERIFY_THROWS_EXCEPTION(Error, contoursOf(rough(20, 1), options, progress));
        options.step = 1;
        progress.cancel();
        QVERIFY_THROWS_EXCEPTION(Cancelled, contoursOf(rough(200, 1), options, progress));
    }

    void outlinesOfHouses()
    {
        // three houses, one with a yard, of points 0.25 apart
        std::vector<glm::dvec2> points;
        const auto house = [&](double x, double y, double w, double h, double yard) {
            for (double a = 0; a < w; a += 0.25)
                for (double b = 0; b < h; b += 0.25)
                    if (yard == 0 || std::abs(a - w / 2) > yard / 2 || std::abs(b - h / 2) > yard / 2)
                        points.emplace_back(x + a, y + b);
        };
        house(0, 0, 20, 10, 0);
        house(40, 5, 30, 30, 12);
        house(100, 100, 8, 8, 0);
        house(150, 0, 0.5, 0.5, 0);  // too small
        const auto cloud = makeFrame(points.size() + 1);
        for (std::size_t i = 0; i < points.size(); ++i) {
            rawAxis(*cloud, 0)[i] = std::int32_t(std::lround(points[i].x * 1000));
            rawAxis(*cloud, 1)[i] = std::int32_t(std::lround(points[i].y * 1000));
            cloud->findAttribute("Classification")->columns[0]->values<std::uint8_t>()[i] = 6;
        }
        rawAxis(*cloud, 0)[points.size()] = 300000;
        Progress progress;
        OutlineRequest request;
        request.where = "Classification == 6";
        request.cell = 0.5;
        request.leastArea = 9;
        const auto areas = outlinesOf(*cloud, request, progress);
        QCOMPARE(areas.size(), std::size_t(3));
        QCOMPARE(areas[0].rings.size(), std::size_t(2));
        QVERIFY(ringArea(areas[0].rings[0]) > 0 && ringArea(areas[0].rings[1]) < 0);
        QVERIFY2(std::abs(areas[0].area - (900 - 144)) < 60, qPrintable(QString::number(areas[0].area)));
        QVERIFY2(std::abs(areas[1].area - 200) < 15, qPrintable(QString::number(areas[1].area)));
        QVERIFY(areas[0].rings[0].size() <= 16);
        for (const glm::dvec2& p : areas[1].rings[0]) QVERIFY(p.x > -1 && p.x < 21 && p.y > -1 && p.y < 11);
        request.convex = true;
        request.where.clear();
        const auto hull = outlinesOf(*cloud, request, progress);
        QCOMPARE(hull.size(), std::size_t(1));
        for (const glm::dvec2& p : points)
            for (std::size_t k = 0; k < hull[0].rings[0].size(); ++k) {
                const glm::dvec2 a = hull[0].rings[0][k], b = hull[0].rings[0][(k + 1) % hull[0].rings[0].size()];
                QVERIFY((b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x) >= -1e-6);
            }
    }

    void asGeoJson()
    {
        MapCrs crs;
        crs.horizontal = 26910;
        crs.text = "EPSG:26910";
        Progress progress;
        const auto text = QByteArray::fromStdString(geoJsonText(someMap(), crs, {}, progress));
        QJsonParseError error;
        const QJsonObject root = QJsonDocument::fromJson(text, &error).object();
        QCOMPARE(error.errorString(), QString("no error occurred"));
        QCOMPARE(root["crs"]["properties"]["name"].toString(), QString("urn:ogc:def:crs:EPSG::26910"));
        const QJsonArray features = root["features"].toArray();
        QCOMPARE(features.size(), 3);
        QCOMPARE(features[0]["properties"]["elevation"].toDouble(), 12.5);
        QCOMPARE(features[0]["properties"]["index"].toBool(), true);
        QCOMPARE(features[0]["geometry"]["type"].toString(), QString("LineString"));
        QCOMPARE(features[0]["geometry"]["coordinates"][0][0].toDouble(), 500000.25);
        QCOMPARE(features[1]["geometry"]["coordinates"].toArray().size(), 4);  // closed: the first again
        QCOMPARE(features[2]["geometry"]["coordinates"].toArray().size(), 2);
        QCOMPARE(features[2]["properties"]["area"].toDouble(), 96.0);
        VectorOptions wgs84;
        wgs84.wgs84 = true;
        VectorMap map;
        map.lines = someMap().lines;
        const QJsonObject world =
            QJsonDocument::fromJson(QByteArray::fromStdString(geoJsonText(map, crs, wgs84, progress))).object();
        QVERIFY(!world.contains("crs"));
        // the middle of zone 10 at 4,000,000 m north
        const QJsonValue first = world["features"][0]["geometry"]["coordinates"][0];
        QVERIFY(std::abs(first[0].toDouble() + 123.0) < 1e-4 && std::abs(first[1].toDouble() - 36.1443) < 1e-3);
        QVERIFY_THROWS_EXCEPTION(Error, geoJsonText(map, {}, wgs84, progress));
    }

    void asDxf()
    {
        Progress progress;
        const std::string text = dxfText(someMap(), {}, progress);
        const QStringList lines = QString::fromStdString(text).split('\n');
        QVERIFY(lines.size() % 2 == 1 && lines.last().isEmpty());
        int polylines = 0, vertices = 0, ends = 0;
        std::set<QString> layers;
        for (int k = 0; k + 1 < lines.size(); k += 2) {
            bool isCode = false;
            const int code = lines[k].toInt(&isCode);
            QVERIFY(isCode);
            const QString value = lines[k + 1];
            polylines += code == 0 && value == "POLYLINE";
            vertices += code == 0 && value == "VERTEX";
            ends += code == 0 && value == "SEQEND";
            if (code == 8) layers.insert(value);
        }
        QCOMPARE(polylines, 4);
        QCOMPARE(ends, 4);
        QCOMPARE(vertices, 3 + 3 + 4 + 4);
        QCOMPARE(layers, (std::set<QString>{"CONTOUR", "CONTOUR_INDEX", "OUTLINE"}));
        QVERIFY(text.find("VERTEX\n8\nCONTOUR_INDEX\n10\n500000.250\n20\n4000000.500\n30\n12.500000\n") !=
                std::string::npos);
        QVERIFY(text.ends_with("0\nEOF\n"));
    }

    void asFiles()
    {
        QTemporaryDir folder;
        Progress progress;
        for (const char* name : {"a.geojson", "b.json", "c.DXF"}) {
            const QString path = folder.filePath(name);
            writeVectors(path.toStdString(), someMap(), {}, {}, progress);
            QVERIFY(QFile(path).size() > 500);
        }
        QVERIFY_THROWS_EXCEPTION(Error,
                                 writeVectors(folder.filePath("d.shp").toStdString(), someMap(), {}, {}, progress));
        QVERIFY(!QFile::exists(folder.filePath("d.shp")));
    }
};

QTEST_APPLESS_MAIN(ContoursTest)
#include "ContoursTest.moc"
