// SPDX-License-Identifier: MIT
// Selecting: shapes against tests of single px, regions and neighbors against plain loops over all points.
#include "core/edit/Command.h"
#include "core/neighbors/KdOrder.h"
#include "core/select/Selecting.h"
#include "core/task/Progress.h"
#include "tests/core/MadeCloud.h"

#include <QTest>

#include <glm/geometric.hpp>

#include <chrono>
#include <cmath>
#include <set>

using namespace punctum;

namespace
{

/// Whether a place lies inside an outline that may cross itself: rays crossed, even or odd.
bool inside(const std::vector<glm::dvec2>& corners, glm::dvec2 p)
{
    bool in = false;
    for (std::size_t k = 0, j = corners.size() - 1; k < corners.size(); j = k++) {
        const glm::dvec2 a = corners[k], b = corners[j];
        if ((a.y > p.y) != (b.y > p.y) && p.x < (b.x - a.x) * (p.y - a.y) / (b.y - a.y) + a.x) in = !in;
    }
    return in;
}

double distanceToLine(glm::dvec2 p, glm::dvec2 a, glm::dvec2 b)
{
    const glm::dvec2 way = b - a;
    const double t = glm::dot(way, way) > 0 ? std::clamp(glm::dot(p - a, way) / glm::dot(way, way), 0.0, 1.0) : 0.0;
    return glm::length(p - a - way * t);
}

/// Points spread over a box of 200 x 100 x 50 steps, with classes 0 to 31.
std::shared_ptr<PointCloud> makeCloud(PointIndex points, std::uint64_t seed = 1)
{
    const auto cloud = makeFrame(points, {glm::dvec3(0.01), glm::dvec3(1000.0, 2000.0, 30.0)}, true);
    std::mt19937_64 random(seed);
    const int sizes[3] = {200, 100, 50};
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (std::int32_t& v : rawAxis(*cloud, axis)) v = std::int32_t(random() % unsigned(sizes[axis])) - 20;
    for (const auto& column : cloud->columns())
        if (column->name() == "ClassFlags")
            for (std::uint8_t& byte : column->values<std::uint8_t>()) byte = std::uint8_t(random());
    return cloud;
}

/// Some oblique view in perspective.
PictureProjection someView()
{
    PictureProjection p;
    p.base = {10.0, -5.0, 3.0};
    p.rowX = {1.3, 0.2, -0.1, 9000.0};
    p.rowY = {-0.1, 0.9, 0.7, 7000.0};
    p.rowD = {0.001, 0.02, -0.03, 30.0};
    p.nearDepth = 28.0;
    return p;
}

}  // namespace

class SelectTest : public QObject
{
    Q_OBJECT
private slots:
    void polygonsMarkPxWhoseMiddlesAreInside()
    {
        std::mt19937_64 random(4);
        for (int round = 0; round < 200; ++round) {
            std::vector<glm::dvec2> corners;
            for (std::size_t n = 3 + random() % 9; n > 0; --n)
                corners.push_back({double(random() % 1600) / 10 - 30.013, double(random() % 1200) / 10 - 30.007});
            ScreenMask mask(100, 60);
            mask.addPolygon(corners);
            for (int y = 0; y < 60; ++y)
                for (int x = 0; x < 100; ++x)
                    if (mask.contains(x, y) != inside(corners, {x + 0.5, y + 0.5}))
                        QFAIL(qPrintable(QStringLiteral("round %1, px %2 %3").arg(round).arg(x).arg(y)));
        }
        ScreenMask none(10, 10);
        none.addPolygon(std::vector<glm::dvec2>{{1, 1}, {9, 9}});
        QVERIFY(none.box().empty());
    }

