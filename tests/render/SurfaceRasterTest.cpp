// SPDX-License-Identifier: MIT
// The ground surface in the picture: against rays and triangles, and with the points in front of and behind it.
#include "core/task/Progress.h"
#include "render/surface/SurfaceRaster.h"
#include "tests/render/RenderedView.h"

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include <QTest>

#include <algorithm>
#include <cmath>

using namespace punctum;
using namespace punctum::render;
using namespace punctum::test;

namespace
{

constexpr int kWidth = 320, kHeight = 200;

DisplaySettings surfaceOnly(SurfaceLook look)
{
    DisplaySettings display;
    display.attribute = "Classification";
    display.surface = look;
    display.classVisible.fill(false);
    return display;
}

/// Steep ground of 300 m x 300 m, whose points lie ever closer towards the middle: tiles are of many sizes.
std::shared_ptr<PointCloud> denserToTheMiddle()
{
    const auto cloud = makeCloud(120000);
    const auto axis = [&](const char* name) {
        return cloud->findAttribute(name)->columns[0]->values<std::int32_t>();
    };
    const auto x = axis("X"), y = axis("Y"), z = axis("Z");
    const auto classes = cloud->findAttribute("Classification")->columns[0]->values<std::uint8_t>();
    for (PointIndex i = 0; i < cloud->size(); ++i) {
        const auto unit = [&](std::uint64_t part) { return double(hash(3 * i + part) >> 40) / double(1 << 24); };
        const double size = 150.0 / (1.0 + 60.0 * unit(2));
        const double u = (2 * unit(0) - 1) * size, v = (2 * unit(1) - 1) * size;
        x[i] = std::int32_t(u * 1000);
        y[i] = std::int32_t(v * 1000);
        z[i] = std::int32_t(1000 * (3 * std::sin(u) + 2 * std::cos(1.3 * v) + unit(2)));
        classes[i] = 2;
    }
    return cloud;
}

/// Depth of the nearest hit of a ray with the cells of all tiles, each two triangles as SurfaceRaster has them; 0:
/// none.
double hit(const SurfaceView& view, const CoordinateScale& grid, const Camera& camera, double px, double py)
{
    const double focal = kHeight / 2.0 / std::tan(camera.fovY / 2);
    glm::dvec3 origin = camera.eye;
    glm::dvec3 ray = camera.forward() + camera.right() * ((px - kWidth / 2.0) / focal) -
                     camera.up() * ((py - kHeight / 2.0) / focal);
    if (camera.orthographic) {
        const double scale = camera.pivotDepth() / focal;
        origin += camera.right() * ((px - kWidth / 2.0) * scale) - camera.up() * ((py - kHeight / 2.0) * scale);
        ray = camera.forward();
    }
    double nearest = INFINITY;
    for (const auto& tile : view.tiles) {
        const double cell = (tile->box.maxX - tile->box.minX) / SurfaceTile::kCells;
        const auto node = [&](int i, int j) {
            return grid.toWorld(glm::dvec3(tile->box.minX + i * cell, tile->box.minY + j * cell,
                                           tile->base + double(tile->height(i, j))));
        };
        const auto test = [&](const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
            if (std::isnan(a.z + b.z + c.z)) return;
            const glm::dvec3 ab = b - a, ac = c - a, cross = glm::cross(ray, ac);  // Moeller and Trumbore 1997
            const double det = glm::dot(ab, cross);
            if (det == 0) return;
            const glm::dvec3 from = origin - a, other = glm::cross(from, ab);
            const double u = glm::dot(from, cross) / det, v = glm::dot(ray, other) / det;
            if (u < 0 || v < 0 || u + v > 1) return;
            const double t = glm::dot(ac, other) / det;
            if (t > 0 || camera.orthographic) nearest = std::min(nearest, t);
        };
        for (int j = 0; j < SurfaceTile::kCells; ++j)
            for (int i = 0; i < SurfaceTile::kCells; ++i) {
                const glm::dvec3 a = node(i, j), b = node(i + 1, j), c = node(i, j + 1), d = node(i + 1, j + 1);
                if (!std::isnan(a.z + d.z)) {
                    test(a, b, d);
                    test(a, d, c);
                } else {
                    test(a, b, c);
                    test(b, d, c);
                }
            }
    }
    return nearest;
}

}  // namespace

