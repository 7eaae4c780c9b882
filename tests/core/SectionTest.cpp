// SPDX-License-Identifier: MIT
#include "core/cloud/Section.h"
#include "core/task/Progress.h"
#include "tests/render/SyntheticCloud.h"

#include <glm/geometric.hpp>

#include <QTest>

using namespace punctum;

namespace
{

bool near(double a, double b, double slack = 1e-9)
{
    return std::abs(a - b) <= slack;
}

bool inside(const Section& section, const glm::dvec3& p)
{
    const auto sides = section.sides();
    return std::all_of(sides.begin(), sides.end(),
                       [&](const ClipPlane& side) { return glm::dot(side.normal, p) >= side.distance; });
}

}  // namespace

/// The slab of a section view, and which points lie in it.
class SectionTest : public QObject
{
    Q_OBJECT

private slots:
    void looksToTheLeftOfItsLine()
    {
        const Section east{{100, 50}, {110, 50}, 4.0, glm::dvec3(1.0)};
        QVERIFY(east.usable());
        QVERIFY(near(east.length(), 10));
        QVERIFY(east.along() == glm::dvec2(1, 0) && east.ahead() == glm::dvec2(0, 1));  // looks north
        QVERIFY(east.placeOf({103, 51.5, 7}) == glm::dvec2(3, 1.5));
        const Section slanted{{0, 0}, {30, 40}, 10.0, glm::dvec3(1.0)};
        QVERIFY(near(slanted.length(), 50));
        const glm::dvec2 place = slanted.placeOf({30 - 0.8 * 3, 40 + 0.6 * 3, 0});
        QVERIFY(near(place.x, 50) && near(place.y, 3));
        for (const glm::dvec2& corner : slanted.corners())
            QVERIFY(near(std::abs(slanted.placeOf({corner, 0}).y), 5));
        QVERIFY(near(slanted.placeOf({slanted.corners()[0], 0}).y, -5));
        QVERIFY(near(slanted.placeOf({slanted.corners()[2], 0}).x, 50));
    }

    void walksAndTurns()
    {
        const Section section{{0, 0}, {30, 40}, 10.0, glm::dvec3(1.0)};
        const Section next = section.walked(10.0);
        QVERIFY(near(section.placeOf({next.from, 0}).x, 0) && near(section.placeOf({next.from, 0}).y, 10));
        QVERIFY(near(next.length(), 50) && next.width == section.width);
        const Section back = next.walked(-10.0);
        QVERIFY(near(glm::distance(back.from, section.from), 0) && near(glm::distance(back.to, section.to), 0));
        const Section other = section.turned();
        QVERIFY(other.ahead() == -section.ahead());
        for (int k = 0; k < 500; ++k) {
            const glm::dvec3 p(k % 25 * 2.1 - 8, k / 25 * 3.3 - 8, k);
            QCOMPARE(inside(other, p), inside(section, p));
        }
        const WorldBounds box = other.box(-3, 5);
        QVERIFY(box.min == glm::dvec3(0, 0, -3) && box.max == glm::dvec3(30, 40, 5));
    }

    void itsSidesAreWhatItSays()
    {
        // in degrees, at 60 degrees north: a length in meters is half as many degrees along a meridian
        const glm::dvec3 degrees(55'800, 111'400, 1);
        for (const glm::dvec3& stretch : {glm::dvec3(1.0), degrees}) {
            const glm::dvec2 middle = stretch.z == stretch.x ? glm::dvec2(500'000, 5'000'000) : glm::dvec2(24, 60);
            const glm::dvec2 unit = 1.0 / glm::dvec2(stretch);
            const Section section{middle - glm::dvec2(30, 20) * unit, middle + glm::dvec2(30, 20) * unit, 8.0,
                                  stretch};
            QVERIFY(near(section.length(), 2 * std::hypot(30, 20), 1e-6));
            QVERIFY(inside(section, {section.from, 0}) && inside(section, {section.to, 1e6}));
            PointIndex in = 0;
            for (int k = 0; k < 4000; ++k) {
                const glm::dvec2 at = middle + glm::dvec2(k % 80 - 40, k / 80 - 25) * unit * 1.01;
                const glm::dvec2 place = section.placeOf({at, k});
                const bool expected =
                    place.x >= 0 && place.x <= section.length() && std::abs(place.y) <= section.width / 2;
                if (near(place.x, 0, 1e-3) || near(place.x, section.length(), 1e-3)) continue;
                if (near(std::abs(place.y), section.width / 2, 1e-3)) continue;
                QCOMPARE(inside(section, {at, k}), expected);
                in += expected ? 1 : 0;
            }
            QVERIFY(in > 300);
        }
    }

    void sectionsOfNothingAreNone()
    {
        QVERIFY(!(Section{{1, 1}, {1, 1}, 5.0, glm::dvec3(1.0)}.usable()));
        QVERIFY(!(Section{{1, 1}, {2, 1}, 0.0, glm::dvec3(1.0)}.usable()));
        QVERIFY(!(Section{{1, 1}, {2, NAN}, 1.0, glm::dvec3(1.0)}.usable()));
    }

    void heightsOfWhatIsShown()
    {
        const auto cloud = test::makeCloud(40'001);
        Progress progress;
        const Section section{{20, 30}, {150, 170}, 12.0, glm::dvec3(1.0)};
        Visibility visibility;
        const auto sides = section.sides();
        visibility.clip.planes.assign(sides.begin(), sides.end());
        const auto hidden = hiddenPoints(*cloud, visibility, progress);
        const ShownHeights got = shownHeights(*cloud, hidden.get(), progress);
        ShownHeights expected;
        for (PointIndex i = 0; i < cloud->size(); ++i) {
            const glm::dvec3 p = cloud->world(i);
            if (inside(section, p)) expected.include({1, p.z, p.z});
        }
        QVERIFY(expected.points > 500);
        QCOMPARE(got.points, expected.points);
        QCOMPARE(got.low, expected.low);
        QCOMPARE(got.high, expected.high);
        QCOMPARE(shownHeights(*cloud, nullptr, progress).points, cloud->size());
        PointSet all(cloud->size());
        all.invert();
        QCOMPARE(shownHeights(*cloud, &all, progress).points, PointIndex(0));
    }
};

QTEST_GUILESS_MAIN(SectionTest)
#include "SectionTest.moc"
