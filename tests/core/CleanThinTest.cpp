// SPDX-License-Identifier: MIT
// Steps that clean and thin, against brute force and known answers, on clouds that are hard on grids.
#include "core/Error.h"
#include "core/cells/CellOrder.h"
#include "core/edit/History.h"
#include "core/las/Reader.h"
#include "core/sample/Sample.h"
#include "core/steps/Steps.h"
#include "core/task/Progress.h"
#include "tests/core/CancelAfter.h"
#include "tests/core/MadeCloud.h"

#include <QTest>

#include <tbb/global_control.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <numeric>

using namespace punctum;

namespace
{

using Cloud = std::shared_ptr<PointCloud>;
using World = std::array<std::int64_t, 3>;

/// Clouds in steps of a millimeter; each is trouble for grids in its way.
Cloud makeHard(const std::string& kind, PointIndex n)
{
    std::mt19937_64 random(5);
    const auto unit = [&] { return double(random() >> 11) * 0x1p-53; };
    const auto cloud = makeFrame(n, {glm::dvec3(0.001), glm::dvec3(457000.0, 5552000.0, -10.0)});
    const auto put = [&](PointIndex i, double x, double y, double z) {
        rawAxis(*cloud, 0)[i] = std::int32_t(x);
        rawAxis(*cloud, 1)[i] = std::int32_t(y);
        rawAxis(*cloud, 2)[i] = std::int32_t(z);
    };
    for (PointIndex i = 0; i < n; ++i) {
        if (kind == "surface")
            put(i, unit() * 3e4 - 1.5e4, unit() * 3e4, 3000 * std::sin(unit()));
        else if (kind == "volume")
            put(i, unit() * 8e3, unit() * 8e3, unit() * 8e3 - 4e3);
        else if (kind == "strays")  // a dense patch, and few points at the ends of what integers hold
            put(i, i % 501 == 7 ? (unit() - 0.5) * 4e9 : unit() * 1e4,
                i % 501 == 7 ? (unit() - 0.5) * 4e9 : unit() * 1e4, 100 * unit());
        else if (kind == "raster")  // exactly on faces of cells, many in one place
            put(i, std::floor(unit() * 40) * 500, std::floor(unit() * 40) * 500, std::floor(unit() * 2) * 500);
        else if (kind == "one place")
            put(i, 5, 5, 5);
        else if (kind == "line")
            put(i, double(i) * 100, 7, 7);
    }
    return cloud;
}

const char* const kHard[] = {"surface", "volume", "strays", "raster", "one place", "line"};

std::unique_ptr<Command> run(const PointCloud& cloud, const std::string& text, const PointSet* within = nullptr)
{
    const ParsedStep parsed = parseStep(text);
    Progress progress;
    return parsed.step->run(cloud, parsed.values, progress, within);
}

/// What a step that deletes leaves: all that it does not change.
PointSet keptBy(const PointCloud& cloud, const std::string& text)
{
    const auto command = run(cloud, text);
    PointSet kept = command ? *command->points() : PointSet(cloud.size());
    kept.invert();
    return kept;
}

PointSet changedBy(const PointCloud& cloud, const std::string& text)
{
    const auto command = run(cloud, text);
    return command ? *command->points() : PointSet(cloud.size());
}

std::vector<PointIndex> members(const PointSet& set)
{
    std::vector<PointIndex> all;
    set.forEach([&](PointIndex i) { all.push_back(i); });
    return all;
}

double distance2(const PointCloud& cloud, PointIndex a, PointIndex b)
{
    double sum = 0;
    const std::span<const std::int32_t> raw[3] = {cloud.rawX(), cloud.rawY(), cloud.rawZ()};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double d = double(std::int64_t(raw[axis][a]) - raw[axis][b]) * cloud.coordinates().scale[int(axis)];
        sum += d * d;
    }
    return sum;
}

