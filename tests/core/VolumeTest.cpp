// SPDX-License-Identifier: MIT
// Volumes between a surface and a height, or another surface, of solids whose volume is known.
#include "core/surface/Volume.h"

#include "core/Error.h"
#include "core/task/Progress.h"
#include "tests/core/MadeCloud.h"

#include <QTest>

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
    question.base = height;
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
    question.base = 50.0;
    question.within = {{1020, 2020}, {1060, 2020}, {1060, 2070}, {1020, 2070}};
    const Volume box = volumeOf(*cloud, tiles, question, progress);
    QVERIFY(std::abs(box.area - 2000) < 20);
    QVERIFY2(std::abs(box.cut - 2000 * 4.0) < 100, qPrintable(QString::number(box.cut)));
    QVERIFY(box.lacking < 1.0);
    question.within = {{1020, 2020}, {1160, 2020}, {1160, 2070}, {1020, 2070}};
    const Volume over = volumeOf(*cloud, tiles, question, progress);
    QVERIFY(std::abs(over.area - 4000) < 40);
    PointSet corner(cloud->size());
    for (PointIndex i = 0; i < cloud->size(); ++i)
        if (cloud->rawX()[i] < 50000 && cloud->rawY()[i] < 50000) corner.insert(i);
    question.within = outlineOf(*cloud, corner);
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

void VolumeTest::nothing()
{
    Progress progress;
    const auto cloud = groundOf(1000, 5, cone);
    const SurfaceTiles tiles = tilesOf(*cloud);
    VolumeQuestion question;
    question.within = {{0, 0}, {1, 0}, {1, 1}};
    QVERIFY_EXCEPTION_THROWN(volumeOf(*cloud, tiles, question, progress), Error);
    progress.cancel();
    QVERIFY_EXCEPTION_THROWN(volumeOf(*cloud, tiles, planeAt(50.0), progress), Cancelled);
    QVERIFY(outlineOf(*cloud, PointSet(cloud->size())).empty());
}

QTEST_APPLESS_MAIN(VolumeTest)
#include "VolumeTest.moc"
