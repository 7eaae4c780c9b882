// SPDX-License-Identifier: MIT
#include "core/cloud/ShownExtent.h"
#include "core/cloud/Visibility.h"
#include "core/expression/Condition.h"
#include "core/task/Progress.h"
#include "tests/core/MadeCloud.h"
#include "tests/render/SyntheticCloud.h"

#include <QTest>

using namespace punctum;

/// Which points a view hides.
class VisibilityTest : public QObject
{
    Q_OBJECT

private Q_SLOTS:
    void boxesMeanDecimals();
    void hidesWhatItSays_data();
    void hidesWhatItSays();
    void hidesNothing();
    void canBeCancelled();
    void extentOfWhatIsShown();
    void straysAreLeftOut_data();
    void straysAreLeftOut();
};

// 0.3 is not 300 * 0.001 in double, and yet the box from 0.1 to 0.3 has the points at 0.100 and at 0.300.
void VisibilityTest::boxesMeanDecimals()
{
    const CoordinateScale grid{glm::dvec3(0.001, 0.01, 1e-7), glm::dvec3(0, 500'000, -94)};
    const RawBounds raw = rawInside({{0.1, 500'000.07, -94.0000003}, {0.3, 500'000.57, -93.9999999}}, grid);
    QCOMPARE(raw.min.x, 100);
    QCOMPARE(raw.max.x, 300);
    QCOMPARE(raw.min.y, 7);
    QCOMPARE(raw.max.y, 57);
    QCOMPARE(raw.min.z, -3);
    QCOMPARE(raw.max.z, 1);
    const RawBounds huge = rawInside({glm::dvec3(-1e300), glm::dvec3(1e300)}, grid);
    QVERIFY(huge.min.x < INT32_MIN && huge.max.x > INT32_MAX);
    const RawBounds between = rawInside({glm::dvec3(0.1002, 0, 0), glm::dvec3(0.1007, 1, 1)}, grid);
    QVERIFY(between.min.x > between.max.x);  // no point of the grid
}

void VisibilityTest::hidesWhatItSays_data()
{
    QTest::addColumn<bool>("classes");
    QTest::addColumn<bool>("box");
    QTest::addColumn<int>("planes");
    QTest::addColumn<bool>("filter");
    for (int k = 1; k < 16; ++k)
        QTest::addRow("%s%s%s%s", k & 1 ? " classes" : "", k & 2 ? " box" : "", k & 4 ? " planes" : "",
                      k & 8 ? " filter" : "")
            << bool(k & 1) << bool(k & 2) << (k & 4 ? 2 : 0) << bool(k & 8);
}

void VisibilityTest::hidesWhatItSays()
{
    QFETCH(bool, classes);
    QFETCH(bool, box);
    QFETCH(int, planes);
    QFETCH(bool, filter);
    const auto cloud = test::makeCloud(50'003);
    Progress progress;
    Visibility v;
    if (classes) v.classVisible[6] = false;
    if (box) v.clip.box = WorldBounds{{20, 30, -100}, {150, 160.5, 8}};
    if (planes > 0) v.clip.planes = {{{1, 1, 0}, 90}, {{0, -1, 0.5}, -140}};
    if (filter)
        v.filtered =
            expression::selectOthers(*cloud, expression::Condition("Intensity > 2000 or Z < 0", *cloud), progress);
    const auto hidden = hiddenPoints(*cloud, v, progress);
    QVERIFY(hidden);
    const Attribute &code = *cloud->findAttribute("Classification"),
                    &intensity = *cloud->findAttribute("Intensity");
    PointIndex count = 0;
    for (PointIndex i = 0; i < cloud->size(); ++i) {
        const glm::dvec3 p = cloud->world(i);
        const bool expected =
            (classes && code.number(i) == 6) ||
            (box && (p.x < 20 || p.x > 150 || p.y < 30 || p.y > 160.5 || p.z < -100 || p.z > 8)) ||
            (planes > 0 && (p.x + p.y < 90 || -p.y + 0.5 * p.z < -140)) ||
            (filter && !(intensity.number(i) > 2000 || p.z < 0));
        QCOMPARE(hidden->contains(i), expected);
        count += expected;
    }
    QCOMPARE(hidden->count(), count);
    PointSet few(cloud->size());
    for (PointIndex i = 7; i < cloud->size(); i += 1000) few.insert(i);
    const auto amongFew = hiddenPoints(*cloud, v, progress, &few);
    few.forEach([&](PointIndex i) { QCOMPARE(amongFew->contains(i), hidden->contains(i)); });
    QVERIFY(amongFew->count() < count);
    QVERIFY(count > 0 && count < cloud->size());
}

void VisibilityTest::hidesNothing()
{
    const auto cloud = test::makeCloud(100);
    Progress progress;
    QVERIFY(!hiddenPoints(*cloud, {}, progress));
}

void VisibilityTest::canBeCancelled()
{
    const auto cloud = test::makeCloud(1000);
    Progress progress;
    progress.cancel();
    Visibility v;
    v.classVisible[2] = false;
    QVERIFY_EXCEPTION_THROWN(hiddenPoints(*cloud, v, progress), Cancelled);
}

void VisibilityTest::extentOfWhatIsShown()
{
    const auto cloud = test::makeCloud(50'003);
    Progress progress;
    const RawBounds bounds = cloud->computeBounds();
    ShownExtent extent = shownExtent(*cloud, bounds, nullptr, glm::dvec3(1.0), progress);
    const WorldBounds all = cloud->coordinates().toWorld(bounds);
    QCOMPARE(extent.points, cloud->size());
    QCOMPARE(extent.strays, PointIndex(0));
    QVERIFY(extent.all.min == all.min && extent.all.max == all.max);
    QVERIFY(extent.typical.min == all.min && extent.typical.max == all.max);

    Visibility v;
    v.clip.box = WorldBounds{{20, 30, -100}, {150, 160.5, 8}};
    const auto hidden = hiddenPoints(*cloud, v, progress);
    extent = shownExtent(*cloud, bounds, hidden.get(), glm::dvec3(1.0), progress);
    QCOMPARE(extent.points, cloud->size() - hidden->count());
    QVERIFY(extent.all.min.x >= 20 && extent.all.max.x <= 150 && extent.all.max.z <= 8);

    PointSet everything(cloud->size());
    everything.insert(PointRange{0, cloud->size()});
    extent = shownExtent(*cloud, bounds, &everything, glm::dvec3(1.0), progress);
    QCOMPARE(extent.points, PointIndex(0));
    QVERIFY(extent.all.empty() && extent.typical.empty());
    progress.cancel();
    QVERIFY_EXCEPTION_THROWN(shownExtent(*cloud, bounds, nullptr, glm::dvec3(1.0), progress), Cancelled);
}

void VisibilityTest::straysAreLeftOut_data()
{
    QTest::addColumn<int>("points");
    QTest::addColumn<int>("strays");
    QTest::addColumn<int>("axis");
    QTest::addColumn<bool>("found");
    QTest::newRow("one far away") << 1000 << 1 << 0 << true;
    QTest::newRow("one far above") << 50'000 << 1 << 2 << true;
    QTest::newRow("some of many") << 300'000 << 200 << 1 << true;
    QTest::newRow("of few points") << 30 << 1 << 0 << true;
    QTest::newRow("too many to be strays") << 1000 << 100 << 0 << false;
}

// A square of 100 m; strays are 100 km away along one axis.
void VisibilityTest::straysAreLeftOut()
{
    QFETCH(int, points);
    QFETCH(int, strays);
    QFETCH(int, axis);
    QFETCH(bool, found);
    const auto cloud = makeFrame(PointIndex(points), {glm::dvec3(0.01), glm::dvec3(500'000, 4'500'000, 0)});
    for (int k = 0; k < points; ++k) {
        const std::uint32_t random = std::uint32_t(k) * 2654435769u;
        rawAxis(*cloud, 0)[std::size_t(k)] = std::int32_t(random >> 16) * 10'000 / 65'536;
        rawAxis(*cloud, 1)[std::size_t(k)] = std::int32_t(random & 0xFFFF) * 10'000 / 65'536;
    }
    // Spread over the file.
    for (int k = 0; k < strays; ++k)
        rawAxis(*cloud, std::size_t(axis))[std::size_t((k * 37 + 5) % points)] = 10'000'000 + k;
    Progress progress;
    const ShownExtent extent = shownExtent(*cloud, cloud->computeBounds(), nullptr, glm::dvec3(1.0), progress);
    QCOMPARE(extent.points, PointIndex(points));
    QCOMPARE(extent.strays, PointIndex(found ? strays : 0));
    const WorldBounds& seen = extent.typical;
    QVERIFY((seen.max[axis] - seen.min[axis] < 101) == found);
    QVERIFY(extent.all.max[axis] - extent.all.min[axis] > 90'000);

    // Hidden, they are not counted, and the fit needs not know of them.
    PointSet hidden(cloud->size());
    for (int k = 0; k < strays; ++k) hidden.insert(PointIndex((k * 37 + 5) % points));
    const ShownExtent others = shownExtent(*cloud, cloud->computeBounds(), &hidden, glm::dvec3(1.0), progress);
    QCOMPARE(others.strays, PointIndex(0));
    QVERIFY(others.all.max[axis] - others.all.min[axis] < 101);
}

QTEST_APPLESS_MAIN(VisibilityTest)
#include "VisibilityTest.moc"
