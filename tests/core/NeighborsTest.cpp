// SPDX-License-Identifier: MIT
// The order of points and the search in it against brute force over all pairs, on clouds that are hard on tiles.
#include "core/neighbors/LeafScan.h"
#include "core/neighbors/Neighbors.h"

#include "core/measure/Spacing.h"
#include "core/task/Progress.h"
#include "tests/core/TroubleClouds.h"

#include <QTest>

#include <atomic>
#include <cmath>
#include <map>
#include <mutex>

using namespace punctum;

namespace
{

bool near(double a, double b)
{
    return std::abs(a - b) <= 1e-5 * std::max(std::abs(a), std::abs(b)) + 1e-12;
}

}  // namespace

class NeighborsTest : public QObject
{
    Q_OBJECT

private slots:
    void orderHoldsEveryPointOnce_data() { trouble(); }
    void orderHoldsEveryPointOnce();
    void nearestAreExact_data() { trouble(); }
    void nearestAreExact();
    void withinIsExact_data() { trouble(); }
    void withinIsExact();
    void orderOfSomePoints();
    void neighborsAreExact_data() { trouble(); }
    void neighborsAreExact();
    void scansAreTheSame();
    void orderIsSmallAndKept();
    void smallCloudsWork();
    void spacingIsThatOfTheSurface();

private:
    static void trouble()
    {
        QTest::addColumn<QString>("kind");
        QTest::newRow("grid") << QString("grid");
        for (const char* kind : kTrouble) QTest::newRow(kind) << QString(kind);
    }
};

