// SPDX-License-Identifier: MIT
#include "core/Error.h"
#include "render/camera/Camera.h"
#include "render/camera/CameraFile.h"
#include "render/camera/Projection.h"
#include "render/camera/Sight.h"
#include "tests/render/SyntheticCloud.h"

#include <glm/geometric.hpp>

#include <QTest>

#include <numbers>

using namespace punctum;
using namespace punctum::render;

namespace
{

const glm::dvec2 kSize(1280, 800);

/// The backends' arithmetic in float, as Backend.h defines it.
glm::dvec3 projectLocal(const LayerProjection& p, const LocalPosition& l)
{
    const glm::vec3 q(glm::ivec3(l.x, l.y, l.z) - p.reference);
    const auto row = [&](const glm::vec4& r) { return r.x * q.x + (r.y * q.y + (r.z * q.z + r.w)); };
    const float depth = row(p.rowD), w = p.perspective ? depth : 1.0f;
    return {row(p.rowX) / w, row(p.rowY) / w, depth};
}

}  // namespace

class CameraTest : public QObject
{
    Q_OBJECT

private Q_SLOTS:
    void standardViews();
    void orbitKeepsThePivotInPlace();
    void zoomKeepsTheTargetInPlace();
    void panFollowsTheMouse();
    void fitShowsTheWholeBox();
    void oneScaleInParallel();
    void textOfACamera();
    void tellsHowLargeABoxIsSeen();
    void whatTheClipLeavesIsInSight();
    void degreesHaveTheirTrueShape();
    void farCoordinatesDrawWithoutJitter_data();
    void farCoordinatesDrawWithoutJitter();
};

void CameraTest::standardViews()
{
    Camera c;
    QVERIFY(c.setView("top"));
    QVERIFY(glm::length(c.forward() - glm::dvec3(0, 0, -1)) < 1e-12);
    QVERIFY(glm::length(c.up() - glm::dvec3(0, 1, 0)) < 1e-12);
    QVERIFY(c.setView("front"));
    QVERIFY(glm::length(c.forward() - glm::dvec3(0, 1, 0)) < 1e-12);
    QVERIFY(c.setView("left"));
    QVERIFY(glm::length(c.forward() - glm::dvec3(1, 0, 0)) < 1e-12);
    QVERIFY(!c.setView("sideways"));
}

void CameraTest::orbitKeepsThePivotInPlace()
{
    Camera c;
    c.fit({glm::dvec3(0), glm::dvec3(100, 50, 20)}, kSize);
    c.pivot = {90, 10, 5};
    const glm::dvec3 before = c.project(c.pivot, kSize);
    c.orbit(0.7, -0.3);
    const glm::dvec3 after = c.project(c.pivot, kSize);
    QVERIFY(glm::length(before - after) < 1e-6);
    c.orbit(0, 100);
    QCOMPARE(c.pitch, 3.14159265358979323846 / 2);
}

void CameraTest::zoomKeepsTheTargetInPlace()
{
    Camera c;
    c.fit({glm::dvec3(0), glm::dvec3(100, 50, 20)}, kSize);
    const glm::dvec3 target(80, 40, 10);
    const glm::dvec3 before = c.project(target, kSize);
    c.zoomTowards(target, 0.25);
    const glm::dvec3 after = c.project(target, kSize);
    QVERIFY(std::abs(before.x - after.x) < 1e-6 && std::abs(before.y - after.y) < 1e-6);
    QVERIFY(std::abs(after.z - before.z * 0.25) < 1e-6);
}

void CameraTest::panFollowsTheMouse()
{
    Camera c;
    c.fit({glm::dvec3(0), glm::dvec3(100, 50, 20)}, kSize);
    const glm::dvec3 point = c.pivot;
    const glm::dvec3 before = c.project(point, kSize);
    c.pan({30, -12}, kSize.y);
    const glm::dvec3 after = c.project(point, kSize);
    QVERIFY(std::abs(after.x - before.x - 30) < 1e-6);
    QVERIFY(std::abs(after.y - before.y + 12) < 1e-6);
}

void CameraTest::fitShowsTheWholeBox()
{
    const WorldBounds box{glm::dvec3(500000, 4000000, 100), glm::dvec3(501000, 4000300, 180)};
    for (const bool orthographic : {false, true})
        for (const char* view : {"top", "front", "left", "iso"}) {
            Camera c;
            c.orthographic = orthographic;
            c.setView(view);
            c.fit(box, kSize);
            double widest = 0;
            for (int k = 0; k < 8; ++k) {
                const glm::dvec3 corner(k & 1 ? box.max.x : box.min.x, k & 2 ? box.max.y : box.min.y,
                                        k & 4 ? box.max.z : box.min.z);
                const glm::dvec3 px = c.project(corner, kSize);
                QVERIFY(px.x >= 0 && px.x <= kSize.x && px.y >= 0 && px.y <= kSize.y);
                widest = std::max({widest, std::abs(px.x - 640) / 640, std::abs(px.y - 400) / 400});
            }
            QVERIFY2(widest > 0.9, view);
        }
}

