// SPDX-License-Identifier: MIT
// Volumes between a surface and a height, or another surface, of solids whose volume is known.
#include "core/surface/Volume.h"

#include "core/Error.h"
#include "core/task/Progress.h"
#include "tests/core/MadeCloud.h"

#include <QTest>

#include <glm/geometric.hpp>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

using namespace punctum;

namespace
{

/// Ground points over 100 m by 100 m at random, with heights of a function; all points are ground.
std::shared_ptr<PointCloud> groundOf(PointIndex n, unsigned seed,
                                     const std::function<double(double, double)>& height, double noise = 0.0)
{
    const auto cloud = makeFrame(n, {glm::dvec3(0.001), glm::dvec3(1000, 2000, 50)});
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> place(0, 100);
    std::normal_distribution<double> scatter(0, 1);
    for (PointIndex i = 0; i < n; ++i) {
        const double x = place(random), y = place(random);
        rawAxis(*cloud, 0)[i] = std::int32_t(x * 1000);
        rawAxis(*cloud, 1)[i] = std::int32_t(y * 1000);
        rawAxis(*cloud, 2)[i] = std::int32_t(std::lround((height(x, y) + noise * scatter(random)) * 1000));
    }
    // the corners, so that the whole square has a surface
    for (PointIndex i = 0; i < 4; ++i) {
        rawAxis(*cloud, 0)[i] = i % 2 != 0 ? 100000 : 0;
        rawAxis(*cloud, 1)[i] = i / 2 != 0 ? 100000 : 0;
        rawAxis(*cloud, 2)[i] =
            std::int32_t(std::lround(height(i % 2 != 0 ? 100.0 : 0.0, i / 2 != 0 ? 100.0 : 0.0) * 1000));
    }
    return cloud;
}

SurfaceTiles tilesOf(const PointCloud& cloud)
{
    PointSet all(cloud.size());
    all.invert();
    Progress progress;
    return SurfaceTiles(cloud, all, 0.0, progress);
}

VolumeQuestion planeAt(double height)
{
    VolumeQuestion question;
    question.height = height;
    return question;
}

double cone(double x, double y)
{
    return std::max(0.0, 20.0 - std::hypot(x - 50, y - 50));  // 20 high, 20 about
}

}  // namespace

class VolumeTest : public QObject
{
    Q_OBJECT

private slots:
    void solids();
    void within();
    void twoSurfaces();
    void deviation();
    void cover();
    void edgeBases();
    void outlineOfHollow();
    void deviationOfEdge();
    void pointsNearby();
    void nothing();
};

void VolumeTest::solids()
{
    Progress progress;
    const auto cloud = groundOf(40000, 1, cone);
    const SurfaceTiles tiles = tilesOf(*cloud);
    const double volume = std::numbers::pi * 400 * 20 / 3;
    const Volume above = volumeOf(*cloud, tiles, planeAt(50.0), progress);
    QVERIFY2(std::abs(above.cut / volume - 1) < 0.003, qPrintable(QString::number(above.cut / volume)));
    QVERIFY(above.fill < 1e-3 * volume);
    QVERIFY2(std::abs(above.area - 10000) < 60, qPrintable(QString::number(above.area)));
    QVERIFY(above.points > 39000);
    // a plane 10 above the foot: a smaller cone over it, the rest below
    const Volume half = volumeOf(*cloud, tiles, planeAt(60.0), progress);
    QVERIFY2(std::abs(half.cut / (volume / 8) - 1) < 0.01, qPrintable(QString::number(half.cut / volume * 8)));
    QVERIFY(std::abs(half.net() - (above.net() - 10 * half.area)) < 1e-6 * volume);
}

void VolumeTest::within()
{
    Progress progress;
    const auto cloud = groundOf(40000, 2, [](double x, double) { return x / 10; });
    const SurfaceTiles tiles = tilesOf(*cloud);
    VolumeQuestion question;
    question.height = 50.0;
    question.within = {{{1020, 2020}, {1060, 2020}, {1060, 2070}, {1020, 2070}}};
    const Volume box = volumeOf(*cloud, tiles, question, progress);
    QVERIFY2(std::abs(box.area - 2000) < 0.01, qPrintable(QString::number(box.area)));
    QVERIFY2(std::abs(box.cut - 2000 * 4.0) < 1, qPrintable(QString::number(box.cut)));
    QVERIFY(box.lacking < 1.0);
    question.within = {{{1020, 2020}, {1160, 2020}, {1160, 2070}, {1020, 2070}}};
    const Volume over = volumeOf(*cloud, tiles, question, progress);
    QVERIFY(std::abs(over.area - 4000) < 40);
    PointSet corner(cloud->size());
    for (PointIndex i = 0; i < cloud->size(); ++i)
        if (cloud->rawX()[i] < 50000 && cloud->rawY()[i] < 50000) corner.insert(i);
    question.within = {outlineOf(*cloud, corner)};
    const Volume quarter = volumeOf(*cloud, tiles, question, progress);
    QVERIFY2(std::abs(quarter.area - 2500) < 40, qPrintable(QString::number(quarter.area)));
}

