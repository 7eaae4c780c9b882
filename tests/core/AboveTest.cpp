// SPDX-License-Identifier: MIT
// Height above ground, vegetation, buildings and trees: against brute force, known surfaces and files that people
// have classified.
#include "core/Error.h"
#include "core/above/GroundHeights.h"
#include "core/las/Reader.h"
#include "core/steps/Steps.h"
#include "core/surface/Triangulation.h"
#include "core/task/Progress.h"
#include "tests/core/Complaint.h"
#include "tests/core/MadeCloud.h"

#include <QTest>

#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <thread>

using namespace punctum;

namespace
{

using Cloud = std::shared_ptr<PointCloud>;

std::unique_ptr<Command> run(const PointCloud& cloud, const std::string& text, const PointSet* within = nullptr)
{
    const ParsedStep parsed = parseStep(text);
    Progress progress;
    return parsed.step->run(cloud, parsed.values, progress, within);
}

/// Runs it and does what it found; what it says of it.
std::string apply(PointCloud& cloud, const std::string& text)
{
    const auto command = run(cloud, text);
    if (!command) return "nothing";
    std::string finding = command->finding();
    command->apply(cloud);
    return finding;
}

std::vector<double> valuesOf(const PointCloud& cloud, const char* name)
{
    std::vector<double> values(cloud.size());
    cloud.findAttribute(name)->read({0, cloud.size()}, values.data());
    return values;
}

void put(PointCloud& cloud, PointIndex i, double x, double y, double z, std::uint8_t code)
{
    rawAxis(cloud, 0)[i] = std::int32_t(std::lround(x));
    rawAxis(cloud, 1)[i] = std::int32_t(std::lround(y));
    rawAxis(cloud, 2)[i] = std::int32_t(std::lround(z));
    cloud.findAttribute("Classification")->columns[0]->values<std::uint8_t>()[i] = code;
}

/// Centimeters: ground of hills on a square of `side` meters, and points above it. The unit of length is the meter.
Cloud makeHills(PointIndex ground, PointIndex above, double side = 100, unsigned seed = 5)
{
    const auto cloud = makeFrame(ground + above, {glm::dvec3(0.01), glm::dvec3(5000, 7000, 0)});
    setMeters(*cloud);
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> unit;
    for (PointIndex i = 0; i < ground + above; ++i) {
        const double x = unit(random) * side, y = unit(random) * side;
        const double z = 50 + 10 * std::sin(x / 20) + 5 * std::cos(y / 15) + (i < ground ? 0.0 : 20 * unit(random));
        put(*cloud, i, 100 * x, 100 * y, 100 * z, i < ground ? 2 : 1);
    }
    return cloud;
}

/// The same points in another order; `order[i]` is where point i was.
Cloud shuffled(const PointCloud& cloud, const std::vector<PointIndex>& order)
{
    const auto other = makeFrame(cloud.size(), cloud.coordinates());
    other->setUnits(cloud.units());
    const auto classes = cloud.findAttribute("Classification")->columns[0]->values<std::uint8_t>();
    for (PointIndex i = 0; i < cloud.size(); ++i)
        put(*other, i, cloud.rawX()[order[i]], cloud.rawY()[order[i]], cloud.rawZ()[order[i]], classes[order[i]]);
    return other;
}

std::filesystem::path realFile(const char* name)
{
    return std::filesystem::path(PUNCTUM_TEST_DATA) / name;
}

/// A real file whose classes but ground are wiped; with those it had.
std::pair<Cloud, std::vector<double>> wiped(const char* name)
{
    Progress progress;
    const Cloud cloud = las::load(realFile(name), progress);
    std::vector<double> truth = valuesOf(*cloud, "Classification");
    apply(*cloud, "set rule='Classification = 1 if Classification != 2'");
    return {cloud, std::move(truth)};
}

/// A flat roof, a gable roof, a tree, a car, a hedge and a bridge on a plain: 4 points a square meter on the
/// ground.
Cloud makeVillage()
{
    struct Made {
        double x, y, z;
        std::uint8_t code;
    };
    std::vector<Made> made;
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> unit;
    std::normal_distribution<double> noise(0, 0.02);
    for (int k = 0; k < 40'000; ++k) {
        const double x = 100 * unit(random), y = 100 * unit(random);
        // a cutting, over which the bridge leads
        const double z = std::fabs(x - 80) < 6 ? -5.0 : std::fabs(x - 80) < 11 ? std::fabs(x - 80) - 11 : 0.0;
        if (y > 48 && y < 52 && std::fabs(x - 80) < 11) continue;
        made.push_back({x, y, z + noise(random), 2});
    }
    const auto add = [&](int count, std::uint8_t code, auto&& place) {
        for (int k = 0; k < count; ++k) {
            const auto [x, y, z] = place();
            made.push_back({x, y, z + noise(random), code});
        }
    };
    using Three = std::array<double, 3>;
    add(4000, 6, [&] { return Three{10 + 20 * unit(random), 10 + 10 * unit(random), 4}; });  // flat roof
    add(4000, 6, [&] {                                                                       // gable roof
        const double x = 10 + 20 * unit(random), y = 40 + 10 * unit(random);
        return Three{x, y, 6 - 0.8 * std::fabs(y - 45)};
    });
    add(6000, 5, [&] {  // a crown
        for (;;) {
            const double x = 2 * unit(random) - 1, y = 2 * unit(random) - 1, z = 2 * unit(random) - 1;
            if (x * x + y * y + z * z < 1) return Three{50 + 4 * x, 20 + 4 * y, 8 + 5 * z};
        }
    });
    add(200, 1, [&] { return Three{60 + 4 * unit(random), 60 + 2 * unit(random), 1.4}; });      // a car
    add(400, 5, [&] { return Three{10 + 30 * unit(random), 70 + unit(random), 2.5}; });         // a hedge
    add(1500, 17, [&] { return Three{69 + 22 * unit(random), 48 + 4 * unit(random), 0.02}; });  // the bridge
    const auto cloud = makeFrame(made.size(), {glm::dvec3(0.01), glm::dvec3(0)});
    setMeters(*cloud);
    for (std::size_t i = 0; i < made.size(); ++i)
        put(*cloud, i, 100 * made[i].x, 100 * made[i].y, 100 * made[i].z, made[i].code);
    return cloud;
}

}  // namespace

