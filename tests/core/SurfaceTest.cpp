// SPDX-License-Identifier: MIT
// The surface in tiles against the triangulation of all ground points at once, at first and after edits.
#include "core/surface/Surface.h"

#include "core/Error.h"
#include "core/las/Reader.h"
#include "core/surface/SurfaceHeights.h"
#include "core/task/Progress.h"
#include "tests/core/MadeCloud.h"

#include <QTest>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <random>
#include <set>

using namespace punctum;

namespace
{

using Cloud = std::shared_ptr<PointCloud>;
using Corners = std::array<std::pair<std::int32_t, std::int32_t>, 3>;

std::span<std::uint8_t> classesOf(PointCloud& cloud)
{
    return cloud.findAttribute("Classification")->columns[0]->values<std::uint8_t>();
}

Cloud cloudOf(const std::string& kind, PointIndex n = 20000)
{
    std::mt19937 random(21);
    const auto unit = [&] { return double(random()) / 4294967296.0; };
    CoordinateScale scale{glm::dvec3(0.01), glm::dvec3(0)};
    if (kind == "degrees") scale = {glm::dvec3(1e-7, 1e-7, 0.01), glm::dvec3(13.0, 52.0, 0.0)};
    Cloud cloud;
    if (kind.find('/') != std::string::npos) {
        const std::filesystem::path path = std::filesystem::path(PUNCTUM_TEST_DATA) / kind;
        Progress progress;
        return std::filesystem::exists(path) ? las::load(path, progress) : nullptr;
    }
    cloud = makeFrame(n, scale);
    if (kind == "degrees") cloud->setUnits(CoordinateUnits::degreesAndMeters());
    for (PointIndex i = 0; i < n; ++i) {
        double x = unit() * 40000, y = unit() * 40000;
        if (kind == "holes") {  // halls of up to 150 m, and a bay
            x = unit() * 60000;
            const bool inHall = std::abs(x - 30000) < 7000 && std::abs(y - 20000) < 7500;
            const bool inBay = x > 45000 && std::abs(y - 10000 - x / 10) < 8000;
            if (inHall || inBay) y = 35000 + unit() * 5000;
        } else if (kind == "islands") {
            const int island = int(i % 5);
            x = island * 37000 + unit() * 9000;
            y = island % 2 * 21000 + unit() * 9000;
            if (i == 17) {
                x = 90000000;
                y = -70000000;
            }
        } else if (kind == "scanner") {
            const double r = 30000 / (1.0 + 100.0 * unit()), angle = 6.283 * unit();
            x = r * std::cos(angle);
            y = r * std::sin(angle);
        } else if (kind == "grid") {
            x = double(i % 173) * 100;
            y = double(i / 173) * 100;
        } else if (kind == "line") {
            x = double(i) * 10;
            y = double(i) * 10;
        } else if (kind == "one place") {
            x = y = 4;
        }
        rawAxis(*cloud, 0)[i] = std::int32_t(x);
        rawAxis(*cloud, 1)[i] = std::int32_t(y);
        rawAxis(*cloud, 2)[i] = std::int32_t(1000 * std::sin(x / 5000) + 50 * unit());
        classesOf(*cloud)[i] = unit() < 0.6 ? 2 : 5;
    }
    return cloud;
}

bool isGround(const PointCloud& cloud, PointIndex i)
{
    return cloud.findAttribute("Classification")->number(i) == 2.0 &&
           !(cloud.deleted() && cloud.deleted()->contains(i));
}

Triangulation wholeOf(const PointCloud& cloud, const PlaneMetric& metric)
{
    std::vector<SurfacePoint> points;
    for (PointIndex i = 0; i < cloud.size(); ++i)
        if (isGround(cloud, i))
            points.push_back({cloud.rawX()[i], cloud.rawY()[i], cloud.rawZ()[i], std::uint32_t(i)});
    return Triangulation(points, metric);
}

/// Triangles that count and whose middle is in a tile, with the least corner first.
std::map<std::size_t, std::set<Corners>> trianglesOf(const SurfaceTiles& tiles, const SurfaceNet& net)
{
    std::map<std::size_t, std::set<Corners>> all;
    for (std::uint32_t t = 0; t < net.triangles.size(); ++t) {
        if (!net.counts(t)) continue;
        Corners c;
        double x = 0, y = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            const SurfacePoint& v = net.triangles.vertices()[net.triangles.triangles()[t][i]];
            c[i] = {v.x, v.y};
            x += v.x / 3.0;
            y += v.y / 3.0;
        }
        std::rotate(c.begin(), std::min_element(c.begin(), c.end()), c.end());
        if (const auto tile = tiles.tileAt(x, y)) all[*tile].insert(c);
    }
    return all;
}