/// Seen in parallel, px are the same length everywhere, which is that at the pivot's depth in perspective.
void CameraTest::oneScaleInParallel()
{
    const WorldBounds box{glm::dvec3(500000, 4000000, 100), glm::dvec3(501000, 4000300, 180)};
    for (const char* view : {"top", "front", "left", "iso"}) {
        Camera c;
        c.setView(view);
        c.fit(box, kSize);
        QCOMPARE(seenInParallel(view), std::string_view(view) != "iso");
        Camera parallel = c;
        parallel.orthographic = true;
        QCOMPARE(parallel.unitsPerPixel(kSize.y), c.unitsPerPixel(kSize.y));
        const glm::dvec3 beside = c.unproject({300, 200}, kSize);
        QVERIFY(glm::length(c.project(beside, kSize) - parallel.project(beside, kSize)) < 1e-6);
        for (const double depth : {-5000.0, -1.0, 0.0, 70.0, 1e5}) {
            const glm::dvec3 from = parallel.pivot + parallel.forward() * depth;
            const glm::dvec3 to = from + (parallel.right() * 3.0 + parallel.up() * 4.0);
            const double px = glm::length(glm::dvec2(parallel.project(to, kSize) - parallel.project(from, kSize)));
            QVERIFY(std::abs(px * parallel.unitsPerPixel(kSize.y) - 5.0) < 1e-6);
            QVERIFY(parallel.project(to, kSize).z >= parallel.nearDepth());
        }
        QVERIFY(c.nearDepth() > 0 && c.nearDepth() < c.pivotDepth());
    }
}

void CameraTest::textOfACamera()
{
    Camera c;
    c.orthographic = true;
    c.setView("top");
    c.stretch = {111'000, 85'000, 1};
    c.fit({{-94.5, 44.99, 100}, {-94.49, 45.01, 150}}, kSize);
    Camera fitted;
    fitted.stretch = c.stretch;
    const Camera back = readCamera(cameraText(c), fitted, {}, kSize);
    QVERIFY(back.orthographic && glm::length(back.eye - c.eye) < 1e-9 && glm::length(back.pivot - c.pivot) < 1e-9);
    QVERIFY(std::abs(back.yaw - c.yaw) < 1e-12 && std::abs(back.pitch - c.pitch) < 1e-12);
    QCOMPARE(back.stretch, c.stretch);
    for (const char* text :
         {"", "[]", "{\"eye\": 1}", "{\"pitch\": 91}", "{\"orthographic\": 1}", "{\"eyes\": [1,2,3]}"})
        QVERIFY_THROWS_EXCEPTION(Error, readCamera(text, fitted, {}, kSize));
}

// Lengths of a degree on WGS 84 as tables of geodesy have them, and what the camera makes of them.
void CameraTest::tellsHowLargeABoxIsSeen()
{
    const glm::dvec2 size(400, 300);
    const WorldBounds box{{100, 200, 0}, {110, 210, 5}};
    for (const bool orthographic : {false, true}) {
        Camera camera;
        camera.orthographic = orthographic;
        camera.fit(box, size);
        QVERIFY(camera.seenSize(box, size) > 250 && camera.seenSize(box, size) <= 400);
        QCOMPARE(camera.seenSize({}, size), 0.0);
        const Camera fitted = camera;
        camera.eye += camera.right() * 1000.0;
        camera.pivot += camera.right() * 1000.0;
        QCOMPARE(camera.seenSize(box, size), 0.0);
        camera = fitted;
        camera.zoomTowards(camera.pivot, 0.01);  // close by
        QCOMPARE(camera.seenSize(box, size), 400.0);
        camera = fitted;
        camera.zoomTowards(camera.pivot, 1000.0);
        QVERIFY(camera.seenSize(box, size) > 0 && camera.seenSize(box, size) < 1);
    }
    Camera away;
    away.fit(box, size);
    away.yaw += 3.14159;
    away.pitch = -away.pitch;
    QCOMPARE(away.seenSize(box, size), 0.0);  // behind the eye
    // far to the side, and as deep as before the eye and behind it
    Camera near;
    QVERIFY(near.setView("front"));
    near.fit(box, size);
    const double depth = near.eye.y;
    QCOMPARE(near.seenSize({{1e5, depth - 50, 0}, {1e5 + 100, depth + 50, 5}}, size), 0.0);
    QCOMPARE(near.seenSize({{100, depth - 50, 0}, {110, depth + 50, 5}}, size), 400.0);
}