class AboveTest : public QObject
{
    Q_OBJECT

private slots:
    /// On a slope that is a plane, triangles give the exact height everywhere inside the ground's rim.
    void heightsOverAPlane()
    {
        const auto cloud = makeFrame(3000, {glm::dvec3(0.01), glm::dvec3(0)});
        std::mt19937_64 random(1);
        for (PointIndex i = 0; i < 3000; ++i) {
            // corners first, so that everything is inside
            const std::int32_t x = i < 4 ? std::int32_t(i % 2) * 10000 : std::int32_t(random() % 10000);
            const std::int32_t y = i < 4 ? std::int32_t(i / 2) * 10000 : std::int32_t(random() % 10000);
            put(*cloud, i, x, y, 2 * x + 3 * y + (i < 1000 ? 0 : double(i)), i < 1000 ? 2 : 1);
        }
        apply(*cloud, "height");
        const auto heights = valuesOf(*cloud, "HeightAboveGround");
        for (PointIndex i = 0; i < 3000; ++i)
            QVERIFY2(std::fabs(heights[i] - (i < 1000 ? 0.0 : double(i) * 0.01)) < 1e-4,
                     qPrintable(QString::number(heights[i])));
    }

    /// Piece by piece as from one triangulation of everything; beyond the rim, the nearest point.
    void triangulatedLikeTheWhole()
    {
        const PointIndex ground = kFastBuild ? 60'000 : 20'000, above = kFastBuild ? 40'000 : 5'000;
        const Cloud cloud = makeHills(ground, above);
        // some beyond the rim, and a hole in the ground
        for (PointIndex i = ground; i < ground + 500; ++i) rawAxis(*cloud, 0)[i] += 12'000;
        const auto classes = cloud->findAttribute("Classification")->columns[0]->values<std::uint8_t>();
        for (PointIndex i = 0; i < ground; ++i)
            if (std::hypot(cloud->rawX()[i] - 5000, cloud->rawY()[i] - 5000) < 1500) classes[i] = 1;
        apply(*cloud, "height");
        const auto heights = valuesOf(*cloud, "HeightAboveGround");

        std::vector<SurfacePoint> all;
        for (PointIndex i = 0; i < cloud->size(); ++i)
            if (classes[i] == 2) all.push_back({cloud->rawX()[i], cloud->rawY()[i], cloud->rawZ()[i], 0});
        const Triangulation whole(all);
        std::uint32_t near = 0;
        std::size_t other = 0, outside = 0;
        for (PointIndex i = ground; i < cloud->size(); ++i) {
            const double x = cloud->rawX()[i], y = cloud->rawY()[i], z = cloud->rawZ()[i];
            auto level = whole.height(x, y, near);
            if (!level) {
                ++outside;
                double least = INFINITY;
                for (const SurfacePoint& p : all) {
                    const double squared = (p.x - x) * (p.x - x) + (p.y - y) * (p.y - y);
                    if (squared < least) level = double(p.z);
                    least = std::min(least, squared);
                }
            }
            if (std::fabs(heights[i] - (z - *level) * 0.01) > 1e-4) ++other;
        }
        QVERIFY(outside >= 500);
        // triangles at the rim, whose circles are larger than any piece, may be others
        QVERIFY2(other <= 10, qPrintable(QString::number(other)));
    }