/// The cell of a point in whole steps of a millimeter: exact.
World cellOf(const PointCloud& cloud, PointIndex i, std::int64_t steps)
{
    const auto down = [steps](std::int64_t v) { return (v >= 0 ? v : v - steps + 1) / steps; };
    return {down(457000000 + std::int64_t(cloud.rawX()[i])), down(5552000000 + std::int64_t(cloud.rawY()[i])),
            down(-10000 + std::int64_t(cloud.rawZ()[i]))};
}

std::map<World, std::vector<PointIndex>> cellsOf(const PointCloud& cloud, std::int64_t steps)
{
    std::map<World, std::vector<PointIndex>> cells;
    for (PointIndex i = 0; i < cloud.size(); ++i) cells[cellOf(cloud, i, steps)].push_back(i);
    return cells;
}

/// The places of the points of a set, in order.
std::vector<std::array<double, 3>> places(const PointCloud& cloud, const PointSet& set)
{
    std::vector<std::array<double, 3>> all;
    set.forEach([&](PointIndex i) { all.push_back({cloud.world(i).x, cloud.world(i).y, cloud.world(i).z}); });
    std::sort(all.begin(), all.end());
    return all;
}

/// The same points in another order, with other offsets.
Cloud shuffled(const PointCloud& cloud)
{
    std::vector<PointIndex> order(cloud.size());
    std::iota(order.begin(), order.end(), PointIndex(0));
    std::shuffle(order.begin(), order.end(), std::mt19937_64(9));
    CoordinateScale other = cloud.coordinates();
    other.offset += glm::dvec3(100.0, -3.5, 7.25);
    const auto copy = makeFrame(cloud.size(), other);
    const std::int32_t moved[3] = {100'000, -3'500, 7'250};
    const std::span<const std::int32_t> raw[3] = {cloud.rawX(), cloud.rawY(), cloud.rawZ()};
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (PointIndex i = 0; i < cloud.size(); ++i) rawAxis(*copy, axis)[i] = raw[axis][order[i]] - moved[axis];
    return copy;
}

const char* const kSteps[] = {"isolated step=0.7 isolated=2",
                              "low step=1 depth=0.3 high=yes height=1",
                              "strays",
                              "duplicates",
                              "thin method=grid cell=0.5",
                              "thin method=grid cell=0.5 keep=lowest",
                              "thin method=distance radius=0.5",
                              "thin method=number count=100",
                              "thin-to count=100 method=normal-deviation",
                              "thin-to count=100 method=entropy",
                              "thin-to count=100 method=k-clustering"};

}  // namespace

class CleanThinTest : public QObject
{
    Q_OBJECT

private slots:
    void gridKeepsOnePointOfEachCell_data() { hard(); }
    void gridKeepsOnePointOfEachCell();
    void gridKeepsTheRightPoint();
    void distanceIsExact_data() { hard(); }
    void distanceIsExact();
    void numberIsExact_data() { hard(); }
    void numberIsExact();
    void numberIsEven();
    void orderAndOffsetsDoNotMatter();
    void whatIsNotKeptIsMarked();
    void someAreThinnedByThemselves();
    void isolatedAreThoseOfAPlainLoop_data() { hard(); }
    void isolatedAreThoseOfAPlainLoop();
    void lowAndHighPointsAreFound();
    void footOfAWallIsNotLow();
    void duplicatesAreThoseOfASort();
    void straysOfARealFile();
    void straysAreThoseOfTheView();
    void noiseIsLeftAlone();
    void fewPointsAreFine_data() { steps(); }
    void fewPointsAreFine();
    void deletedPointsAreNone_data() { steps(); }
    void deletedPointsAreNone();
    void threadsDoNotMatter_data() { steps(); }
    void threadsDoNotMatter();
    void cancelIsAnsweredSoon_data() { steps(); }
    void cancelIsAnsweredSoon();
    void undoBringsAllBack_data() { steps(); }
    void undoBringsAllBack();
    void badValuesAreRefused();

private:
    static void hard()
    {
        QTest::addColumn<QString>("kind");
        for (const char* kind : kHard) QTest::newRow(kind) << QString(kind);
    }
    static void steps()
    {
        QTest::addColumn<QString>("step");
        for (const char* step : kSteps) QTest::newRow(step) << QString(step);
    }
};