void VolumeTest::twoSurfaces()
{
    Progress progress;
    const auto cloud = groundOf(30000, 3, cone);
    const auto other = groundOf(20000, 4, [](double x, double y) { return cone(x, y) + (x < 50 ? 1.0 : -2.0); });
    const SurfaceTiles tiles = tilesOf(*cloud), otherTiles = tilesOf(*other);
    VolumeQuestion question;
    question.base = VolumeBase::Surface;
    question.otherCloud = other.get();
    question.otherTiles = &otherTiles;
    const Volume between = volumeOf(*cloud, tiles, question, progress);
    QVERIFY2(std::abs(between.fill / 5000 - 1) < 0.02, qPrintable(QString::number(between.fill)));
    QVERIFY2(std::abs(between.cut / 10000 - 1) < 0.02, qPrintable(QString::number(between.cut)));
}

void VolumeTest::deviation()
{
    Progress progress;
    // the volume's own scatter over many surveys of the same plane, and what each says of it
    double sum = 0, squares = 0, told = 0;
    constexpr int kSurveys = 40;
    for (unsigned k = 0; k < kSurveys; ++k) {
        const auto cloud = groundOf(
            2500, 100 + k, [](double, double) { return 55.0; }, 0.1);  // level: the outline varies, too
        const Volume volume = volumeOf(*cloud, tilesOf(*cloud), planeAt(50.0), progress);
        QVERIFY2(std::abs(volume.residual - 0.1) < 0.02, qPrintable(QString::number(volume.residual)));
        // per area, since the outline is a little different each time
        const double mean = volume.net() / volume.area;
        sum += mean;
        squares += mean * mean;
        told += volume.deviation / volume.area / kSurveys;
    }
    const double found = std::sqrt((squares - sum * sum / kSurveys) / (kSurveys - 1));
    QVERIFY2(told > found / 1.6 && told < found * 1.6,
             qPrintable(QStringLiteral("told %1, found %2").arg(told).arg(found)));
}

void VolumeTest::cover()
{
    // of cells, against many small places
    const std::vector<Ring> rings{{{1.3, 0.7}, {9.1, 2.2}, {6.4, 8.9}, {5.0, 4.0}, {2.2, 7.7}},
                                  {{4.0, 2.5}, {6.0, 2.5}, {6.0, 3.5}, {4.0, 3.5}}};
    CellCover cover(rings, 0, 10);
    double whole = 0;
    for (int j = 0; j < 10; ++j) {
        const auto row = cover.row(0, 1, 10, j, 1);
        for (int i = 0; i < 10; ++i) {
            constexpr int kFine = 200;
            double share = 0;
            glm::dvec2 middle(0);
            for (int k = 0; k < kFine * kFine; ++k) {
                const glm::dvec2 place(i + (k % kFine + 0.5) / kFine, j + (k / kFine + 0.5) / kFine);
                if (!isInside(rings, place)) continue;
                share += 1.0 / (kFine * kFine);
                middle += place / double(kFine * kFine);
            }
            const CellCover::Part& part = row[std::size_t(i)];
            QVERIFY(std::abs(part.share - share) < 0.02);
            if (share > 0.1) QVERIFY(glm::distance(glm::dvec2(part.x, part.y), middle / share) < 0.05);
            whole += part.share;
        }
    }
    const double area = std::abs(signedArea(rings[0])) - 2.0;
    QVERIFY2(std::abs(whole - area) < 0.02, qPrintable(QString::number(whole - area)));
    QVERIFY(std::abs(areaInside(rings) - area) < 1e-3);
    QCOMPARE(areaInside({}), 0.0);
}

