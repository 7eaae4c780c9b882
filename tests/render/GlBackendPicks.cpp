// SPDX-License-Identifier: MIT
// GlBackendChecks: what is at a px, how deep, and which points are seen at all.
#include "tests/render/GlBackendChecks.h"
#include "tests/render/GlPictures.h"

#include <QTest>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace punctum::test
{

void GlBackendChecks::picksWhatIsOnScreen()
{
    const auto cloud = cloudNamed("synthetic");
    const auto store = filledStore(cloud);
    for (const int samples : {1, 4}) {
        DisplaySettings display;
        display.samples = samples;
        View view(gl(), {store}, cameraFor(*cloud), display);
        View reference(cpu(), {store}, cameraFor(*cloud), display);
        view.bruteForce();
        reference.bruteForce();
        int hits = 0, same = 0;
        for (int y = 5; y < kHeight; y += 13)
            for (int x = 5; x < kWidth; x += 17) {
                const auto a = view.renderer.backend().pick(x, y, 3),
                           b = reference.renderer.backend().pick(x, y, 3);
                hits += bool(b);
                same += a && b && a->id == b->id && std::abs(a->depth - b->depth) < 1e-4f * b->depth;
            }
        QVERIFY(hits > 50);
        QVERIFY2(same >= hits * 98 / 100, qPrintable(QString("%1 of %2").arg(same).arg(hits)));
        std::vector<float> depths, expected;
        view.renderer.backend().depths(depths);
        reference.renderer.backend().depths(expected);
        QCOMPARE(depths.size(), expected.size());
        std::size_t unlike = 0;
        for (std::size_t k = 0; k < depths.size(); ++k)
            unlike += !(depths[k] == expected[k] || std::abs(depths[k] - expected[k]) < 1e-4f * expected[k]);
        QVERIFY2(unlike * 50 <= depths.size(), qPrintable(QString::number(unlike)));
        QVERIFY(!view.renderer.backend().pick(-100, -100, 3));
        QVERIFY(!view.renderer.backend().pick(kWidth + 50, 10, 3));
    }
}

void GlBackendChecks::listsEachVisiblePoint()
{
    const auto cloud = makeCloud(5000);  // few, so that squares are seen whole
    const auto store = filledStore(cloud);
    for (const int samples : {1, 4}) {
        DisplaySettings display;
        display.samples = samples;
        display.pointSize = 4;
        View view(gl(), {store}, cameraFor(*cloud), display);
        View reference(cpu(), {store}, cameraFor(*cloud), display);
        view.bruteForce();
        reference.bruteForce();
        std::vector<PointId> a, b, both;
        view.renderer.backend().visibleIds(a);
        reference.renderer.backend().visibleIds(b);
        const std::size_t listed = a.size();
        for (auto* ids : {&a, &b}) {
            std::sort(ids->begin(), ids->end());
            ids->erase(std::unique(ids->begin(), ids->end()), ids->end());
        }
        std::set_symmetric_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
        QVERIFY(b.size() > 1000);
        // A point shows in up to 25 px, of 4 samples each; it is named again only where its square is in pieces.
        QVERIFY2(listed <= a.size() * 5 / 4, qPrintable(QString("%1 of %2").arg(listed).arg(a.size())));
        QVERIFY2(both.size() <= b.size() / 100, qPrintable(QString("%1 of %2").arg(both.size()).arg(b.size())));
    }
}

// One millimetre tells two points apart at 10 km, near a coordinate origin far away, in both kinds of view.
void GlBackendChecks::depthsKeepTheirDigits()
{
    auto cloud = makeCloud(2, {glm::dvec3(0.001), glm::dvec3(4e6, 5e6, 0)});
    const auto x = cloud->columns()[0]->values<std::int32_t>(), y = cloud->columns()[1]->values<std::int32_t>(),
               z = cloud->columns()[2]->values<std::int32_t>();
    for (int k = 0; k < 2; ++k) x[std::size_t(k)] = 70'000, y[std::size_t(k)] = 80'000;
    for (const bool orthographic : {false, true})
        for (const std::size_t upper : {std::size_t(0), std::size_t(1)}) {
            z[upper] = 2;
            z[1 - upper] = 0;
            const auto store = filledStore(cloud);
            Camera camera;
            camera.setView("top");
            camera.orthographic = orthographic;
            camera.pivot = cloud->world(0) + glm::dvec3(1, 1, 0);  // off the seam between the middle pixels
            camera.eye = camera.pivot + glm::dvec3(0, 0, 1000);
            View view(gl(), {store}, camera, {});
            view.bruteForce();
            const auto hit = view.renderer.pick(kWidth / 2, kHeight / 2, 3);
            QVERIFY(hit);
            QCOMPARE(hit->index, PointIndex(upper));
            const auto raw = view.renderer.backend().pick(kWidth / 2, kHeight / 2, 3);
            if (!orthographic) QVERIFY(std::abs(double(raw->depth) - 1000) < 0.01);
        }
}

}  // namespace punctum::test