void CleanThinTest::gridKeepsOnePointOfEachCell()
{
    QFETCH(QString, kind);
    const auto cloud = makeHard(kind.toStdString(), 20'000);
    for (const char* keep : {"middle", "lowest", "highest", "random", "first"}) {
        const PointSet kept = keptBy(*cloud, std::string("thin method=grid cell=0.5 keep=") + keep);
        for (const auto& [cell, points] : cellsOf(*cloud, 500)) {
            const auto of = std::count_if(points.begin(), points.end(), [&](auto i) { return kept.contains(i); });
            QCOMPARE(of, std::ptrdiff_t(1));
        }
    }
}

void CleanThinTest::gridKeepsTheRightPoint()
{
    const auto cloud = makeHard("surface", 20'000);
    const auto z = cloud->rawZ();
    const PointSet lowest = keptBy(*cloud, "thin cell=2 keep=lowest"),
                   highest = keptBy(*cloud, "thin cell=2 keep=highest");
    const PointSet first = keptBy(*cloud, "thin cell=2 keep=first"),
                   middle = keptBy(*cloud, "thin cell=2 keep=middle");
    const auto cells = cellsOf(*cloud, 2000);
    QVERIFY(cells.size() < 1000);
    for (const auto& [cell, members] : cells) {
        const World at = cell;
        const auto& points = members;  // what lambdas may capture
        const auto fromMiddle = [&](PointIndex i) {
            glm::dvec3 d = cloud->world(i);
            for (int axis = 0; axis < 3; ++axis) d[axis] -= (double(at[std::size_t(axis)]) + 0.5) * 2.0;
            return d.x * d.x + d.y * d.y + d.z * d.z;
        };
        PointIndex low = points[0], high = points[0], near = points[0], keptNear = points[0];
        for (const PointIndex i : points) {
            if (z[i] < z[low]) low = i;
            if (z[i] > z[high]) high = i;
            if (fromMiddle(i) < fromMiddle(near)) near = i;
            if (middle.contains(i)) keptNear = i;
        }
        const auto keptOf = [&](const PointSet& set) {
            return *std::find_if(points.begin(), points.end(), [&](auto i) { return set.contains(i); });
        };
        QCOMPARE(z[keptOf(lowest)], z[low]);
        QCOMPARE(z[keptOf(highest)], z[high]);
        QCOMPARE(keptOf(first), points[0]);
        QVERIFY(fromMiddle(keptNear) <= fromMiddle(near) * (1 + 1e-6));
    }
}

void CleanThinTest::distanceIsExact()
{
    QFETCH(QString, kind);
    const auto cloud = makeHard(kind.toStdString(), 6'000);
    // 0.5 m is the distance of the neighbors in a raster, exactly: those are kept.
    for (const double radius : {0.5, 0.001, 3.0}) {
        const PointSet kept = keptBy(*cloud, "thin method=distance radius=" + std::to_string(radius));
        const std::vector<PointIndex> darts = members(kept);
        for (PointIndex i = 0; i < cloud->size(); ++i) {
            double nearest = INFINITY;
            for (const PointIndex d : darts)
                if (d != i) nearest = std::min(nearest, distance2(*cloud, i, d));
            if (kept.contains(i))
                QVERIFY2(nearest >= radius * radius, qPrintable(QString::number(std::sqrt(nearest))));
            else
                QVERIFY2(nearest < radius * radius, qPrintable(QString::number(std::sqrt(nearest))));
        }
    }
}

void CleanThinTest::numberIsExact()
{
    QFETCH(QString, kind);
    const auto cloud = makeHard(kind.toStdString(), 6'000);
    for (const char* method : {"thin method=number", "thin-to method=normal-deviation", "thin-to method=entropy",
                               "thin-to method=k-clustering"})
        for (const PointIndex count : {0, 1, 17, 2999, 6000, 7000}) {
            const PointSet kept = keptBy(*cloud, std::string(method) + " count=" + std::to_string(count));
            QVERIFY2(kept.count() == std::min<PointIndex>(count, 6000),
                     qPrintable(QString("%1 %2: %3").arg(method).arg(count).arg(kept.count())));
        }
    QCOMPARE(keptBy(*cloud, "thin method=number percent=12.5").count(), PointIndex(750));
}

// Counts in squares of the area differ less than those of a purely random choice do.
void CleanThinTest::numberIsEven()
{
    const auto cloud = makeHard("surface", 100'000);
    const PointSet kept = keptBy(*cloud, "thin method=number count=10000");
    std::map<World, double> squares, all;
    for (PointIndex i = 0; i < cloud->size(); ++i) {
        World cell = cellOf(*cloud, i, 3000);
        cell[2] = 0;
        all[cell] += 0.1;
        if (kept.contains(i)) squares[cell] += 1;
    }
    double sum = 0, expected = 0;
    for (const auto& [cell, count] : all) {
        sum += (squares[cell] - count) * (squares[cell] - count);
        expected += count * 0.9;
    }
    QVERIFY2(sum < expected / 2, qPrintable(QString("%1 of %2").arg(sum).arg(expected)));
}

void CleanThinTest::orderAndOffsetsDoNotMatter()
{
    for (const char* kind : {"surface", "volume", "raster"}) {
        const auto cloud = makeHard(kind, 20'000);
        const auto other = shuffled(*cloud);
        for (const char* step : {"thin method=grid cell=0.5", "thin method=grid cell=0.7 keep=random",
                                 "thin method=grid cell=0.7 keep=lowest", "thin method=distance radius=0.5"})
            QVERIFY2(places(*cloud, keptBy(*cloud, step)) == places(*other, keptBy(*other, step)), step);
        for (const char* step : {"isolated step=0.7 isolated=8", "low step=1 depth=0.02"})
            QVERIFY2(places(*cloud, changedBy(*cloud, step)) == places(*other, changedBy(*other, step)), step);
    }
}

void CleanThinTest::whatIsNotKeptIsMarked()
{
    const auto cloud = makeFrame(100, {}, true);
    for (PointIndex i = 0; i < 100; ++i) rawAxis(*cloud, 0)[i] = std::int32_t(i * 10);
    const PointSet gone = changedBy(*cloud, "thin cell=0.1 keep=first");
    QCOMPARE(gone.count(), PointIndex(90));
    for (const char* how : {"class class=8", "class class=65", "withheld"}) {
        const auto copy = makeFrame(100, {}, true);
        for (PointIndex i = 0; i < 100; ++i) rawAxis(*copy, 0)[i] = std::int32_t(i * 10);
        const auto command = run(*copy, std::string("thin cell=0.1 keep=first do=") + how);
        QVERIFY(*command->points() == gone);
        command->apply(*copy);
        const bool flag = std::string(how) == "withheld";
        const Attribute& field = *copy->findAttribute(flag ? "Withheld" : "Classification");
        for (PointIndex i = 0; i < 100; ++i)
            QCOMPARE(field.number(i), gone.contains(i) ? (flag                               ? 1.0
                                                          : std::string(how).ends_with("65") ? 65.0
                                                                                             : 8.0)
                                                       : 0.0);
        QVERIFY(run(*copy, std::string("thin cell=0.1 keep=first do=") + how) == nullptr);
    }
    const auto command = run(*cloud, "thin cell=0.1 keep=first do=attribute");
    QCOMPARE(QString::fromStdString(command->finding()), QString("Kept 10 of 100 points."));
    command->apply(*cloud);
    const Attribute& kept = *cloud->findAttribute("Kept");
    QCOMPARE(kept.type(), ScalarType::U8);
    for (PointIndex i = 0; i < 100; ++i) QCOMPARE(kept.number(i), gone.contains(i) ? 0.0 : 1.0);
}

void CleanThinTest::someAreThinnedByThemselves()
{
    const auto cloud = makeHard("surface", 10'000);
    PointSet within(cloud->size());
    for (PointIndex i = 0; i < cloud->size(); i += 3) within.insert(i);
    for (const char* step :
         {"thin cell=1", "thin method=distance radius=1", "thin method=number count=50", "thin-to count=50",
          "thin-to method=entropy count=50", "thin-to method=k-clustering count=50"}) {
        const auto command = run(*cloud, step, &within);
        PointSet others = *command->points();
        others.remove(within);
        QCOMPARE(others.count(), PointIndex(0));
        if (std::string(step).find("count") != std::string::npos)
            QCOMPARE(command->changedPoints(), within.count() - 50);
    }
}

void CleanThinTest::isolatedAreThoseOfAPlainLoop()
{
    QFETCH(QString, kind);
    const auto cloud = makeHard(kind.toStdString(), 5'000);
    for (const std::int64_t most : {0, 3, 8}) {
        const PointSet found = changedBy(*cloud, "isolated step=0.7 isolated=" + std::to_string(most));
        const auto cells = cellsOf(*cloud, 700);
        for (const auto& [cell, points] : cells) {
            std::int64_t others = -1;
            for (std::int64_t k = 0; k < 27; ++k) {
                const auto there = cells.find({cell[0] + k % 3 - 1, cell[1] + k / 3 % 3 - 1, cell[2] + k / 9 - 1});
                if (there != cells.end()) others += std::int64_t(there->second.size());
            }
            for (const PointIndex i : points) QCOMPARE(found.contains(i), others <= most);
        }
    }
}

void CleanThinTest::lowAndHighPointsAreFound()
{
    for (const bool narrow : {false, true}) {
        // A slope of 100 m by 100 m, a point each half meter; three below it together, one above, one just below.
        const PointIndex n = 40'000;
        const auto cloud = makeFrame(n + 5, {}, narrow);
        for (PointIndex i = 0; i < n; ++i) {
            rawAxis(*cloud, 0)[i] = std::int32_t(i % 200 * 500);
            rawAxis(*cloud, 1)[i] = std::int32_t(i / 200 * 500);
            rawAxis(*cloud, 2)[i] = std::int32_t(i % 200 * 20 + (i * 7919) % 100);
        }
        const std::int32_t extra[5][3] = {{50'000, 50'000, -1000},
                                          {50'100, 50'050, -990},
                                          {49'900, 50'000, -100},
                                          {30'000, 30'000, 90'000},
                                          {20'000, 20'100, 300}};
        for (PointIndex k = 0; k < 5; ++k)
            for (std::size_t axis = 0; axis < 3; ++axis) rawAxis(*cloud, axis)[n + k] = extra[k][axis];
        const auto command = run(*cloud, "low step=2 depth=1 high=yes height=10");
        QCOMPARE(command->changedPoints(), PointIndex(4));
        QCOMPARE(QString::fromStdString(command->finding()), QString("Found 3 low and 1 high points."));
        command->apply(*cloud);
        const Attribute& classes = *cloud->findAttribute("Classification");
        const double expected[5] = {7, 7, 7, narrow ? 7.0 : 18.0, 0};
        for (PointIndex k = 0; k < 5; ++k) QCOMPARE(classes.number(n + k), expected[k]);
        QVERIFY(run(*cloud, "low step=2 depth=1 high=yes height=10") == nullptr);
    }
}

void CleanThinTest::footOfAWallIsNotLow()
{
    // A plateau of 10 m beside a plain, and a pit of 3 by 3 m with 36 points.
    const PointIndex n = 40'000;
    const auto cloud = makeFrame(n);
    for (PointIndex i = 0; i < n; ++i) {
        const auto x = std::int32_t(i % 200), y = std::int32_t(i / 200);
        const bool pit = x >= 150 && x < 156 && y >= 50 && y < 56;
        rawAxis(*cloud, 0)[i] = x * 500;
        rawAxis(*cloud, 1)[i] = y * 500;
        rawAxis(*cloud, 2)[i] = x < 100 || pit ? 0 : 10'000;
    }
    QVERIFY(run(*cloud, "low step=2 depth=1 count=5 high=yes height=5") == nullptr);
    QVERIFY(run(*cloud, "low") == nullptr);
}

void CleanThinTest::duplicatesAreThoseOfASort()
{
    for (const char* kind : {"raster", "one place", "surface", "strays"}) {
        const auto cloud = makeHard(kind, 20'000);
        const auto time = addScalar<double>(*cloud, "GpsTime");
        addScalar<std::uint8_t>(*cloud, "Returns");
        addBits(*cloud, "ReturnNumber", "Returns", 0, 3);
        addBits(*cloud, "NumberOfReturns", "Returns", 3, 3);
        const auto returns = cloud->findAttribute("ReturnNumber")->columns[0]->values<std::uint8_t>();
        const auto classes = cloud->findAttribute("Classification")->columns[0]->values<std::uint8_t>();
        std::mt19937 random(4);
        for (PointIndex i = 0; i < cloud->size(); ++i) {
            time[i] = double(random() % 4);
            returns[i] =
                std::uint8_t(random() % 2 << 6 | random() % 2);  // the highest bits are no part of a return
            classes[i] = std::uint8_t(random() % 2);
        }
        for (const std::string same : {"place", "time", "return", "all"}) {
            std::map<std::vector<double>, PointIndex> seen;
            PointSet expected(cloud->size());
            for (PointIndex i = 0; i < cloud->size(); ++i) {
                std::vector<double> key{double(cloud->rawX()[i]), double(cloud->rawY()[i]),
                                        double(cloud->rawZ()[i])};
                if (same != "place") key.push_back(time[i]);
                if (same == "return") key.push_back(double(returns[i] & 0x3F));
                if (same == "all") key.insert(key.end(), {double(returns[i]), double(classes[i])});
                if (!seen.emplace(key, i).second) expected.insert(i);
            }
            QVERIFY2(changedBy(*cloud, "duplicates same=" + same) == expected, kind);
        }
    }
    const auto cloud = makeFrame(3);
    QVERIFY_THROWS_EXCEPTION(Error, run(*cloud, "duplicates same=time"));
}

void CleanThinTest::straysOfARealFile()
{
    const auto path = std::filesystem::path(PUNCTUM_TEST_DATA) / "cases" / "far-point.las";
    if (!std::filesystem::exists(path)) QSKIP("far-point.las is not there");
    Progress progress;
    const auto cloud = las::load(path, progress);
    const auto command = run(*cloud, "strays");
    QVERIFY(command != nullptr);
    QVERIFY2(command->changedPoints() >= 1 && command->changedPoints() < 10,
             qPrintable(QString::number(command->changedPoints())));
    command->apply(*cloud);
    QVERIFY(run(*cloud, "strays") == nullptr);
}

void CleanThinTest::straysAreThoseOfTheView()
{
    const auto cloud = makeHard("surface", 10'000);
    for (PointIndex i = 0; i < 3; ++i) rawAxis(*cloud, i)[i * 37] = 1'900'000'000;
    const PointSet found = changedBy(*cloud, "strays do=class class=7");
    QVERIFY((members(found) == std::vector<PointIndex>{0, 37, 74}));
}

void CleanThinTest::noiseIsLeftAlone()
{
    const auto cloud = makeFrame(1001);
    const auto classes = cloud->findAttribute("Classification")->columns[0]->values<std::uint8_t>();
    for (PointIndex i = 0; i < 1001; ++i) {
        rawAxis(*cloud, 0)[i] = std::int32_t(i % 32 * 100);
        rawAxis(*cloud, 1)[i] = std::int32_t(i / 32 * 100);
    }
    rawAxis(*cloud, 2)[500] = -5000;
    classes[500] = 7;
    // It is noise already: nothing new is found, and no cell keeps it as its lowest point.
    for (const char* step : {"low step=1 depth=1", "isolated step=0.5", "low step=1 depth=1 class=18"})
        QVERIFY2(run(*cloud, step) == nullptr, step);
    QVERIFY(keptBy(*cloud, "thin cell=20 keep=lowest").count() == 2);  // the one below is in a cell of its own
    rawAxis(*cloud, 2)[500] = 1;
    for (PointIndex i = 0; i < 1001; ++i) rawAxis(*cloud, 2)[i] += i == 500 ? 0 : 5;
    QVERIFY(!keptBy(*cloud, "thin cell=20 keep=lowest").contains(500));
}

void CleanThinTest::fewPointsAreFine()
{
    QFETCH(QString, step);
    for (const char* kind : kHard)
        for (const PointIndex n : {0, 1, 2, 3, 10}) run(*makeHard(kind, n), step.toStdString());
    // The whole range of integers.
    const auto cloud = makeFrame(200);
    std::mt19937 random(3);
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (std::int32_t& v : rawAxis(*cloud, axis)) v = random() % 2 != 0 ? INT32_MAX : INT32_MIN;
    run(*cloud, step.toStdString());
}

void CleanThinTest::deletedPointsAreNone()
{
    QFETCH(QString, step);
    const PointIndex n = 5'000;
    const auto whole = makeHard("raster", n);
    std::vector<PointIndex> left;
    auto gone = std::make_shared<PointSet>(n);
    for (PointIndex i = 0; i < n; ++i)
        if (i % 5 == 2)
            gone->insert(i);
        else
            left.push_back(i);
    const auto part = makeFrame(left.size(), whole->coordinates());
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (PointIndex k = 0; k < left.size(); ++k) rawAxis(*part, axis)[k] = rawAxis(*whole, axis)[left[k]];
    whole->setDeleted(gone);
    const PointSet here = changedBy(*whole, step.toStdString()), there = changedBy(*part, step.toStdString());
    PointSet both = here;
    both.intersect(*gone);
    QCOMPARE(both.count(), PointIndex(0));
    QCOMPARE(here.count(), there.count());
}

void CleanThinTest::threadsDoNotMatter()
{
    QFETCH(QString, step);
    Progress progress;
    const auto cloud = makeSample(60'000, 3, progress);
    PointSet results[2];
    for (const std::size_t threads : {1u, 4u}) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        results[threads / 4] = changedBy(*cloud, step.toStdString());
    }
    QVERIFY(results[0] == results[1]);
}

void CleanThinTest::cancelIsAnsweredSoon()
{
    QFETCH(QString, step);
    static const auto cloud = [] {
        Progress making;
        return makeSample(400'000, 1, making);
    }();
    for (const int wait : {0, 30, 120}) {
        const ParsedStep parsed = parseStep(step.toStdString());
        const auto [cancelled, ms] =
            cancelAfter(wait, [&](Progress& progress) { parsed.step->run(*cloud, parsed.values, progress); });
        if (!cancelled) continue;  // it was done before
        const double late = ms / 1000;
        // 100 ms are promised; ten times as much on a machine with other work.
        QVERIFY2(late < 1.0, qPrintable(QString::number(late)));
    }
}

void CleanThinTest::undoBringsAllBack()
{
    QFETCH(QString, step);
    const auto cloud = makeHard("strays", 20'000);
    // No deleted points are as good as an empty set of them.
    const auto state = [&] {
        if (cloud->deleted() && cloud->deleted()->count() == 0) cloud->setDeleted(nullptr);
        return snapshot(*cloud);
    };
    const auto before = state();
    History history(cloud);
    auto command = run(*cloud, step.toStdString());
    if (!command) return;
    history.push(std::move(command));
    const auto after = state();
    QVERIFY(after != before);
    history.undo();
    QVERIFY(state() == before);
    history.redo();
    QVERIFY(state() == after);
}

void CleanThinTest::badValuesAreRefused()
{
    const auto cloud = makeHard("surface", 100);
    for (const char* step : {"thin cell=0", "thin cell=-1", "thin keep=best", "thin method=number count=-3",
                             "thin percent=101", "thin cell=1 do=class", "isolated step=nan", "low count=0",
                             "strays do=attribute", "duplicates same=name", "thin-to method=x"})
        QVERIFY_THROWS_EXCEPTION(Error, run(*cloud, step));
    QVERIFY_THROWS_EXCEPTION(Error, run(*cloud, "thin cell=1 do=withheld"));  // there are no flags
}

QTEST_APPLESS_MAIN(CleanThinTest)
#include "CleanThinTest.moc"