    void nearestByBruteForce()
    {
        const Cloud cloud = makeHills(500, 1500);
        apply(*cloud, "height method=nearest neighbors=4");
        const auto heights = valuesOf(*cloud, "HeightAboveGround");
        for (PointIndex i = 0; i < cloud->size(); ++i) {
            std::vector<std::pair<double, double>> all;
            for (PointIndex g = 0; g < 500; ++g)
                all.push_back({std::hypot(cloud->rawX()[i] - cloud->rawX()[g], cloud->rawY()[i] - cloud->rawY()[g]),
                               cloud->rawZ()[g]});
            std::sort(all.begin(), all.end());
            double weights = 0, sum = 0;
            for (std::size_t k = 0; k < 4; ++k) {
                if (all[0].first == 0 && all[k].first > 0) break;
                const double weight = all[0].first == 0 ? 1 : 1 / all[k].first;
                weights += weight;
                sum += weight * all[k].second;
            }
            QVERIFY(std::fabs(heights[i] - (cloud->rawZ()[i] - sum / weights) * 0.01) < 1e-4);
        }
    }

    /// However points are dealt out to files, and on one thread as on many.
    void orderAndThreadsDoNotMatter_data()
    {
        QTest::addColumn<QString>("step");
        QTest::addColumn<QString>("attribute");
        QTest::newRow("triangulated") << "height"
                                      << "HeightAboveGround";
        QTest::newRow("nearest") << "height method=nearest"
                                 << "HeightAboveGround";
        QTest::newRow("vegetation") << "vegetation"
                                    << "Classification";
        QTest::newRow("buildings") << "buildings"
                                   << "Classification";
        QTest::newRow("trees") << "trees"
                               << "TreeId";
    }
    void orderAndThreadsDoNotMatter()
    {
        QFETCH(QString, step);
        QFETCH(QString, attribute);
        const std::string text = step.toStdString();
        const Cloud made = step.startsWith("height") ? makeHills(30'000, 10'000) : makeVillage();
        std::vector<PointIndex> order(made->size());
        std::iota(order.begin(), order.end(), PointIndex(0));
        // as tiles of a survey: by quarters of the plane
        std::stable_sort(order.begin(), order.end(), [&](PointIndex a, PointIndex b) {
            const auto tile = [&](PointIndex i) { return made->rawX()[i] / 5000 * 2 + made->rawY()[i] / 5000; };
            return tile(a) > tile(b);
        });
        if (step != "height" && step != "height method=nearest")
            for (const auto& cloud : {made}) apply(*cloud, "set rule='Classification = 1 if Classification != 2'");
        const Cloud other = shuffled(*made, order);
        {
            const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
            apply(*made, text);
        }
        apply(*other, text);
        const auto a = valuesOf(*made, attribute.toUtf8()), b = valuesOf(*other, attribute.toUtf8());
        std::size_t differ = 0;
        for (PointIndex i = 0; i < made->size(); ++i) differ += a[order[i]] != b[i];
        QCOMPARE(differ, std::size_t(0));
    }

