// SPDX-License-Identifier: MIT
// What is left out by the boxes of stretches changes no result: against the same clouds with boxes that hold
// everything, by which nothing is left out, and against plain loops. Real files where they are there, and made
// clouds.
#include "core/cloud/BlockBoxes.h"
#include "core/cloud/PointFigures.h"
#include "core/cloud/Section.h"
#include "core/cloud/ShownExtent.h"
#include "core/las/Reader.h"
#include "core/measure/Nearest.h"
#include "core/select/Selecting.h"
#include "core/task/Progress.h"
#include "tests/render/SyntheticCloud.h"

#include <QTest>

#include <glm/geometric.hpp>

#include <filesystem>
#include <random>

using namespace punctum;
namespace fs = std::filesystem;

namespace
{

constexpr int kWidth = 640, kHeight = 400;
constexpr std::int32_t kLeast[] = {INT32_MIN}, kMost[] = {INT32_MAX};

struct Dice {
    std::mt19937_64 random;
    double number(double low, double high)
    {
        return low + (high - low) * double(random() >> 11) / double(std::uint64_t(1) << 53);
    }
    glm::dvec3 direction()
    {
        glm::dvec3 d(0.0);
        while (glm::length(d) < 0.1) d = {number(-1, 1), number(-1, 1), number(-1, 1)};
        return glm::normalize(d);
    }
    PointIndex point(const PointCloud& cloud) { return random() % cloud.size(); }
};

std::shared_ptr<PointCloud> load(const QString& name)
{
    if (name == "made") return test::makeCloud(300'000);
    const fs::path file = fs::path(PUNCTUM_TEST_DATA) / name.toStdString();
    Progress progress;
    return fs::exists(file) ? las::load(file, progress) : nullptr;
}

/// Gives the cloud boxes that hold everything, or nothing but one far corner.
void setBoxes(PointCloud& cloud, bool everything)
{
    const auto boxes = std::make_shared<BlockBoxes>(cloud.size());
    if (everything) boxes->includeAll(cloud.rawX().data(), cloud.rawY().data(), cloud.rawZ().data());
    for (std::size_t k = 0; k < boxes->size(); ++k) {
        const PointRange one{boxes->points(k).first, boxes->points(k).first + 1};
        for (PointIndex n = 0; n < (everything ? 1 : boxes->points(k).size()); ++n)
            boxes->include(one, kMost, kMost, kMost);
        if (everything) boxes->include(one, kLeast, kLeast, kLeast);
    }
    cloud.setArriving(boxes);
}

/// A look from anywhere to a point of the cloud, with a shape anywhere in the picture.
Region randomRegion(Dice& dice, const PointCloud& cloud)
{
    Region region;
    PictureProjection& p = region.projection;
    const glm::dvec3 step = cloud.coordinates().scale,
                     extent = glm::dvec3(cloud.computeBounds().max) - glm::dvec3(cloud.computeBounds().min);
    const PointIndex at = dice.point(cloud);
    p.base = {cloud.rawX()[at], cloud.rawY()[at], cloud.rawZ()[at]};
    const glm::dvec3 ahead = dice.direction();
    const glm::dvec3 right = glm::normalize(glm::cross(ahead, dice.direction())), down = glm::cross(ahead, right);
    const double distance = glm::length(extent * step) * std::exp(dice.number(-5, 1));
    p.perspective = dice.random() % 2 == 0;
    p.nearDepth = distance * 0.01;
    const double focal = p.perspective ? kWidth : kWidth / distance;
    p.rowD = {ahead * step, distance};
    p.rowX = {right * step * focal, p.perspective ? 0.0 : kWidth / 2.0};
    p.rowY = {down * step * focal, p.perspective ? 0.0 : kHeight / 2.0};
    if (p.perspective) {
        p.rowX += p.rowD * (kWidth / 2.0);
        p.rowY += p.rowD * (kHeight / 2.0);
    }
    if (dice.random() % 3 == 0) region.nearest = distance * dice.number(0.5, 1);
    if (dice.random() % 3 == 0) region.furthest = distance * dice.number(1, 1.5);
    region.mask = ScreenMask(kWidth, kHeight);
    std::vector<glm::dvec2> corners;
    const glm::dvec2 middle(dice.number(0, kWidth), dice.number(0, kHeight));
    const double size = std::exp(dice.number(1, 6));
    for (int k = 0; k < 6; ++k)
        corners.push_back(middle + glm::dvec2(dice.number(-size, size), dice.number(-size, size)));
    region.mask.addPolygon(corners);
    return region;
}

Clip randomClip(Dice& dice, const PointCloud& cloud)
{
    Clip clip;
    const WorldBounds all = cloud.coordinates().toWorld(cloud.computeBounds());
    const glm::dvec3 middle = cloud.world(dice.point(cloud));
    const glm::dvec3 half = (all.max - all.min) * std::exp(dice.number(-5, 0));
    if (dice.random() % 2 == 0) clip.box = WorldBounds{middle - half, middle + half};
    if (!clip.box || dice.random() % 2 == 0) {
        Section section;
        section.from = middle;
        section.to = cloud.world(dice.point(cloud));
        section.width = std::max(half.x, half.y);
        if (section.usable())
            for (const ClipPlane& side : section.sides()) clip.planes.push_back(side);
        const glm::dvec3 normal = dice.direction();
        clip.planes.push_back({normal, glm::dot(normal, middle)});  // goes right through a point
    }
    return clip;
}

/// Some runs of points, and some single ones.
std::shared_ptr<PointSet> randomSet(Dice& dice, const PointCloud& cloud)
{
    auto set = std::make_shared<PointSet>(cloud.size());
    for (int k = 0; k < 4; ++k) {
        const PointIndex first = dice.point(cloud);
        set->insert(PointRange{first, std::min(cloud.size(), first + dice.point(cloud))});
        set->insert(dice.point(cloud));
    }
    return set;
}

}  // namespace

class BoxCullingTest : public QObject
{
    Q_OBJECT

private Q_SLOTS:
    void resultsAreThoseOfAllPoints_data()
    {
        QTest::addColumn<QString>("file");
        for (const char* name : {"made", "autzen_trim.las", "megaplot.las", "tls_clip.laz", "epsg_4326.las"})
            QTest::newRow(name) << name;
    }