    void strokesRectanglesAndSidesLikewise()
    {
        std::mt19937_64 random(6);
        const auto place = [&] {
            return glm::dvec2(double(random() % 1600) / 10 - 30.013, double(random() % 1200) / 10 - 30.007);
        };
        for (int round = 0; round < 200; ++round) {
            const glm::dvec2 a = place(), b = round % 10 == 0 ? a : place();
            const double radius = double(random() % 300) / 10;
            ScreenMask stroke(100, 60), rectangle(100, 60), above(100, 60), below(100, 60);
            stroke.addStroke(a, b, radius);
            rectangle.addRectangle(a, b);
            above.addSideOf(a, b, true);
            below.addSideOf(a, b, false);
            for (int y = 0; y < 60; ++y)
                for (int x = 0; x < 100; ++x) {
                    const glm::dvec2 p(x + 0.5, y + 0.5);
                    if (std::abs(distanceToLine(p, a, b) - radius) > 1e-9)
                        QCOMPARE(stroke.contains(x, y), distanceToLine(p, a, b) <= radius);
                    QCOMPARE(rectangle.contains(x, y), p.x >= std::min(a.x, b.x) && p.x < std::max(a.x, b.x) &&
                                                           p.y >= std::min(a.y, b.y) && p.y < std::max(a.y, b.y));
                    const bool between = p.x >= std::min(a.x, b.x) && p.x < std::max(a.x, b.x);
                    const double line = a.y + (p.x - a.x) / (b.x - a.x) * (b.y - a.y);
                    if (between && std::abs(line - p.y) < 1e-9) continue;
                    QCOMPARE(above.contains(x, y), between && p.y < line);
                    QCOMPARE(below.contains(x, y), between && p.y > line);
                }
        }
    }