    void someAloneAndDeletedOnes()
    {
        const Cloud cloud = makeHills(500, 500);
        PointSet within(cloud->size());
        within.insert(PointRange{600, 700});
        auto deleted = std::make_shared<PointSet>(cloud->size());
        deleted->insert(650);
        for (PointIndex i = 0; i < 250; ++i) deleted->insert(i);
        cloud->setDeleted(deleted);
        const auto command = run(*cloud, "height", &within);
        command->apply(*cloud);
        const auto heights = valuesOf(*cloud, "HeightAboveGround");
        for (PointIndex i = 0; i < cloud->size(); ++i)
            QCOMPARE(std::isnan(heights[i]), i < 600 || i >= 700 || i == 650);
        command->apply(*cloud);
        QVERIFY(cloud->findAttribute("HeightAboveGround") == nullptr);
        // what is deleted is no ground
        for (PointIndex i = 250; i < 500; ++i) deleted->insert(i);
        cloud->setDeleted(std::make_shared<PointSet>(*deleted));
        QVERIFY(complaint([&] { run(*cloud, "height"); }).find("no point has class 2") != std::string::npos);
    }

    /// Heights that are older than an edit of the ground are measured anew, and that is said; others are taken.
    void staleHeights_data()
    {
        QTest::addColumn<QString>("edit");
        QTest::addColumn<bool>("stale");
        QTest::newRow("nothing") << "" << false;
        QTest::newRow("other classes") << "set rule='Classification = 5 if Z > 60 and Classification == 1'"
                                       << false;
        QTest::newRow("points that become ground") << "set rule='Classification = 2 if X < 5005'" << true;
        QTest::newRow("ground that is none") << "set rule='Classification = 1 if X < 5020'" << true;
        QTest::newRow("deleted ground") << "delete where='Classification == 2 and X < 5020'" << true;
        QTest::newRow("renewed") << "height" << false;
        QTest::newRow("by the nearest") << "height method=nearest" << false;
    }
    void staleHeights()
    {
        QFETCH(QString, edit);
        QFETCH(bool, stale);
        const Cloud cloud = makeHills(20'000, 10'000);
        apply(*cloud, "height");
        // of what was deleted before there is nothing to say
        apply(*cloud, "delete where='Classification == 2 and Y < 7010'");
        apply(*cloud, "height");
        if (!edit.isEmpty()) apply(*cloud, edit.toLatin1().constData());
        const auto trees = run(*cloud, "trees");
        QVERIFY(trees);
        const std::string finding = trees->finding();
        QCOMPARE(finding.find("measured anew") != std::string::npos, stale);
        // as if there were no attribute
        if (!stale) return;
        trees->apply(*cloud);
        const auto ids = valuesOf(*cloud, "TreeId");
        apply(*cloud, "remove attribute=HeightAboveGround");
        apply(*cloud, "remove attribute=TreeId");
        apply(*cloud, "trees");
        QVERIFY(valuesOf(*cloud, "TreeId") == ids);
        // once height was run again, they are taken
        apply(*cloud, "height");
        QVERIFY(run(*cloud, "vegetation")->finding().empty());
    }