void NeighborsTest::orderHoldsEveryPointOnce()
{
    QFETCH(QString, kind);
    const auto cloud = makeTrouble(kind.toStdString(), 100'000);
    Progress progress;
    const KdOrder order(*cloud, progress);
    for (const std::size_t most : {1, 1000, 32768, 1000000}) {
        std::vector<int> seen(cloud->size());
        for (const std::size_t node : order.tiles(most)) {
            QVERIFY(order.points(node).size() <= most || order.isLeaf(node));
            for (const std::uint32_t p : order.points(node)) {
                ++seen[p];
                for (std::size_t a = 0; a < 3; ++a)
                    QVERIFY(order.raw(p)[a] >= order.box(node).min[a] && order.raw(p)[a] <= order.box(node).max[a]);
            }
        }
        QVERIFY(std::all_of(seen.begin(), seen.end(), [](int n) { return n == 1; }));
    }
    if (kind == "plane" || kind == "scanner" || kind == "volume")
        for (const std::size_t node : order.tiles(1000)) QVERIFY(order.points(node).size() > 100);  // balanced
}

void NeighborsTest::nearestAreExact()
{
    QFETCH(QString, kind);
    const auto cloud = makeTrouble(kind.toStdString(), kFastBuild ? 80'000 : 40'000);  // more than one tile
    Progress progress;
    const KdOrder order(*cloud, progress);
    for (const std::size_t k : {1, 16}) {
        std::vector<std::atomic<int>> visits(cloud->size());
        std::mutex mutex;
        std::map<std::uint32_t, std::vector<float>> some;
        std::atomic<bool> consistent{true};
        forEachNearest(order, k, "test", progress, [&](const Neighborhood& n) {
            ++visits[n.point];
            bool good = n.offsets.size() == k && n.squared.size() == k && n.squared[0] == 0.0f;
            for (std::size_t j = 0; j < k && good; ++j) {
                const auto& o = n.offsets[j];
                good = n.points.size() == k &&
                       near(n.squared[j], double(o[0]) * o[0] + double(o[1]) * o[1] + double(o[2]) * o[2]) &&
                       (j == 0 || n.squared[j] >= n.squared[j - 1]);
            }
            if (!good) consistent = false;
            if (n.point % 799 == 0) {
                const std::lock_guard lock(mutex);
                some[n.point].assign(n.squared.begin(), n.squared.end());
            }
        });
        QVERIFY(consistent);
        QVERIFY(std::all_of(visits.begin(), visits.end(), [](const auto& v) { return v == 1; }));
        for (const auto& [point, squared] : some) {
            const auto expected = allDistances(*cloud, point, k);
            // what floats in a tile can tell; a neighbor left out would be further off
            const double slack = 0.003 * std::sqrt(expected[k - 1]) + 1e-12;
            for (std::size_t j = 0; j < k; ++j)
                QVERIFY2(std::abs(std::sqrt(squared[j]) - std::sqrt(expected[j])) <= slack,
                         qPrintable(QString("%1 %2: %3 %4").arg(point).arg(j).arg(squared[j]).arg(expected[j])));
        }
    }
    QCOMPARE(progress.fraction(), 1.0);
}

void NeighborsTest::withinIsExact()
{
    QFETCH(QString, kind);
    const auto cloud = makeTrouble(kind.toStdString(), kFastBuild ? 20'000 : 5'000);
    Progress progress;
    const KdOrder order(*cloud, progress);
    // A radius that takes in some twenty points of an ordinary place.
    std::vector<KdOrder::Found> found;
    std::vector<double> reach;
    for (std::uint32_t p = 0; p < cloud->size(); p += std::uint32_t(cloud->size() / 40)) {
        order.nearest(p, 20, found);
        reach.push_back(std::sqrt(found.back().squared));
    }
    std::nth_element(reach.begin(), reach.begin() + 20, reach.end());
    const double radius = reach[20] * 1.0001 + 1e-9;
    std::vector<std::atomic<std::uint32_t>> counts(cloud->size());
    forEachWithin(order, radius, "test", progress, [&](const Neighborhood& n) {
        counts[n.point] += std::uint32_t(n.offsets.size());
        for (const float s : n.squared)
            if (double(s) > radius * radius * 1.00001) counts[n.point] = UINT32_MAX / 2;
    });
    for (PointIndex p = 0; p < cloud->size(); p += 401) {
        std::uint32_t expected = 0;
        for (PointIndex i = 0; i < cloud->size(); ++i) expected += distance2(*cloud, p, i) <= radius * radius;
        QCOMPARE(counts[p].load(), expected);
    }
}

void NeighborsTest::orderOfSomePoints()
{
    for (const char* kind : kTrouble) {
        const auto cloud = makeTrouble(kind, 20'000);
        PointSet some(cloud->size());
        for (PointIndex i = 3; i < cloud->size(); i += 1 + i % 7) some.insert(i);
        Progress progress;
        const KdOrder order(*cloud, progress, &some);
        QCOMPARE(order.size(), some.count());
        std::vector<KdOrder::Found> found;
        for (PointIndex i = 0; i < cloud->size(); i += 503) {
            // from a place beside a point, which need not be in the order
            KdOrder::Place place = KdOrder::place(order.raw(std::uint32_t(i)));
            place[0] += 1234.5;
            std::vector<KdOrder::Found> expected;
            some.forEach([&](PointIndex p) {
                const KdOrder::Raw r = order.raw(std::uint32_t(p));
                double sum = 0;
                for (std::size_t a = 0; a < 3; ++a) {
                    const double d = (place[a] - double(r[a])) * order.scale()[a];
                    sum += d * d;
                }
                expected.push_back({sum, std::uint32_t(p)});
            });
            std::sort(expected.begin(), expected.end());
            order.nearest(place, 9, found);
            QCOMPARE(found.size(), std::size_t(9));
            for (std::size_t j = 0; j < found.size(); ++j) {
                QCOMPARE(found[j].squared, expected[j].squared);
                QCOMPARE(found[j].point, expected[j].point);
            }
        }
        const PointSet none(cloud->size());
        const KdOrder empty(*cloud, progress, &none);
        empty.nearest(KdOrder::Place{}, 3, found);
        QVERIFY(empty.size() == 0 && found.empty());
    }
}

/// Whom the neighbors are, ties included; and how many there are.
void NeighborsTest::neighborsAreExact()
{
    QFETCH(QString, kind);
    const auto cloud = makeTrouble(kind.toStdString(), kFastBuild ? 20'000 : 5'000);
    Progress progress;
    const KdOrder order(*cloud, progress);
    PointSet some(cloud->size());
    for (PointIndex i = 0; i < cloud->size(); i += 199) some.insert(i);
    std::mutex mutex;
    std::map<std::uint32_t, std::vector<KdOrder::Found>> all;
    some.forEach([&](PointIndex i) {
        auto& found = all[std::uint32_t(i)];
        for (PointIndex p = 0; p < cloud->size(); ++p)
            found.push_back({order.squaredDistance(std::uint32_t(i), std::uint32_t(p)), std::uint32_t(p)});
        std::sort(found.begin(), found.end());
    });
    bool good = true;
    for (const std::size_t k : {1, 2, 8, 16, 31, 200}) {
        std::size_t visits = 0;
        forEachNearest(
            order, k, "test", progress,
            [&](const Neighborhood& n) {
                const std::lock_guard lock(mutex);
                ++visits;
                const auto& expected = all.at(n.point);
                good = good && n.points.size() == k;
                for (std::size_t j = 0; j < k && good; ++j) good = n.points[j] == expected[j].point;
            },
            &some);
        QVERIFY2(good, qPrintable(QString::number(k)));
        QCOMPARE(visits, std::size_t(some.count()));
    }
    // Radii that are the distance of a neighbor, exactly: it counts.
    for (const std::size_t rank : {3, 40}) {
        const double radius = std::sqrt(all.at(0)[rank].squared);
        if (radius == 0 && kind == "one place") continue;
        const auto count = [&](std::uint32_t point) {
            std::size_t n = 0;
            for (const auto& f : all.at(point)) n += f.squared <= radius * radius;
            return n;
        };
        forEachWithin(
            order, radius, "test", progress,
            [&](const Neighborhood& n) {
                const std::lock_guard lock(mutex);
                std::vector<std::uint32_t> points(n.points.begin(), n.points.end());
                std::sort(points.begin(), points.end());
                good = good && points.size() == count(n.point) &&
                       std::adjacent_find(points.begin(), points.end()) == points.end();
            },
            &some);
        QVERIFY2(good, qPrintable(QString::number(rank)));
        for (const std::size_t enough : {2, 5, 1000}) {
            forEachCount(
                order, radius, enough, "test", progress,
                [&](std::uint32_t point, std::size_t found) {
                    const std::lock_guard lock(mutex);
                    const std::size_t expected = count(point);
                    good = good && (found == expected || (found >= enough && expected >= enough));
                },
                &some);
            QVERIFY2(good, qPrintable(QString::number(enough)));
        }
    }
}

/// With and without AVX2, bit by bit.
void NeighborsTest::scansAreTheSame()
{
    const LeafFunctions plain = leafFunctionsBaseline(), fast = leafFunctions();
    std::mt19937_64 random(8);
    for (int round = 0; round < 200; ++round) {
        const std::size_t leaves = 1 + random() % 20;
        std::vector<std::int32_t> axes[3], boxes((leaves + 7) / 8 * 48);
        std::vector<std::uint32_t> firsts, counts;
        const auto value = [&] { return std::int32_t(random() % 2'000'000) - 1'000'000; };
        for (std::size_t leaf = 0; leaf < leaves; ++leaf) {
            firsts.push_back(std::uint32_t(axes[0].size()));
            counts.push_back(std::uint32_t(random() % 40));
            for (std::size_t a = 0; a < 3; ++a) {
                const std::int32_t middle = value();
                std::int32_t least = INT32_MAX, most = INT32_MIN;
                for (std::uint32_t k = 0; k < (counts.back() + 7) / 8 * 8; ++k) {
                    axes[a].push_back(middle + value() / 50);
                    if (k >= counts.back()) continue;
                    least = std::min(least, axes[a].back());
                    most = std::max(most, axes[a].back());
                }
                if (counts.back() == 0) least = most = middle;
                boxes[leaf / 8 * 48 + a * 8 + leaf % 8] = least;
                boxes[leaf / 8 * 48 + (a + 3) * 8 + leaf % 8] = most;
            }
        }
        LeafScan scan;
        scan.boxes = boxes.data();
        scan.firsts = firsts.data();
        scan.counts = counts.data();
        scan.leaves = leaves;
        scan.x = axes[0].data();
        scan.y = axes[1].data();
        scan.z = axes[2].data();
        scan.steps[1] = 0.7f;
        scan.steps[2] = 0.3f;
        for (std::int32_t& f : scan.from) f = value();
        const float limit = float(random() % 1000) * 1e9f;
        std::vector<float> squared[2];
        std::vector<std::uint32_t> places[2];
        std::size_t found[2], counted[2], looks[2];
        for (const std::size_t which : {0, 1}) {
            const LeafFunctions& f = which == 0 ? plain : fast;
            squared[which].resize(axes[0].size() + 16);
            places[which].resize(axes[0].size() + 16);
            counted[which] = f.count(scan, limit * 0.9f, limit, SIZE_MAX, places[which].data(), &looks[which]);
            found[which] = f.scan(scan, limit, squared[which].data(), places[which].data());
            squared[which].resize(found[which]);
            places[which].resize(found[which]);
        }
        QVERIFY(squared[0] == squared[1] && places[0] == places[1]);
        QVERIFY(counted[0] == counted[1] && looks[0] == looks[1] && counted[0] + looks[0] == found[0]);
        std::vector<std::uint32_t> ranks[2];
        for (const std::size_t which : {0, 1}) {
            ranks[which].resize(found[0] + 8);
            squared[which].resize(found[0] + 8, INFINITY);
            (which == 0 ? plain : fast).rank(squared[which].data(), found[0], ranks[which].data());
            ranks[which].resize(found[0]);
        }
        QVERIFY(ranks[0] == ranks[1]);
    }
}

void NeighborsTest::orderIsSmallAndKept()
{
    const auto cloud = makeTrouble("plane", 100'000);
    Progress progress;
    const auto order = KdOrder::of(*cloud, progress);
    QVERIFY(order->bytes() < 9 * cloud->size());  // at most: the number of leaves is a power of two
    cloud->columns()[3]->values<std::uint8_t>()[5] = 3;
    QVERIFY(KdOrder::of(*cloud, progress) == order);  // values do not matter
    KdOrder::drop(*cloud);
    QVERIFY(KdOrder::of(*cloud, progress) != order);
}

void NeighborsTest::smallCloudsWork()
{
    for (const PointIndex n : {1, 2, 3, 4, 16, 17, 200, 400}) {
        const auto cloud = makeTrouble("volume", n);
        Progress progress;
        const KdOrder order(*cloud, progress);
        std::atomic<PointIndex> visits{0};
        std::atomic<bool> complete{true};
        forEachNearest(order, 16, "test", progress, [&](const Neighborhood& v) {
            ++visits;
            if (v.offsets.size() != std::min<PointIndex>(n, 16)) complete = false;
        });
        QCOMPARE(visits.load(), n);
        QVERIFY(complete);
        const auto command = runStep(*cloud, "normals");
        command->apply(*cloud);
        for (PointIndex i = 0; i < n; ++i) {
            const double z = cloud->findAttribute("NormalZ")->number(i);
            QVERIFY(n < 3 ? z == 0.0 : z >= 0.0);
        }
    }
    QVERIFY(runStep(*makeFrame(0), "normals") == nullptr);
    QVERIFY(runStep(*makeFrame(0), "outliers") == nullptr);
}

void NeighborsTest::spacingIsThatOfTheSurface()
{
    // 10,000 points at random over a square of 100 by 100 units of length: one each, whatever the coordinates'
    // units
    std::mt19937_64 random(3);
    const auto cloud = makeFrame(10'000, {glm::dvec3(0.001), glm::dvec3(0.0)});
    for (PointIndex i = 0; i < 10'000; ++i)
        place(*cloud, i, double(random() % 100'000), double(random() % 50'000), 0);
    Progress progress;
    const double found = pointSpacing(*cloud, {1.0, 2.0, 1.0}, progress);
    QVERIFY2(found > 0.9 && found < 1.1, qPrintable(QString::number(found)));
    QCOMPARE(pointSpacing(*makeFrame(5), glm::dvec3(1.0), progress), 0.0);
    QCOMPARE(pointSpacing(*makeFrame(5000), glm::dvec3(1.0), progress), 0.0);  // all in one place
    QCOMPARE(roundLength(0.97), 1.0);
    QCOMPARE(roundLength(1.6), 2.0);
    QCOMPARE(roundLength(0.034), 0.05);
    QCOMPARE(roundLength(8000.0), 10'000.0);
}

QTEST_APPLESS_MAIN(NeighborsTest)
#include "NeighborsTest.moc"