class SurfaceRasterTest : public QObject
{
    Q_OBJECT

private slots:
    void hasNoCracks_data();
    void hasNoCracks();
    void drawsAgainWhatChanged_data();
    void drawsAgainWhatChanged();
    void lessWasDrawn();
    void depthsAreThoseOfRays_data();
    void depthsAreThoseOfRays();
    void convergesToBruteForce_data();
    void convergesToBruteForce();
    void pointsBeforeAndBehind();
    void ownPointsGiveWay();
    void followsEdits();
    void offCostsNothing();

private:
    std::shared_ptr<PointStore> m_steep;  ///< for hasNoCracks()
    std::shared_ptr<const SurfaceView> m_steepView;
    std::int64_t m_changed = 0, m_drawn = 0, m_pixels = 0, m_inkChanged = 0;  ///< by drawsAgainWhatChanged()
};

void SurfaceRasterTest::hasNoCracks_data()
{
    QTest::addColumn<bool>("orthographic");
    QTest::addColumn<double>("pitch");
    QTest::addColumn<double>("distance");
    QTest::addColumn<double>("cellPx");
    for (const double cellPx : {0.0, SurfaceRaster::kFineCell, SurfaceRaster::kCoarseCell, 40.0})
        for (const double distance : {20.0, 45.0, 110.0})
            for (const double pitch : {-1.57, -1.05})
                for (const bool orthographic : {false, true})
                    QTest::addRow("cells of %g px, from %g m, at %g%s", cellPx, distance, pitch,
                                  orthographic ? ", orthographic" : "")
                        << orthographic << pitch << distance << cellPx;
}

/// Tiles of many sizes beside each other, drawn by cells of many sizes, fill every px of the picture.
void SurfaceRasterTest::hasNoCracks()
{
    QFETCH(bool, orthographic);
    QFETCH(double, pitch);
    QFETCH(double, distance);
    QFETCH(double, cellPx);
    if (!m_steepView) {
        Progress progress;
        m_steep = filledStore(denserToTheMiddle());
        m_steepView = Surface(denserToTheMiddle(), {}, progress).view();
    }
    Camera camera = cameraFor(m_steep->cloud(), kWidth, kHeight);
    camera.orthographic = orthographic;
    camera.pitch = pitch;
    camera.pivot = {3, -2, 0};
    camera.eye = camera.pivot - camera.forward() * distance;
    const double focal = kHeight / 2.0 / std::tan(camera.fovY / 2);
    const SurfaceLayer layer{m_steepView, makeProjection(camera, *m_steep, TargetSize{kWidth, kHeight, 1}),
                             m_steep->frame(), LayerClip{}, orthographic ? focal / camera.pivotDepth() : focal};
    SurfaceRaster raster;
    raster.draw(std::span(&layer, 1), TargetSize{kWidth, kHeight, 1}, cellPx, SurfaceLook::Gray);
    const auto cracks = std::count_if(raster.depths().begin(), raster.depths().end(),
                                      [](float depth) { return std::isinf(depth); });
    QCOMPARE(cracks, 0);
}

void SurfaceRasterTest::drawsAgainWhatChanged_data()
{
    QTest::addColumn<bool>("orthographic");
    QTest::addColumn<double>("pitch");
    QTest::addColumn<double>("distance");
    QTest::addColumn<double>("cellPx");
    for (const double cellPx : {SurfaceRaster::kFineCell, 40.0})
        for (const double distance : {45.0, 110.0})
            for (const bool orthographic : {false, true})
                QTest::addRow("cells of %g px, from %g m%s", cellPx, distance, orthographic ? ", orthographic" : "")
                    << orthographic << (cellPx < 3 ? -1.57 : -1.05) << distance << cellPx;
}