void VolumeTest::edgeBases()
{
    Progress progress;
    // a cone of 20 by 20 on a slope, the pile; and a box 4 deep in it
    const double volume = std::numbers::pi * 400 * 20 / 3;
    const auto slope = [](double x, double y) { return 0.1 * x - 0.05 * y; };
    const auto cloud = groundOf(60000, 6, [&](double x, double y) { return cone(x, y) + slope(x, y); });
    const SurfaceTiles tiles = tilesOf(*cloud);
    VolumeQuestion question;
    question.within = {{{1022, 2022}, {1078, 2025}, {1081, 2074}, {1050, 2078}, {1024, 2077}}};
    const double area = areaInside(question.within);
    for (const VolumeBase base : {VolumeBase::Outline, VolumeBase::Plane}) {
        question.base = base;
        const Volume pile = volumeOf(*cloud, tiles, question, progress);
        QVERIFY2(std::abs(pile.net() / volume - 1) < 0.003, qPrintable(QString::number(pile.net() / volume)));
        QVERIFY2(pile.fill < 1.0, qPrintable(QString::number(pile.fill)));
        QVERIFY2(std::abs(pile.area / area - 1) < 1e-4, qPrintable(QString::number(pile.area / area)));
        QVERIFY(pile.lacking < 1e-3 * area);
        QVERIFY(std::abs(pile.edge - (56.08 + 49.09 + 31.26 + 26.02 + 55.04)) < 0.1);
        QCOMPARE(pile.edgeLacking, 0.0);
    }
    // the lowest of the edge is at its corner in the northwest, against sums over a fine lattice
    question.base = VolumeBase::Lowest;
    const Volume low = volumeOf(*cloud, tiles, question, progress);
    QVERIFY2(std::abs(low.height - (50 + slope(24, 77))) < 0.01, qPrintable(QString::number(low.height)));
    double sum = 0;
    for (double y = 20.05; y < 80; y += 0.1)
        for (double x = 20.05; x < 85; x += 0.1)
            if (isInside(question.within, {1000 + x, 2000 + y}))
                sum += 0.01 * (cone(x, y) + slope(x, y) - slope(24, 77));
    QVERIFY2(std::abs(low.net() / sum - 1) < 0.002, qPrintable(QString::number(low.net() / sum)));
    question.base = VolumeBase::Height;
    question.height = low.height;
    QVERIFY(std::abs(volumeOf(*cloud, tiles, question, progress).net() - low.net()) < 1e-6 * low.net());
    // an edge without surface, and no edge at all
    question.base = VolumeBase::Outline;
    question.within = {{{1050, 2050}, {1150, 2050}, {1150, 2060}, {1050, 2060}}};
    const Volume over = volumeOf(*cloud, tiles, question, progress);
    QVERIFY(std::abs(over.edgeLacking - 110) < 1.5 && std::abs(over.lacking - 500) < 5);
    question.within = {{{1020, 2020}, {1050, 2050}, {1080, 2080}}};
    QVERIFY_EXCEPTION_THROWN(volumeOf(*cloud, tiles, question, progress), Error);
    question.within.clear();
    QVERIFY_EXCEPTION_THROWN(volumeOf(*cloud, tiles, question, progress), Error);
    QCOMPARE(volumeBaseOf("plane"), std::optional(VolumeBase::Plane));
    QVERIFY(!volumeBaseOf("flat"));
}

void VolumeTest::outlineOfHollow()
{
    Progress progress;
    // an outline that is bent inwards and follows a valley between its corners: no straight line counts
    const auto valley = [](double x, double y) { return 0.01 * (x - 50) * (x - 50) + 0.1 * y; };
    const auto cloud = groundOf(
        80000, 7, [&](double x, double y) { return valley(x, y) + (x > 40 && x < 60 && y < 48 ? 3.0 : 0.0); });
    const SurfaceTiles tiles = tilesOf(*cloud);
    VolumeQuestion question;
    question.base = VolumeBase::Outline;
    question.within = {{{1030, 2010}, {1070, 2010}, {1070, 2070}, {1050, 2055}, {1030, 2070}}};
    // 3 high on 20 by 38, whose lower part the edge crosses; what it should be by triangles through the edge
    const Volume pit = volumeOf(*cloud, tiles, question, progress);
    double sum = 0;
    constexpr double kStep = 0.25;
    const SurfaceTiles& fine = tiles;
    std::vector<Ring> raw = question.within;
    for (glm::dvec2& p : raw[0]) p = (p - glm::dvec2(1000, 2000)) * 1000.0;
    const EdgeBase base(VolumeBase::Outline, raw, fine, progress);
    std::uint32_t near = 0;
    for (double y = kStep / 2; y < 100; y += kStep)
        for (double x = kStep / 2; x < 100; x += kStep)
            if (isInside(question.within, {1000 + x, 2000 + y}))
                sum += kStep * kStep *
                       (valley(x, y) + (x > 40 && x < 60 && y < 48 ? 3.0 : 0.0) -
                        base.height(x * 1000, y * 1000, near) / 1000);
    QVERIFY2(std::abs(pit.net() - sum) < 20, qPrintable(QStringLiteral("%1 %2").arg(pit.net()).arg(sum)));
    // along the edge it is the ground itself, between the corners too
    for (double x = 31; x < 39; x += 0.5)
        QVERIFY(std::abs(base.height(x * 1000, 10000, near) / 1000 - valley(x, 10)) < 0.02);
    for (double t = 0.1; t < 1; t += 0.1)
        QVERIFY(std::abs(base.height(70000 - t * 20000, 70000 - t * 15000, near) / 1000 -
                         valley(70 - t * 20, 70 - t * 15)) < 0.02);
}