void CameraTest::whatTheClipLeavesIsInSight()
{
    Camera c;
    c.setView("top");
    c.orthographic = true;
    const glm::dvec2 size(400, 400);
    c.fit({{0, 0, 0}, {100, 100, 10}}, size);
    const WorldBounds left{{0, 0, 0}, {40, 100, 10}}, right{{60, 0, 0}, {100, 100, 10}},
        beyond{{500, 0, 0}, {600, 100, 10}};
    const auto all = sightOf(c, size, {});
    QCOMPARE(all(left), c.seenSize(left, size));
    QVERIFY(all(left) > 0 && all(right) > 0 && all(beyond) == 0);
    const auto boxed = sightOf(c, size, {WorldBounds{{30, 20, -100}, {50, 30, 100}}, {}});
    QVERIFY(boxed(left) > 0 && boxed(left) < all(left) / 2);
    QCOMPARE(boxed(right), 0.0);
    const auto cut = sightOf(c, size, {std::nullopt, {{{1, 0, 0}, 50}}});
    QCOMPARE(cut(left), 0.0);
    QVERIFY(cut(right) > 0);
}

void CameraTest::degreesHaveTheirTrueShape()
{
    const WorldBounds box{{-94.5, 44.99, 100}, {-94.49, 45.01, 150}};
    // 50 m up are as long on the screen as 50 m to the north, before and after an orbit, a zoom and a shift.
    Camera camera;
    camera.orthographic = true;
    camera.stretch = trueLengths(CoordinateUnits::degreesAndMeters(), box).stretch;
    camera.fit(box, kSize);
    for (int k = 0; k < 3; ++k) {
        camera.orbit(0.4, 0.1);
        camera.zoomTowards({-94.495, 45.0, 120}, 0.7);
        camera.pan({30, -20}, kSize.y);
        const auto lookAt = [&, depth = camera.pivotDepth()](double pitch) {
            camera.pitch = pitch;
            camera.eye = camera.pivot - camera.forward() * depth / camera.stretch;
        };
        lookAt(0);
        const glm::dvec3 at = camera.pivot;
        const glm::dvec3 here = camera.project(at, kSize), up = camera.project(at + glm::dvec3(0, 0, 50), kSize);
        lookAt(-std::numbers::pi / 2);
        const glm::dvec3 there = camera.project(at, kSize),
                         north = camera.project(at + glm::dvec3(0, 50 / camera.stretch.y, 0), kSize);
        const double a = glm::length(glm::dvec2(up - here)), b = glm::length(glm::dvec2(north - there));
        QVERIFY2(std::abs(a / b - 1) < 1e-3, qPrintable(QString("%1 and %2 px").arg(a).arg(b)));
        const glm::dvec3 back = camera.unproject(glm::dvec2(there), kSize);
        QVERIFY(glm::length((back - at) * camera.stretch) < 1e-6 * camera.pivotDepth());
    }
}

void CameraTest::farCoordinatesDrawWithoutJitter_data()
{
    QTest::addColumn<double>("offset");
    QTest::addColumn<double>("scale");
    QTest::newRow("near the origin, millimetres") << 0.0 << 0.001;
    QTest::newRow("5,000 km away, millimetres") << 5'000'000.0 << 0.001;
    QTest::newRow("degrees, 1e-9") << 11.5 << 1e-9;
    QTest::newRow("100 km wide") << 400'000.0 << 0.5;
}

// What float arithmetic says differs from double by less than a hundredth of a pixel, from afar and when zoomed in
// until a raw unit is ten pixels wide.
void CameraTest::farCoordinatesDrawWithoutJitter()
{
    QFETCH(double, offset);
    QFETCH(double, scale);
    const CoordinateScale grid{glm::dvec3(scale), glm::dvec3(offset, offset, 0)};
    const auto cloud = test::makeCloud(20'000, grid);
    PointStore store(cloud, cloud->computeBounds());
    store.fillAll();
    const TargetSize size{1280, 800, 1};
    for (const bool orthographic : {false, true})
        for (const bool close : {false, true}) {
            Camera camera;
            camera.orthographic = orthographic;
            camera.fit(grid.toWorld(cloud->computeBounds()), kSize);
            if (close) {
                const glm::dvec3 target = cloud->world(7777);
                camera.pivot = target;
                camera.eye = target - camera.forward() * (scale * 100);
            }
            const LayerProjection p = makeProjection(camera, store, size);
            int checked = 0;
            for (PointIndex i = 0; i < cloud->size(); ++i) {
                const glm::dvec3 exact = camera.project(cloud->world(i), kSize);
                if (exact.z <= 0 || exact.x < 0 || exact.y < 0 || exact.x > 1280 || exact.y > 800) continue;
                const glm::dvec3 drawn = projectLocal(p, store.positions()[store.order().slotOf(i)]);
                QVERIFY(std::abs(drawn.x - exact.x) < 0.01 && std::abs(drawn.y - exact.y) < 0.01);
                ++checked;
            }
            QVERIFY(checked > 0);
        }
}

QTEST_APPLESS_MAIN(CameraTest)
#include "CameraTest.moc"