/// After edits of classes here and there, what is drawn of a part of the picture is what is drawn of all of it,
/// pixel by pixel, contours included.
void SurfaceRasterTest::drawsAgainWhatChanged()
{
    QFETCH(bool, orthographic);
    QFETCH(double, pitch);
    QFETCH(double, distance);
    QFETCH(double, cellPx);
    const auto cloud = denserToTheMiddle();
    const auto store = filledStore(cloud);
    Progress progress;
    Surface surface(cloud, {}, progress);
    Camera camera = cameraFor(*cloud, kWidth, kHeight);
    camera.orthographic = orthographic;
    camera.pitch = pitch;
    camera.pivot = {3, -2, 0};
    camera.eye = camera.pivot - camera.forward() * distance;
    const double focal = kHeight / 2.0 / std::tan(camera.fovY / 2);
    SurfaceLayer layer{surface.view(), makeProjection(camera, *store, TargetSize{kWidth, kHeight, 1}),
                       store->frame(), LayerClip{}, orthographic ? focal / camera.pivotDepth() : focal};
    layer.zScale = cloud->coordinates().scale.z;
    const SurfaceContours contours{1.0, 1.2};
    const auto classes = cloud->findAttribute("Classification")->columns[0]->values<std::uint8_t>();
    SurfaceRaster again;
    again.draw(std::span(&layer, 1), TargetSize{kWidth, kHeight, 1}, cellPx, SurfaceLook::Heights, contours);
    std::int64_t drawn = 0, changed = 0;
    constexpr int kEdits = 10;
    for (int edit = 0; edit < kEdits; ++edit) {
        // where tiles meet, and those with smaller cells keep to the others
        const RawRect& box = layer.view->tiles[hash(std::uint64_t(edit)) % layer.view->tiles.size()]->box;
        const glm::dvec3 middle = cloud->coordinates().toWorld(glm::dvec3(box.minX, box.minY, 0.0));
        const double radius = 0.2 * (edit + 1);
        PointSet points(cloud->size());
        for (PointIndex i = 0; i < cloud->size(); ++i) {
            if (glm::distance(glm::dvec2(cloud->world(i)), glm::dvec2(middle)) > radius) continue;
            points.insert(i);
            classes[i] = classes[i] == 2 ? 1 : 2;
        }
        (void)surface.update(&points, progress);
        layer.view = surface.view();
        const std::vector<Rgba8> before(again.colors().begin(), again.colors().end());
        const std::vector<std::uint8_t> inkBefore(again.ink().begin(), again.ink().end());
        again.draw(std::span(&layer, 1), TargetSize{kWidth, kHeight, 1}, cellPx, SurfaceLook::Heights, contours);
        SurfaceRaster whole;
        whole.draw(std::span(&layer, 1), TargetSize{kWidth, kHeight, 1}, cellPx, SurfaceLook::Heights, contours);
        int wrong = 0;
        for (std::size_t p = 0; p < whole.depths().size(); ++p) {
            const bool is = !std::isinf(whole.depths()[p]);
            wrong += int(again.depths()[p] != whole.depths()[p] || (is && again.colors()[p] != whole.colors()[p]));
            changed += std::int64_t(is && before[p] != whole.colors()[p]);
            wrong += int(again.ink()[p] != whole.ink()[p]);
            m_inkChanged += int(inkBefore[p] != whole.ink()[p]);
        }
        QCOMPARE(wrong, 0);
        if (!again.drawn().empty())
            drawn += std::int64_t(again.drawn().lastColumn - again.drawn().firstColumn) *
                     (again.drawn().lastRow - again.drawn().firstRow);
    }
    m_changed += changed;
    m_drawn += drawn;
    m_pixels += std::int64_t(kEdits) * kWidth * kHeight;
}

void SurfaceRasterTest::lessWasDrawn()
{
    if (m_pixels == 0) QSKIP("No edits were drawn.");
    QVERIFY(m_changed > 10000);
    QVERIFY(m_inkChanged > 1000);
    QVERIFY2(m_drawn < m_pixels / 2, qPrintable(QString("%1 of %2 px").arg(m_drawn).arg(m_pixels)));
}

void SurfaceRasterTest::depthsAreThoseOfRays_data()
{
    QTest::addColumn<bool>("orthographic");
    QTest::newRow("perspective") << false;
    QTest::newRow("orthographic") << true;
}

void SurfaceRasterTest::depthsAreThoseOfRays()
{
    QFETCH(bool, orthographic);
    const auto cloud = makeCloud(4000);
    const auto store = filledStore(cloud);
    Progress progress;
    const Surface surface(cloud, {}, progress);
    const auto view = surface.view();
    Camera camera = cameraFor(*cloud, kWidth, kHeight);
    camera.orthographic = orthographic;
    const double focal = kHeight / 2.0 / std::tan(camera.fovY / 2);
    const SurfaceLayer layer{view, makeProjection(camera, *store, TargetSize{kWidth, kHeight, 1}), store->frame(),
                             LayerClip{}, orthographic ? focal / camera.pivotDepth() : focal};
    SurfaceRaster raster;
    raster.draw(std::span(&layer, 1), TargetSize{kWidth, kHeight, 1}, 0.0, SurfaceLook::Gray);  // all nodes
    int seen = 0, wrong = 0, edge = 0;
    double lift = NAN;  // of depths seen in parallel
    for (int y = 0; y < kHeight; y += 5)
        for (int x = 0; x < kWidth; x += 5) {
            const double expected = hit(*view, cloud->coordinates(), camera, x + 0.5, y + 0.5);
            const float depth = raster.depths()[std::size_t(y) * kWidth + std::size_t(x)];
            if (std::isinf(expected) != std::isinf(depth)) {
                ++edge;
                continue;
            }
            if (std::isinf(expected)) continue;
            ++seen;
            if (orthographic && std::isnan(lift)) lift = double(depth) - expected;
            const double difference = std::abs(double(depth) - expected - (orthographic ? lift : 0.0));
            wrong += difference > 1e-3 * std::abs(expected);
        }
    QVERIFY(seen > 400);
    // a ray along a crest may take the one side or the other
    QVERIFY2(wrong <= seen / 100 && edge <= seen / 100,
             qPrintable(QStringLiteral("%1 wrong, %2 at edges, of %3").arg(wrong).arg(edge).arg(seen)));
}