    /// Of the attribute, measured, and measured since the attribute's are not of the ground any more.
    void highPointsAreThoseOfHeights_data()
    {
        QTest::addColumn<QStringList>("steps");
        QTest::newRow("measured") << QStringList{};
        QTest::newRow("of the attribute") << QStringList{"height"};
        QTest::newRow("stale") << QStringList{"height", "set rule='Classification = 2 if X < 5005'"};
        QTest::newRow("deleted points") << QStringList{"delete where='X > 5050'"};
    }
    void highPointsAreThoseOfHeights()
    {
        QFETCH(QStringList, steps);
        const Cloud cloud = makeHills(20'000, 10'000);
        for (const QString& step : steps) apply(*cloud, step.toLatin1().constData());
        Progress progress;
        ClassSet ground;
        ground.set(2);
        const PointHeights heights = heightsAboveGround(*cloud, ground, "test", progress);
        // one that a point has, which counts
        const std::array least{2.0, 0.5, double(heights.values[25'000]), 0.0, 1e9};
        const HighPoints high = highPoints(*cloud, ground, least, "test", progress);
        QVERIFY(high.finding == heights.finding);
        QCOMPARE(high.atLeast.size(), least.size());
        for (std::size_t k = 0; k < least.size(); ++k)
            for (PointIndex i = 0; i < cloud->size(); ++i)
                QCOMPARE(high.atLeast[k].contains(i), double(heights.values[i]) >= least[k]);
        QVERIFY(high.atLeast[0].count() > 1000 && high.atLeast[4].count() == 0);
    }
    void degenerate()
    {
        for (const char* step : {"height", "height method=nearest", "vegetation", "buildings", "trees"}) {
            QVERIFY(run(*makeFrame(0), step) == nullptr);
            QVERIFY(complaint([&] { run(*makeFrame(3), step); }).find("needs the ground") != std::string::npos);
            for (const PointIndex n : {PointIndex(1), PointIndex(2), PointIndex(3), PointIndex(100)})
                for (const int dimensions : {0, 1, 2, 3}) {
                    const auto cloud = makeFrame(2 * n);
                    for (PointIndex i = 0; i < 2 * n; ++i)
                        put(*cloud, i, dimensions > 0 ? double(i * 7 % 1000) : 5,
                            dimensions > 1 ? double(i * 31 % 977) : 5, dimensions > 2 ? double(i * 13 % 5000) : 5,
                            i < n ? 2 : 1);
                    apply(*cloud, step);
                    if (std::string(step).starts_with("height"))
                        for (const double height : valuesOf(*cloud, "HeightAboveGround"))
                            QVERIFY(std::isfinite(height));
                }
        }
        // the whole range of the integers
        const auto wide = makeFrame(8);
        for (PointIndex i = 0; i < 8; ++i)
            put(*wide, i, i % 2 ? INT32_MAX : INT32_MIN, i / 2 % 2 ? INT32_MAX : INT32_MIN, 0, i < 4 ? 2 : 1);
        apply(*wide, "height");
        for (const double height : valuesOf(*wide, "HeightAboveGround")) QCOMPARE(height, 0.0);
    }

    void vegetationByHeight()
    {
        const auto cloud = makeFrame(103, {glm::dvec3(0.01), glm::dvec3(0)});
        setMeters(*cloud);
        for (PointIndex i = 0; i < 100; ++i)
            put(*cloud, i, double(100 * i), double(100 * (i % 10)), double(10 * i), 1);
        put(*cloud, 100, 0, 0, 0, 2);
        put(*cloud, 101, 10000, 0, 0, 2);
        put(*cloud, 102, 0, 10000, 0, 2);
        cloud->findAttribute("Classification")->columns[0]->values<std::uint8_t>()[60] = 6;
        const auto before = snapshot(*cloud);
        const auto command = run(*cloud, "vegetation");
        command->apply(*cloud);
        const auto classes = valuesOf(*cloud, "Classification");
        for (PointIndex i = 0; i < 100; ++i)
            QCOMPARE(classes[i], i == 60 ? 6.0 : i < 5 ? 1.0 : i < 20 ? 3.0 : i < 50 ? 4.0 : 5.0);
        command->apply(*cloud);
        QVERIFY(snapshot(*cloud) == before);
        QVERIFY(complaint([&] { run(*cloud, "vegetation low=3 medium=2"); }).find("must rise") !=
                std::string::npos);
    }

    void buildingsOfAVillage()
    {
        const Cloud cloud = makeVillage();
        const auto truth = valuesOf(*cloud, "Classification");
        apply(*cloud, "set rule='Classification = 1 if Classification != 2'");
        QCOMPARE(apply(*cloud, "buildings"), std::string("2 buildings."));
        const auto found = valuesOf(*cloud, "Classification");
        std::map<int, std::array<std::size_t, 2>> counts;
        for (PointIndex i = 0; i < cloud->size(); ++i) {
            ++counts[int(truth[i])][0];
            counts[int(truth[i])][1] += found[i] == 6;
        }
        QVERIFY(counts[6][1] * 100 > counts[6][0] * 97);
        for (const int other : {1, 2, 5, 17}) QCOMPARE(counts[other][1], std::size_t(0));
    }

    /// A parapet stands on the roof, a mast is too high for it, and branches hang beside it.
    void whatStandsOnRoofs()
    {
        const Cloud village = makeVillage();
        const PointIndex before = village->size();
        const auto cloud = makeFrame(before + 300, village->coordinates());
        setMeters(*cloud);
        const auto classes = village->findAttribute("Classification")->columns[0]->values<std::uint8_t>();
        for (PointIndex i = 0; i < before; ++i)
            put(*cloud, i, village->rawX()[i], village->rawY()[i], village->rawZ()[i], classes[i] == 2 ? 2 : 1);
        for (PointIndex k = 0; k < 100; ++k) {  // the flat roof is 4 m high, from 10 to 30 m and 10 to 20 m
            const double along = 1200 + 16 * double(k);
            put(*cloud, before + k, along, 1050, 400 + double(k), 1);
            put(*cloud, before + 100 + k, 2000, 1500, 600 + 2 * double(k), 1);
            put(*cloud, before + 200 + k, along, 850, 450, 1);
        }
        const auto count = [&](PointIndex first) {
            const auto found = valuesOf(*cloud, "Classification");
            return std::count(found.begin() + std::ptrdiff_t(first), found.begin() + std::ptrdiff_t(first + 100),
                              6.0);
        };
        const auto command = run(*cloud, "buildings");
        command->apply(*cloud);
        QCOMPARE(count(before), 100);
        QCOMPARE(count(before + 100), 0);
        QCOMPARE(count(before + 200), 0);
        command->apply(*cloud);
        apply(*cloud, "buildings rooftop=0.5");
        QVERIFY(count(before) >= 50 && count(before) < 60);  // roofs themselves are uneven by some centimeters
    }

    /// Points of class 6 that are found, and points found that are of class 6, over IGN's tiles.
    void buildingsOfRealTiles()
    {
        if (!std::filesystem::exists(realFile("ign"))) QSKIP("The folder of real files is not here.");
        std::size_t right = 0, wrong = 0, missed = 0;
        for (const char* name : {"ign/lemans_77050_627755.laz", "ign/lemans_77050_627760.laz",
                                 "ign/lemans_77055_627755.laz", "ign/lemans_77055_627760.laz",
                                 "ign/lemans_77060_627755.laz", "ign/lemans_77060_627760.laz", "ign/mnx_bat.laz"}) {
            const auto [cloud, truth] = wiped(name);
            apply(*cloud, "buildings");
            const auto found = valuesOf(*cloud, "Classification");
            std::array<std::size_t, 3> own{};
            for (PointIndex i = 0; i < cloud->size(); ++i) {
                own[0] += truth[i] == 6 && found[i] == 6;
                own[1] += truth[i] != 6 && found[i] == 6;
                own[2] += truth[i] == 6 && found[i] != 6;
            }
            qInfo("%s: precision %.1f %%, recall %.1f %%", name, 100.0 * double(own[0]) / double(own[0] + own[1]),
                  100.0 * double(own[0]) / double(own[0] + own[2]));
            right += own[0];
            wrong += own[1];
            missed += own[2];
        }
        QVERIFY(double(right) > 0.88 * double(right + wrong));
        QVERIFY(double(right) > 0.95 * double(right + missed));
    }

    void bridgesAreNoBuildings()
    {
        if (!std::filesystem::exists(realFile("ign"))) QSKIP("The folder of real files is not here.");
        const auto [cloud, truth] = wiped("ign/bridge_0299_6802.laz");
        apply(*cloud, "buildings");
        const auto found = valuesOf(*cloud, "Classification");
        for (PointIndex i = 0; i < cloud->size(); ++i) QVERIFY(truth[i] != 17 || found[i] != 6);
    }

    /// Trees against numbers that the file has: of crowns, by half of what both have together, and of tops.
    void treesOfARealForest()
    {
        if (!std::filesystem::exists(realFile("MixedConifer.laz"))) QSKIP("The real file is not here.");
        Progress progress;
        const Cloud cloud = las::load(realFile("MixedConifer.laz"), progress);
        qInfo("%s", apply(*cloud, "trees").c_str());
        const auto truth = valuesOf(*cloud, "treeID"), found = valuesOf(*cloud, "TreeId"),
                   z = valuesOf(*cloud, "Z");
        const auto x = valuesOf(*cloud, "X"), y = valuesOf(*cloud, "Y");
        std::map<int, std::size_t> ofTruth, ofFound;
        std::map<std::pair<int, int>, std::size_t> ofBoth;
        std::map<int, PointIndex> trueTops, foundTops;
        const auto note = [&](std::map<int, PointIndex>& tops, int tree, PointIndex i) {
            PointIndex& top = tops.emplace(tree, i).first->second;
            if (z[i] > z[top]) top = i;
        };
        for (PointIndex i = 0; i < cloud->size(); ++i) {
            const int a = std::isnan(truth[i]) ? 0 : int(truth[i]), b = int(found[i]);
            if (a != 0) ++ofTruth[a], note(trueTops, a, i);
            if (b != 0) ++ofFound[b], note(foundTops, b, i);
            if (a != 0 && b != 0) ++ofBoth[{a, b}];
        }
        std::size_t crowns = 0;
        for (const auto& [pair, both] : ofBoth)
            crowns += 2 * both >= ofTruth[pair.first] + ofFound[pair.second] - both;
        std::vector<std::tuple<double, int, int>> near;
        for (const auto& [a, i] : trueTops)
            for (const auto& [b, k] : foundTops)
                if (const double apart = std::hypot(x[i] - x[k], y[i] - y[k]); apart <= 2)
                    near.push_back({apart, a, b});
        std::sort(near.begin(), near.end());
        std::set<int> taken, given;
        for (const auto& [apart, a, b] : near)
            if (!taken.contains(a) && !given.contains(b)) taken.insert(a), given.insert(b);
        qInfo("%zu trees are there; found %zu: %zu crowns agree; %zu tops found, %zu missed, %zu invented",
              ofTruth.size(), ofFound.size(), crowns, taken.size(), ofTruth.size() - taken.size(),
              ofFound.size() - taken.size());
        QVERIFY(crowns >= 148);
        QVERIFY(taken.size() >= 173);
        QVERIFY(ofFound.size() - taken.size() <= 27);
    }

    void treesOfAVillage()
    {
        const Cloud cloud = makeVillage();
        const std::string finding = apply(*cloud, "trees");
        QVERIFY2(finding.find(" trees, heights 2.") != std::string::npos && finding.ends_with(" m."),
                 finding.c_str());
        const auto ids = valuesOf(*cloud, "TreeId"), classes = valuesOf(*cloud, "Classification");
        const auto heights = valuesOf(*cloud, "Z"), x = valuesOf(*cloud, "X");
        std::map<int, std::size_t> ofCrown;
        std::size_t crown = 0;
        for (PointIndex i = 0; i < cloud->size(); ++i) {
            QVERIFY(ids[i] == 0 || classes[i] == 5);
            if (classes[i] != 5 || x[i] < 45 || heights[i] < 5) continue;
            ++crown;
            ++ofCrown[int(ids[i])];
        }
        std::size_t most = 0;
        for (const auto& [id, count] : ofCrown)
            if (id != 0) most = std::max(most, count);
        QVERIFY2(most * 10 > crown * 8, qPrintable(QString::number(most) + " of " + QString::number(crown)));
    }

    void cancels_data()
    {
        QTest::addColumn<QString>("step");
        for (const char* step : {"height", "height method=nearest", "vegetation", "buildings", "trees"})
            QTest::newRow(step) << step;
    }
    void cancels()
    {
        QFETCH(QString, step);
        static const Cloud cloud = makeHills(kFastBuild ? 300'000 : 30'000, kFastBuild ? 700'000 : 30'000, 400);
        const ParsedStep parsed = parseStep(step.toStdString());
        for (const int after : {0, 30, 150}) {
            Progress progress;
            std::atomic<bool> ended = false;
            bool cancelled = false;
            std::thread worker([&] {
                try {
                    parsed.step->run(*cloud, parsed.values, progress);
                } catch (const Cancelled&) {
                    cancelled = true;
                }
                ended = true;
            });
            std::this_thread::sleep_for(std::chrono::milliseconds(after));
            const bool early = !ended;
            const auto start = std::chrono::steady_clock::now();
            progress.cancel();
            worker.join();
            const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
            QVERIFY(!early || cancelled || ended);
            if (kFastBuild) QVERIFY2(took.count() < 0.5, qPrintable(QString::number(took.count())));
        }
    }
};

QTEST_GUILESS_MAIN(AboveTest)
#include "AboveTest.moc"
