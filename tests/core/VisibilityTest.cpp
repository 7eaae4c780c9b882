// SPDX-License-Identifier: MIT
#include "core/cloud/Visibility.h"
#include "core/expression/Condition.h"
#include "core/task/Progress.h"
#include "tests/render/SyntheticCloud.h"

#include <QtTest>

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

QTEST_APPLESS_MAIN(VisibilityTest)
#include "VisibilityTest.moc"