void SurfaceRasterTest::convergesToBruteForce_data()
{
    QTest::addColumn<int>("samples");
    QTest::addColumn<bool>("orthographic");
    QTest::newRow("perspective") << 1 << false;
    QTest::newRow("4 samples, orthographic") << 4 << true;
}

void SurfaceRasterTest::convergesToBruteForce()
{
    QFETCH(int, samples);
    QFETCH(bool, orthographic);
    const auto cloud = makeCloud(60000);
    const auto store = filledStore(cloud);
    Progress progress;
    const Surface surface(cloud, {}, progress);
    DisplaySettings display;
    display.attribute = "Z";
    display.samples = samples;
    display.surface = SurfaceLook::Heights;
    display.contours.interval = 0.5;
    Camera camera = cameraFor(*cloud, kWidth, kHeight);
    camera.orthographic = orthographic;
    CpuView view({store}, camera, display);
    view.renderer.setSurface(*cloud, surface.view());
    view.converge();
    camera.orbit(0.3, 0.1);  // moving: drawn coarse, then fine
    view.renderer.setCamera(camera);
    QVERIFY(!view.renderer.renderFrame(kTinyBudget).converged);
    view.converge();
    const Image converged = view.renderer.image();
    QCOMPARE(differing(converged, view.bruteForce()), 0);
    CpuView fresh({store}, camera, display);
    fresh.renderer.setSurface(*cloud, surface.view());
    QCOMPARE(differing(converged, fresh.bruteForce()), 0);
}

void SurfaceRasterTest::pointsBeforeAndBehind()
{
    const auto cloud = makeCloud(60000);
    const auto store = filledStore(cloud);
    Progress progress;
    const Surface surface(cloud, {}, progress);
    const Camera above = cameraFor(*cloud, kWidth, kHeight);
    CpuView alone({store}, above, surfaceOnly(SurfaceLook::Gray));
    alone.renderer.setSurface(*cloud, surface.view());
    const Image ground = alone.bruteForce();
    DisplaySettings display = surfaceOnly(SurfaceLook::Gray);
    display.classVisible.fill(true);
    display.classVisible[2] = false;  // the ground's own points lie in the surface, not before or behind it
    const auto changed = [&](const Camera& camera, bool onTop) {
        DisplaySettings own = display;
        own.pointsOnTop = onTop;
        CpuView with({store}, camera, own);
        with.renderer.setSurface(*cloud, surface.view());
        CpuView without({store}, camera, surfaceOnly(SurfaceLook::Gray));
        without.renderer.setSurface(*cloud, surface.view());
        return differing(with.bruteForce(), without.bruteForce());
    };
    const int seen = changed(above, false);
    QVERIFY2(seen > 300, qPrintable(QString::number(seen)));  // what stands on it is seen
    // from below, the surface is in front of all but what lies below it
    Camera below = above;
    below.pitch = 0.9;
    below.eye = below.pivot - below.forward() * glm::length(above.eye - above.pivot);
    const int hidden = changed(below, false), onTop = changed(below, true);
    QVERIFY2(onTop > 2 * hidden, qPrintable(QStringLiteral("%1, on top %2").arg(hidden).arg(onTop)));
    QVERIFY(ground.width == kWidth);
}