/// Compares tile by tile; how many triangles are the surface.
void compareTiles(const SurfaceTiles& tiles, const PointCloud& cloud, std::size_t* count = nullptr)
{
    SurfaceNet whole{wholeOf(cloud, tiles.metric()), 0};
    const double reach = tiles.reach() / tiles.steps()[0];
    whole.squaredReach = reach * reach * tiles.metric().x;
    const auto expected = trianglesOf(tiles, whole);
    std::size_t all = 0;
    for (std::size_t t = 0; t < tiles.size(); ++t) {
        auto own = trianglesOf(tiles, tiles.net(t))[t];
        const auto at = expected.find(t);
        const std::size_t wanted = at == expected.end() ? 0 : at->second.size();
        QVERIFY2(at == expected.end() ? own.empty() : own == at->second,
                 qPrintable(QString("tile %1: %2 triangles, not %3").arg(t).arg(own.size()).arg(wanted)));
        all += wanted;
    }
    if (count) *count = all;
}

}  // namespace

class SurfaceTest : public QObject
{
    Q_OBJECT

private slots:
    void tilesAreTheWhole_data();
    void tilesAreTheWhole();
    void nothingToSee_data();
    void nothingToSee();
    void edits_data();
    void edits();
    void heightsAbove();
    void cancelled();
};

void SurfaceTest::tilesAreTheWhole_data()
{
    QTest::addColumn<QString>("kind");
    QTest::addColumn<double>("reach");
    for (const char* const kind : {"plain", "holes", "islands", "scanner", "grid", "degrees", "ign/mnx_bat.laz",
                                   "ign/bridge_0299_6802.laz", "isprs/samp31.laz"})
        QTest::newRow(kind) << kind << 0.0;
    QTest::newRow("holes, short reach") << "holes" << 6.0;
    QTest::newRow("islands, far reach") << "islands" << 400.0;
}

void SurfaceTest::tilesAreTheWhole()
{
    QFETCH(QString, kind);
    QFETCH(double, reach);
    const Cloud cloud = cloudOf(kind.toStdString());
    if (!cloud) QSKIP(qPrintable(kind + " is not here."));
    PointSet ground(cloud->size());
    PointIndex n = 0;
    for (PointIndex i = 0; i < cloud->size(); ++i)
        if (isGround(*cloud, i)) {
            ground.insert(i);
            ++n;
        }
    Progress progress;
    const SurfaceTiles tiles(*cloud, ground, reach, progress);
    QCOMPARE(tiles.pointCount(), n);
    for (std::size_t t = 0; t < tiles.size(); ++t)
        for (const std::uint32_t i : tiles.points(t)) {
            QVERIFY(tiles.box(t).holds(cloud->rawX()[i], cloud->rawY()[i]));
            QCOMPARE(tiles.tileAt(cloud->rawX()[i], cloud->rawY()[i]).value(), t);
        }
    std::size_t triangles = 0;
    compareTiles(tiles, *cloud, &triangles);
    QVERIFY(triangles > n);
    QVERIFY(tiles.size() > 4);
}

void SurfaceTest::nothingToSee_data()
{
    QTest::addColumn<QString>("kind");
    QTest::addColumn<int>("points");
    QTest::newRow("none") << "plain" << 0;
    QTest::newRow("one") << "plain" << 1;
    QTest::newRow("line") << "line" << 5000;
    QTest::newRow("one place") << "one place" << 5000;
}

void SurfaceTest::nothingToSee()
{
    QFETCH(QString, kind);
    QFETCH(int, points);
    const Cloud cloud = cloudOf(kind.toStdString(), PointIndex(points));
    Progress progress;
    Surface surface(cloud, {}, progress);
    for (const auto& tile : surface.view()->tiles) QVERIFY(tile->empty());
    const PointSet all(cloud->size());
    surface.update(&all, progress);
    surface.update(nullptr, progress);
    for (const auto& tile : surface.view()->tiles) QVERIFY(tile->empty());
}

void SurfaceTest::edits_data()
{
    QTest::addColumn<QString>("kind");
    for (const char* const kind : {"plain", "holes", "islands", "scanner", "degrees"}) QTest::newRow(kind) << kind;
}