    void regionsHoldThePointsWhosePxIsMarked()
    {
        const auto cloud = makeCloud(100'003);
        Region region;
        region.projection = someView();
        region.mask = ScreenMask(640, 480);
        region.mask.addPolygon(std::vector<glm::dvec2>{{200, 100}, {520, 180}, {300, 260}, {450, 420}, {230, 330}});
        for (const bool slab : {false, true}) {
            if (slab) {
                region.nearest = 29.0;
                region.furthest = 30.5;
            }
            Touchable touchable;
            touchable.classes[2] = touchable.classes[7] = false;
            auto hidden = std::make_shared<PointSet>(cloud->size());
            for (PointIndex i = 0; i < cloud->size(); i += 3) hidden->insert(i);
            touchable.hidden = hidden;
            Progress progress;
            const PointSet points = pointsIn(region, *cloud, touchable, progress);
            const Attribute classes = *cloud->findAttribute("Classification");
            PointIndex found = 0;
            for (PointIndex i = 0; i < cloud->size(); ++i) {
                const PictureProjection& p = region.projection;
                const glm::dvec3 q = glm::dvec3(cloud->rawX()[i], cloud->rawY()[i], cloud->rawZ()[i]) - p.base;
                const auto row = [&](const glm::dvec4& r) { return r.x * q.x + r.y * q.y + r.z * q.z + r.w; };
                const double depth = row(p.rowD);
                const int code = int(classes.number(i));
                const bool expected = depth >= std::max(p.nearDepth, region.nearest) && depth <= region.furthest &&
                                      region.mask.contains(int(std::floor(row(p.rowX) / depth)),
                                                           int(std::floor(row(p.rowY) / depth))) &&
                                      code != 2 && code != 7 && !hidden->contains(i);
                if (points.contains(i) != expected) QFAIL(qPrintable(QStringLiteral("point %1").arg(i)));
                found += expected ? 1 : 0;
            }
            QVERIFY(found > 500);
        }
    }

    void setsAreCombined()
    {
        constexpr PointIndex kSize = 1'300'027;  // more than a piece
        std::mt19937_64 random(8);
        PointSet a(kSize), b(kSize);
        for (PointIndex i = 0; i < kSize; ++i) {
            if (random() % 3 == 0) a.insert(i);
            if (random() % 2 == 0) b.insert(i);
        }
        PointSet replaced = a, added = a, taken = a, both = a, inverse = a;
        combine(replaced, b, SelectMode::Replace);
        combine(added, b, SelectMode::Add);
        combine(taken, b, SelectMode::Subtract);
        combine(both, b, SelectMode::Intersect);
        inverse.invert();
        QVERIFY(replaced == b);
        for (PointIndex i = 0; i < kSize; ++i) {
            QVERIFY(added.contains(i) == (a.contains(i) || b.contains(i)));
            QVERIFY(taken.contains(i) == (a.contains(i) && !b.contains(i)));
            QVERIFY(both.contains(i) == (a.contains(i) && b.contains(i)));
            QVERIFY(inverse.contains(i) != a.contains(i));
        }
        QCOMPARE(inverse.count() + a.count(), kSize);
        QCOMPARE(countWithout(a, b), taken.count());
    }

    void neighborsGrowShrinkAndConnect()
    {
        const auto cloud = makeCloud(3'000, 9);
        Progress progress;
        const KdOrder order(*cloud, progress);
        std::mt19937_64 random(10);
        PointSet some(cloud->size());
        for (int k = 0; k < 40; ++k) some.insert(random() % cloud->size());
        constexpr double kDistance = 0.0605;  // of a box of 2 x 1 x 0.5
        const auto near = [&](PointIndex i, PointIndex j) {
            return glm::length(cloud->world(i) - cloud->world(j)) <= kDistance + 1e-12;
        };
        PointSet larger(cloud->size());
        for (PointIndex i = 0; i < cloud->size(); ++i)
            for (PointIndex j = 0; j < cloud->size(); ++j)
                if (some.contains(j) && near(i, j)) larger.insert(i);
        QVERIFY(grown(some, order, kDistance, progress) == larger);
        PointSet smaller = larger;
        for (PointIndex i = 0; i < cloud->size(); ++i)
            for (PointIndex j = 0; larger.contains(i) && j < cloud->size(); ++j)
                if (!larger.contains(j) && near(i, j)) smaller.remove(i);
        QVERIFY(smaller.count() > 0 && smaller.count() < larger.count());
        QVERIFY(shrunk(larger, order, kDistance, progress) == smaller);

        PointSet reached(cloud->size());
        std::vector<PointIndex> edge{17};
        reached.insert(17);
        while (!edge.empty()) {
            const PointIndex i = edge.back();
            edge.pop_back();
            for (PointIndex j = 0; j < cloud->size(); ++j)
                if (!reached.contains(j) && near(i, j)) {
                    reached.insert(j);
                    edge.push_back(j);
                }
        }
        PointSet seed(cloud->size());
        seed.insert(17);
        QVERIFY(reached.count() > 10);
        QVERIFY(connected(seed, order, kDistance, progress) == reached);
    }

    void cancelEndsAtOnce()
    {
        const auto cloud = makeCloud(500'000);
        Progress progress;
        const KdOrder order(*cloud, progress);
        PointSet all(cloud->size());
        all.invert();
        progress.cancel();
        Region region;
        region.projection = someView();
        region.mask = ScreenMask(640, 480);
        region.mask.addRectangle({0, 0}, {640, 480});
        QVERIFY_THROWS_EXCEPTION(Cancelled, pointsIn(region, *cloud, {}, progress));
        QVERIFY_THROWS_EXCEPTION(Cancelled, grown(all, order, 10.0, progress));
        QVERIFY_THROWS_EXCEPTION(Cancelled, connected(all, order, 10.0, progress));
    }

    /// Told, not judged: `punctum bench select` measures it on a quiet machine.
    void polygonIsFast()
    {
        const auto cloud = makeCloud(4'000'000);
        Region region;
        region.projection = someView();
        region.mask = ScreenMask(1280, 800);
        region.mask.addPolygon(std::vector<glm::dvec2>{{200, 100}, {520, 180}, {300, 260}, {450, 420}, {230, 330}});
        Progress progress;
        const auto start = std::chrono::steady_clock::now();
        const PointSet points = pointsIn(region, *cloud, {}, progress);
        const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
        qInfo("%.1f ms for 4 M points, %llu inside", took.count(), qulonglong(points.count()));
        QVERIFY(took.count() < 5000);
    }
};

QTEST_GUILESS_MAIN(SelectTest)
#include "SelectTest.moc"