/// Where the surface is, no point is seen that it is made of unless it is selected, and all others are as before.
void SurfaceRasterTest::ownPointsGiveWay()
{
    const auto cloud = makeCloud(60000);
    const auto store = filledStore(cloud);
    Progress progress;
    const auto surface = Surface(cloud, {}, progress).view();
    const Camera camera = cameraFor(*cloud, kWidth, kHeight);
    DisplaySettings display;
    display.attribute = "Classification";
    display.pointSize = 3;
    display.surface = SurfaceLook::Gray;
    const auto draw = [&](const DisplaySettings& look, const std::shared_ptr<const PointSet>& selected = nullptr) {
        CpuView view({store}, camera, look);
        view.renderer.setSurface(*cloud, surface);
        view.renderer.setSelection(*cloud, selected);
        view.converge();
        const Image converged = view.renderer.image();
        return differing(converged, view.bruteForce()) == 0 ? converged : Image{};
    };
    DisplaySettings nothing = display;
    nothing.classVisible.fill(false);
    const Image all = draw(display), relief = draw(nothing);
    display.surfaceReplaces[2] = true;
    const Image seen = draw(display);
    QVERIFY(!all.pixels.empty() && !relief.pixels.empty() && !seen.pixels.empty());
    nothing.surface = SurfaceLook::None;
    const Image empty = draw(nothing);
    int replaced = 0, walls = 0;
    for (std::size_t p = 0; p < all.pixels.size(); ++p) {
        const bool covered = relief.pixels[p] != empty.pixels[p];
        const bool ground = all.pixels[p] == display.palette[2];
        if (!ground || !covered) QVERIFY(seen.pixels[p] == all.pixels[p]);
        if (ground && covered) QVERIFY(seen.pixels[p] == relief.pixels[p]);
        replaced += ground && covered;
        walls += seen.pixels[p] == display.palette[6];
    }
    QVERIFY2(replaced > 10000 && walls > 300, qPrintable(QStringLiteral("%1, %2").arg(replaced).arg(walls)));

    const auto selected = std::make_shared<PointSet>(cloud->size());
    const Attribute& classes = *cloud->findAttribute("Classification");
    for (PointIndex i = 0; i < cloud->size() / 3; ++i)
        if (classes.number(i) == 2.0) selected->insert(i);
    const Image marked = draw(display, selected);
    QVERIFY(!marked.pixels.empty());
    int shown = 0;
    for (std::size_t p = 0; p < all.pixels.size(); ++p) {
        if (marked.pixels[p] == seen.pixels[p]) continue;
        QVERIFY(all.pixels[p] == display.palette[2]);
        ++shown;
    }
    QVERIFY2(shown > 1000 && shown < replaced, qPrintable(QStringLiteral("%1 of %2").arg(shown).arg(replaced)));
}

void SurfaceRasterTest::followsEdits()
{
    const auto cloud = makeCloud(60000);
    const auto store = filledStore(cloud);
    Progress progress;
    Surface surface(cloud, {}, progress);
    const Camera camera = cameraFor(*cloud, kWidth, kHeight);
    CpuView view({store}, camera, surfaceOnly(SurfaceLook::Gray));
    view.renderer.setSurface(*cloud, surface.view());
    view.converge();
    const Image before = view.renderer.image();
    // walls become ground
    const auto classes = cloud->findAttribute("Classification")->columns[0]->values<std::uint8_t>();
    PointSet changed(cloud->size());
    for (PointIndex i = 0; i < cloud->size(); ++i)
        if (classes[i] == 6) {
            classes[i] = 2;
            changed.insert(i);
        }
    surface.update(&changed, progress);
    view.renderer.setSurface(*cloud, surface.view());
    QVERIFY(!view.renderer.converged());
    view.converge();
    const Image after = view.renderer.image();
    QVERIFY(differing(before, after) > 100);
    QCOMPARE(differing(after, view.bruteForce()), 0);
}

void SurfaceRasterTest::offCostsNothing()
{
    const auto cloud = makeCloud(20000);
    const auto store = filledStore(cloud);
    Progress progress;
    const Surface surface(cloud, {}, progress);
    DisplaySettings display;
    display.attribute = "Z";
    const Camera camera = cameraFor(*cloud, kWidth, kHeight);
    CpuView plain({store}, camera, display), off({store}, camera, display);
    off.renderer.setSurface(*cloud, surface.view());
    QCOMPARE(differing(plain.bruteForce(), off.bruteForce()), 0);
    off.converge();
    QVERIFY(off.renderer.converged());
    off.renderer.setSurface(*cloud, nullptr);
    QVERIFY(off.renderer.converged());  // not a frame for what is not seen
}

QTEST_APPLESS_MAIN(SurfaceRasterTest)
#include "SurfaceRasterTest.moc"
