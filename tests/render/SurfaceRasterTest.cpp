// SPDX-License-Identifier: MIT
// The ground surface in the picture: against rays and triangles, and with the points in front of and behind it.
#include "core/task/Progress.h"
#include "render/surface/SurfaceRaster.h"
#include "tests/render/RenderedView.h"

#include <glm/geometric.hpp>

#include <QTest>

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
    void depthsAreThoseOfRays_data();
    void depthsAreThoseOfRays();
    void convergesToBruteForce_data();
    void convergesToBruteForce();
    void pointsBeforeAndBehind();
    void followsEdits();
    void offCostsNothing();
};

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