void SurfaceTest::edits()
{
    QFETCH(QString, kind);
    const Cloud cloud = cloudOf(kind.toStdString());
    Progress progress;
    Surface surface(cloud, {}, progress);
    std::mt19937 random(4);
    std::size_t most = 0;
    for (int k = 0; k < 16; ++k) {
        // a brush about some point: to ground, from ground, or both; and points deleted
        const PointIndex middle = random() % cloud->size();
        const std::int64_t x = cloud->rawX()[middle], y = cloud->rawY()[middle];
        const std::int64_t radius = 100 + random() % 2000;
        const auto changed = std::make_shared<PointSet>(cloud->size());
        PointSet deleted = cloud->deleted() ? *cloud->deleted() : PointSet(cloud->size());
        for (PointIndex i = 0; i < cloud->size(); ++i) {
            const std::int64_t dx = cloud->rawX()[i] - x, dy = cloud->rawY()[i] - y;
            if (dx * dx + dy * dy > radius * radius) continue;
            changed->insert(i);
            if (k % 4 == 3)
                deleted.insert(i);
            else
                classesOf(*cloud)[i] = k % 4 == 0 ? 2 : k % 4 == 1 ? 6 : (random() % 2 != 0 ? 2 : 5);
        }
        if (k % 4 == 3) cloud->setDeleted(std::make_shared<PointSet>(deleted));
        most = std::max(most, surface.update(changed.get(), progress));
        if (k % 8 == 7) surface.withTiles([&](const SurfaceTiles& tiles) { compareTiles(tiles, *cloud); });
    }
    const auto view = surface.view();
    if (kind == "plain" || kind == "holes") QVERIFY2(most < view->tiles.size(), "Every edit touched every tile.");

    // Heights of the grids, too, are those of all points.
    surface.withTiles([&](const SurfaceTiles& tiles) {
        SurfaceNet whole{wholeOf(*cloud, tiles.metric()), 0};
        const double reach = tiles.reach() / tiles.steps()[0];
        whole.squaredReach = reach * reach * tiles.metric().x;
        QCOMPARE(view->tiles.size(), tiles.size());
        std::uint32_t near = 0;
        std::size_t some = 0;
        for (const auto& tile : view->tiles)
            for (int j = -1; j <= SurfaceTile::kCells + 1; ++j)
                for (int i = -1; i <= SurfaceTile::kCells + 1; ++i) {
                    const double cell = (tile->box.maxX - tile->box.minX) / SurfaceTile::kCells;
                    const auto z = whole.height(tile->box.minX + i * cell, tile->box.minY + j * cell, near);
                    const float own = tile->height(i, j);
                    QCOMPARE(std::isnan(own), !z.has_value());
                    if (!z) continue;
                    ++some;
                    QVERIFY(std::abs(double(own) + tile->base - *z) < 0.01);
                }
        QVERIFY(some > 1000);
    });
}

void SurfaceTest::heightsAbove()
{
    const Cloud cloud = cloudOf("holes");
    Progress progress;
    Surface surface(cloud, {}, progress);
    PointSet all(cloud->size());
    all.insert(PointRange{0, cloud->size()});
    std::vector<float> heights(cloud->size(), -1e9f);
    surface.withTiles([&](const SurfaceTiles& tiles) {
        forHeightsAbove(tiles, *cloud, all, progress,
                        [&](std::span<const std::uint32_t> points, std::span<const float> own) {
                            for (std::size_t k = 0; k < points.size(); ++k) heights[points[k]] = own[k];
                        });
        const Triangulation whole = wholeOf(*cloud, tiles.metric());
        SurfaceNet net{whole, tiles.reach() / 0.01 * tiles.reach() / 0.01};
        std::uint32_t near = 0;
        for (PointIndex i = 0; i < cloud->size(); ++i) {
            const auto z = net.height(cloud->rawX()[i], cloud->rawY()[i], near);
            QCOMPARE(std::isnan(heights[i]), !z.has_value());
            if (z) QVERIFY(std::abs(heights[i] - float((cloud->rawZ()[i] - *z) * 0.01)) < 1e-4f);
        }
        const PointSet close = pointsBetween(tiles, *cloud, all, -0.05, 0.1, progress);
        for (PointIndex i = 0; i < cloud->size(); ++i)
            QCOMPARE(close.contains(i), heights[i] >= -0.05 && double(heights[i]) <= 0.1);
    });
}

void SurfaceTest::cancelled()
{
    const Cloud cloud = cloudOf("plain");
    Progress progress;
    Surface surface(cloud, {}, progress);
    const auto before = surface.view();
    progress.cancel();
    QVERIFY_EXCEPTION_THROWN(Surface(cloud, {}, progress), Cancelled);
    QVERIFY_EXCEPTION_THROWN(surface.update(nullptr, progress), Cancelled);
    QCOMPARE(surface.view(), before);
    auto bare = std::make_shared<PointCloud>(PointIndex(0));
    for (const char* const axis : {"X", "Y", "Z"}) addScalar<std::int32_t>(*bare, axis);
    Progress other;
    QVERIFY_EXCEPTION_THROWN(Surface(bare, {}, other), Error);
}

QTEST_APPLESS_MAIN(SurfaceTest)
#include "SurfaceTest.moc"