void VolumeTest::deviationOfEdge()
{
    Progress progress;
    for (const VolumeBase base : {VolumeBase::Outline, VolumeBase::Plane}) {
        double sum = 0, squares = 0, told = 0;
        constexpr int kSurveys = 60;
        for (unsigned k = 0; k < kSurveys; ++k) {
            const auto cloud = groundOf(
                4000, 300 + k, [](double x, double) { return 55.0 + 0.1 * x; }, 0.1);
            VolumeQuestion question;
            question.base = base;
            question.within = {{{1020, 2020}, {1070, 2015}, {1080, 2060}, {1030, 2070}}};
            const Volume volume = volumeOf(*cloud, tilesOf(*cloud), question, progress);
            sum += volume.net();
            squares += volume.net() * volume.net();
            told += volume.deviation / kSurveys;
        }
        const double found = std::sqrt((squares - sum * sum / kSurveys) / (kSurveys - 1));
        QVERIFY2(told > found / 1.6 && told < found * 1.6,
                 qPrintable(QStringLiteral("%1: told %2, found %3").arg(int(base)).arg(told).arg(found)));
    }
}

void VolumeTest::pointsNearby()
{
    Progress progress;
    // a large survey, of which the points about the area give the same figures as all of them
    const auto cloud = makeFrame(40000, {glm::dvec3(0.01), glm::dvec3(0)});
    std::mt19937 random(11);
    std::uniform_real_distribution<double> place(0, 4000);
    const auto codes = cloud->findAttribute("Classification")->columns[0]->values<std::uint8_t>();
    for (PointIndex i = 0; i < cloud->size(); ++i) {
        const double x = place(random), y = place(random);
        rawAxis(*cloud, 0)[i] = std::int32_t(x * 100);
        rawAxis(*cloud, 1)[i] = std::int32_t(y * 100);
        rawAxis(*cloud, 2)[i] = std::int32_t((100 + 5 * std::sin(x / 70) * std::cos(y / 50)) * 100);
        codes[i] = i % 3 == 0 ? 5 : 2;
        if (i % 3 == 0) rawAxis(*cloud, 2)[i] += 2000;
    }
    const std::bitset<256> ground(4);
    VolumeQuestion question;
    question.base = VolumeBase::Outline;
    question.within = {{{1800, 1900}, {2300, 1850}, {2200, 2400}}};
    const PointSet all = pointsForVolume(*cloud, {}, &ground, nullptr, progress);
    QCOMPARE(all.count(), PointIndex(40000 - 13334));
    const PointSet some = pointsForVolume(*cloud, question.within, &ground, nullptr, progress);
    QVERIFY(some.count() < all.count() / 2);
    const Volume a = volumeOf(*cloud, SurfaceTiles(*cloud, all, 500, progress), question, progress);
    const Volume b = volumeOf(*cloud, SurfaceTiles(*cloud, some, 500, progress), question, progress);
    QVERIFY2(std::abs(a.net() - b.net()) < 1e-2 * a.area, qPrintable(QString::number(a.net() - b.net())));
    QVERIFY(anySurfaceIn(*cloud, question.within, some));
    QVERIFY(!anySurfaceIn(*cloud, std::vector<Ring>{{{0, 0}, {10, 0}, {10, 10}}}, some));
    // hidden ones are none of it
    QCOMPARE(pointsForVolume(*cloud, {}, nullptr, &all, progress).count(), PointIndex(13334));
    progress.cancel();
    QVERIFY_EXCEPTION_THROWN(pointsForVolume(*cloud, {}, &ground, nullptr, progress), Cancelled);
}

void VolumeTest::nothing()
{
    Progress progress;
    const auto cloud = groundOf(1000, 5, cone);
    const SurfaceTiles tiles = tilesOf(*cloud);
    VolumeQuestion question;
    question.within = {{{0, 0}, {1, 0}, {1, 1}}};
    QVERIFY_EXCEPTION_THROWN(volumeOf(*cloud, tiles, question, progress), Error);
    progress.cancel();
    QVERIFY_EXCEPTION_THROWN(volumeOf(*cloud, tiles, planeAt(50.0), progress), Cancelled);
    QVERIFY(outlineOf(*cloud, PointSet(cloud->size())).empty());
}

QTEST_APPLESS_MAIN(VolumeTest)
#include "VolumeTest.moc"
