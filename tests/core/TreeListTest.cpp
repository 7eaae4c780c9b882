// SPDX-License-Identifier: MIT
// The list of trees: against what was made, in any order of points, in the files' words.
#include "core/Error.h"
#include "core/raster/TreeList.h"
#include "core/raster/VectorFiles.h"
#include "core/steps/Steps.h"
#include "core/task/Progress.h"
#include "tests/core/Complaint.h"
#include "tests/core/MadeCloud.h"

#include <QTest>

#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

using namespace punctum;

namespace
{

using Cloud = std::shared_ptr<PointCloud>;

struct MadePoint {
    double x, y, z;
    unsigned code, tree;
};

/// Centimeters on level ground; the trees' numbers are in Tree, since there is no TreeId.
Cloud makeWood(std::vector<MadePoint> points, unsigned seed)
{
    std::shuffle(points.begin(), points.end(), std::mt19937(seed));
    const auto cloud = makeFrame(points.size(), {glm::dvec3(0.01), glm::dvec3(500'000, 5'000'000, 100)});
    setMeters(*cloud);
    const auto codes = cloud->findAttribute("Classification")->columns[0]->values<std::uint8_t>();
    const auto trees = addScalar<std::uint8_t>(*cloud, "Tree");
    for (std::size_t i = 0; i < points.size(); ++i) {
        rawAxis(*cloud, 0)[i] = std::int32_t(std::lround(100 * points[i].x));
        rawAxis(*cloud, 1)[i] = std::int32_t(std::lround(100 * points[i].y));
        rawAxis(*cloud, 2)[i] = std::int32_t(std::lround(100 * points[i].z));
        codes[i] = std::uint8_t(points[i].code);
        trees[i] = std::uint8_t(points[i].tree);
    }
    return cloud;
}

/// A slope that rises by 1 in 10 along X, a tree of 4 m x 3 m, one of a single point, and one of a line.
std::vector<MadePoint> wood(bool ground = true)
{
    std::vector<MadePoint> points;
    for (int y = 0; y <= 50; ++y)
        for (int x = 0; x <= 50; ++x)
            if (ground) points.push_back({double(x), double(y), 0.1 * x, 2, 0});
    for (int k = 0; k <= 40; ++k)
        for (int l = 0; l <= 30; ++l)
            points.push_back({10 + 0.1 * k, 10 + 0.1 * l, 0.1 * (10 + 0.1 * k) + 5 + 0.01 * l, 5, 7});
    points.push_back({30, 30, 20, 5, 2});
    for (int k = 0; k < 10; ++k) points.push_back({40, 20 + 0.5 * k, 12, 5, 200});
    return points;
}

TreeList list(const PointCloud& cloud, const std::string& where = {})
{
    Progress progress;
    return listTrees(cloud, {"Tree", where, "2"}, progress);
}

}  // namespace

class TreeListTest : public QObject
{
    Q_OBJECT
private slots:
    void tellsWhatWasMade()
    {
        const TreeList found = list(*makeWood(wood(), 1));
        QCOMPARE(found.trees.size(), std::size_t(3));
        QCOMPARE(found.unit, std::string("m"));
        QVERIFY(found.finding.empty());
        const TreeRecord &one = found.trees[0], &tree = found.trees[1], &line = found.trees[2];
        QCOMPARE(one.id, std::int64_t(2));
        QCOMPARE(one.points, std::uint64_t(1));
        QCOMPARE(one.top.x, 500'030.0);
        QCOMPARE(one.top.z, 120.0);
        QVERIFY(std::fabs(one.height - 17) < 1e-3);
        QCOMPARE(one.crownArea, 0.0);
        QCOMPARE(tree.id, std::int64_t(7));
        QCOMPARE(tree.points, std::uint64_t(41 * 31));
        QVERIFY(std::fabs(tree.crownArea - 12) < 1e-9);
        // the highest above the slope, not above the sea: all along the northern edge, by the rule of the least X
        QVERIFY2(std::fabs(tree.height - 5.3) < 0.011, qPrintable(QString::number(tree.height)));
        QCOMPARE(tree.top.y, 5'000'013.0);
        QCOMPARE(line.id, std::int64_t(200));
        QCOMPARE(line.crownArea, 0.0);
    }

    void orderAndThreadsDoNotMatter()
    {
        // more points than a task takes
        std::vector<MadePoint> points = wood();
        std::mt19937 random(9);
        for (int k = 0; k < 200'000; ++k)
            points.push_back({(random() % 5000) / 100.0, (random() % 5000) / 100.0, 10 + (random() % 1000) / 100.0,
                              5, 1 + unsigned(random() % 90)});
        const auto texts = [&](unsigned seed, std::size_t threads) {
            const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
            Progress progress;
            return csvText(treeTable(list(*makeWood(points, seed))), {}, {}, progress);
        };
        const std::string once = texts(1, 1);
        QCOMPARE(texts(2, 4), once);
        QCOMPARE(std::count(once.begin(), once.end(), '\n'), std::ptrdiff_t(92));
    }

    void withoutGroundHeightsAreNotKnown()
    {
        const TreeList found = list(*makeWood(wood(false), 3));
        QVERIFY(found.finding.find("not known") != std::string::npos);
        QCOMPARE(found.trees.size(), std::size_t(3));
        QVERIFY(std::isnan(found.trees[1].height));
        // the highest by Z
        QCOMPARE(found.trees[1].top, glm::dvec3(500'014, 5'000'013, 106.7));
        Progress progress;
        const std::string csv = csvText(treeTable(found), {}, {}, progress);
        QVERIFY2(csv.starts_with("id,x,y,z,height,crown_area,points\n2,500030,5000030,120,,0,1\n"), csv.c_str());
        const std::string json = geoJsonText({{}, {}, treeTable(found)}, {}, {}, progress);
        QVERIFY(json.find("{\"id\":2,\"z\":120,\"height\":null,\"crown_area\":0,\"points\":1}") !=
                std::string::npos);
    }

    void someAloneAndDeletedOnes()
    {
        const Cloud cloud = makeWood(wood(), 4);
        QCOMPARE(list(*cloud, "Tree < 100").trees.size(), std::size_t(2));
        Progress progress;
        const ParsedStep step = parseStep("delete where='Tree == 7'");
        step.step->run(*cloud, step.values, progress)->apply(*cloud);
        QCOMPARE(list(*cloud).trees.size(), std::size_t(2));
        QVERIFY(complaint([&] { list(*cloud, "Tree == 7"); }).find("There is no point for which Tree == 7") == 0);
        QVERIFY(complaint([&] { list(*cloud, "Tree == 0"); }).find("No point is of a tree") == 0);
        QVERIFY(complaint([&] { listTrees(*cloud, {}, progress); }).find("run the step trees first") !=
                std::string::npos);
    }

    void writesFiles()
    {
        Progress progress;
        VectorMap map;
        map.table = treeTable(list(*makeWood(wood(), 5)));
        VectorOptions degrees;
        degrees.wgs84 = true;
        QVERIFY(complaint([&] {
                    writeVectors("/nowhere/x.csv", map, {}, degrees, progress);
                }).find("not longitude") != std::string::npos);
        QVERIFY(complaint([&] {
                    writeVectors("/nowhere/x.csv", {}, {}, {}, progress);
                }).find("no lines and areas") != std::string::npos);
        QVERIFY(complaint([&] { writeVectors("/nowhere/x.shp", map, {}, {}, progress); }).find(".csv, .geojson") !=
                std::string::npos);
        const std::string dxf = dxfText(map, {}, progress);
        QVERIFY(dxf.find("POINT\n8\nTREE\n10\n500030.000\n20\n5000030.000\n30\n120.000000\n") != std::string::npos);
    }

    void cancels()
    {
        const Cloud cloud = makeWood(wood(), 6);
        Progress progress;
        progress.cancel();
        QVERIFY_EXCEPTION_THROWN(listTrees(*cloud, {"Tree", {}, "2"}, progress), Cancelled);
    }
};

QTEST_APPLESS_MAIN(TreeListTest)
#include "TreeListTest.moc"