    void resultsAreThoseOfAllPoints()
    {
        QFETCH(QString, file);
        const auto cloud = load(file);
        if (!cloud) QSKIP("the shared test data is not here");
        const auto plain = load(file);
        const RawBounds bounds = cloud->computeBounds();
        setBoxes(*plain, true);
        Dice dice{std::mt19937_64(17)};
        Progress progress;
        PointIndex selected = 0, cut = 0;
        for (int round = 0; round < 40; ++round) {
            const Region region = randomRegion(dice, *cloud);
            const PointSet points = pointsIn(region, *cloud, {}, progress);
            QVERIFY(points == pointsIn(region, *plain, {}, progress));
            selected += points.count();

            Visibility visibility;
            visibility.clip = randomClip(dice, *cloud);
            if (round % 3 == 0) visibility.classVisible[2] = false;
            if (round % 4 == 0) visibility.filtered = randomSet(dice, *cloud);
            const auto hidden = hiddenPoints(*cloud, visibility, progress);
            QVERIFY(*hidden == *hiddenPoints(*plain, visibility, progress));
            cut += hidden->count();

            const auto leftOut = round % 2 == 0 ? hidden : randomSet(dice, *cloud);
            RawBounds left;
            PointIndex count = 0;
            for (PointIndex i = 0; i < cloud->size(); ++i)
                if (!leftOut->contains(i)) {
                    left.include(cloud->rawX()[i], cloud->rawY()[i], cloud->rawZ()[i]);
                    ++count;
                }
            const ShownHeights heights = shownHeights(*cloud, leftOut.get(), progress);
            QCOMPARE(heights.points, count);
            if (count != 0) {
                const CoordinateScale& grid = cloud->coordinates();
                QVERIFY(heights.low == grid.toWorld(glm::dvec3(left.min)).z);
                QVERIFY(heights.high == grid.toWorld(glm::dvec3(left.max)).z);
            }
            const PointFigures figures = computePointFigures(*cloud, leftOut.get(), progress);
            QCOMPARE(figures.points, count);
            QVERIFY(figures.bounds == left);
            const ShownExtent a = shownExtent(*cloud, bounds, leftOut.get(), glm::dvec3(1.0), progress),
                              b = shownExtent(*plain, bounds, leftOut.get(), glm::dvec3(1.0), progress);
            QCOMPARE(a.points, count);
            QVERIFY(a.points == b.points && a.strays == b.strays);
            QVERIFY(a.all.min == b.all.min && a.all.max == b.all.max);
            QVERIFY(a.typical.min == b.typical.min && a.typical.max == b.typical.max);

            const PointIndex at = dice.point(*cloud);
            const std::size_t wanted = 1 + dice.random() % 20;
            const auto near = nearestTo(*cloud, at, wanted, glm::dvec3(1.0), progress),
                       all = nearestTo(*plain, at, wanted, glm::dvec3(1.0), progress);
            QCOMPARE(near.size(), all.size());
            for (std::size_t k = 0; k < near.size(); ++k)
                QVERIFY(near[k].index == all[k].index && near[k].distance == all[k].distance);
        }
        QVERIFY(selected > 0 && cut > 0 && cut < 40 * cloud->size());
        QVERIFY(shownHeights(*cloud, nullptr, progress).points == cloud->size());
        QVERIFY(computePointFigures(*cloud, nullptr, progress).bounds == bounds);
    }

    /// Boxes that say that all points are elsewhere are believed: nobody looks at the points.
    void boxesAreGoneBy()
    {
        const auto cloud = test::makeCloud(100'000);
        Dice dice{std::mt19937_64(3)};
        Progress progress;
        Region region = randomRegion(dice, *cloud);
        for (PointSet points; points.count() == 0; points = pointsIn(region, *cloud, {}, progress))
            region = randomRegion(dice, *cloud);
        Visibility visibility;
        visibility.clip.box = cloud->coordinates().toWorld(cloud->computeBounds());
        QCOMPARE(hiddenPoints(*cloud, visibility, progress)->count(), PointIndex(0));
        setBoxes(*cloud, false);
        QCOMPARE(pointsIn(region, *cloud, {}, progress).count(), PointIndex(0));
        QCOMPARE(hiddenPoints(*cloud, visibility, progress)->count(), cloud->size());
    }
};

QTEST_APPLESS_MAIN(BoxCullingTest)
#include "BoxCullingTest.moc"
