// SPDX-License-Identifier: MIT
// What is out of sight is left out by whole stretches of the file, and nothing that is in sight.
#include "render/camera/Projection.h"
#include "render/progressive/ProgressiveRenderer.h"
#include "render/scene/VisibleStretches.h"
#include "tests/render/RenderedView.h"

#include <QTest>

#include <algorithm>
#include <random>

using namespace punctum;
using namespace punctum::render;
using test::cameraFor;
using test::differing;
using test::filledStore;
using test::layerOf;
using test::randomCamera;
using View = test::CpuView;

namespace
{

constexpr PointIndex kPoints = 400'000;

}  // namespace

class StretchesTest : public QObject
{
    Q_OBJECT

private Q_SLOTS:
    void boxesHoldTheirPoints()
    {
        const auto cloud = test::makeCloud(kPoints + 77);
        const auto store = filledStore(cloud);
        QCOMPARE(store->stretches(),
                 std::size_t(kPoints + 77 + PointStore::kStretchPoints - 1) / PointStore::kStretchPoints);
        QCOMPARE(filledStore(cloud, OrderKind::Prime)->stretches(), std::size_t(0));
        for (std::size_t k = 0; k < store->stretches(); ++k) {
            LocalBox expected;
            const PointIndex first = k * PointStore::kStretchPoints;
            for (PointIndex i = first; i < std::min(cloud->size(), first + PointStore::kStretchPoints); ++i) {
                const LocalPosition& p = store->positions()[store->order().slotOf(i)];
                const glm::ivec3 at(p.x, p.y, p.z);
                expected.low = glm::min(expected.low, at);
                expected.high = glm::max(expected.high, at);
            }
            const LocalBox box = store->frame().toLocal((*store->boxes())[k]);
            QVERIFY(box.low == expected.low && box.high == expected.high);
        }
    }

    void piecesAreTheSlotsInSight()
    {
        const auto cloud = test::makeCloud(kPoints);
        const auto store = filledStore(cloud);
        std::mt19937_64 random(5);
        const Camera whole = cameraFor(*cloud, 320, 200);
        const VisibleStretches everything(layerOf(*store, whole), {320, 200, 1});
        QVERIFY(everything.all());
        QCOMPARE(everything.share(), 1.0);
        int some = 0;
        for (int round = 0; round < 40; ++round) {
            const VisibleStretches visible(layerOf(*store, randomCamera(random, whole)), {320, 200, 1});
            some += !visible.all() && visible.share() > 0 ? 1 : 0;
            const Slot slotCount = store->slotCount();
            const auto first = Slot(random() % slotCount);
            const SlotRange run{first, Slot(first + random() % (slotCount - first + 1))};
            std::vector<SlotRange> pieces;
            visible.pieces(run, 1000, pieces);
            std::size_t piece = 0;
            for (Slot slot = run.first; slot < run.last; ++slot) {
                while (piece < pieces.size() && slot >= pieces[piece].last) ++piece;
                const bool in = piece < pieces.size() && slot >= pieces[piece].first;
                const std::size_t stretch = slot % store->order().windowSize() / store->stretchPlaces();
                const bool bit =
                    stretch < store->stretches() &&
                    (visible.all() || std::binary_search(visible.list().begin(), visible.list().end(), stretch));
                if (stretch < store->stretches()) QCOMPARE(in, bit);
            }
            for (const SlotRange& p : pieces) QVERIFY(p.size() > 0 && p.size() <= 1000);
        }
        QVERIFY2(some > 20, qPrintable(QString::number(some)));
    }

    /// Against a renderer that looks at every point: cameras inside, far, turned away, with cuts, boxes, wide
    /// points.
    void nothingInSightIsMissed()
    {
        const auto cloud = test::makeCloud(kPoints);
        const auto store = filledStore(cloud);
        std::mt19937_64 random(11);
        const Camera whole = cameraFor(*cloud, 320, 200);
        int covered = 0;
        for (int round = 0; round < 60; ++round) {
            const Camera camera = randomCamera(random, whole);
            DisplaySettings display;
            display.samples = round % 3 == 0 ? 4 : 1;
            if (round % 4 == 1) display.sizing = PointSizing::Density;
            if (round % 4 == 2) {
                display.sizing = PointSizing::World;
                display.worldSize = 3;
            }
            display.pointSize = round % 5 == 0 ? 9 : 1;
            display.averaged = round % 6 == 0;
            if (round % 4 == 3) display.clip.box = WorldBounds{camera.pivot - 30.0, camera.pivot + 30.0};
            if (round % 3 == 1)
                display.cuts.push_back({camera.right(), glm::dot(camera.right(), camera.pivot) + 5});
            View view({store}, camera, display);
            view.converge(1.0);
            const Image converged = view.renderer.image();
            View reference({store}, camera, display);
            QCOMPARE(differing(converged, reference.bruteForce()), 0);
            covered += view.renderer.coveredShare() > 0.05 ? 1 : 0;
        }
        QVERIFY2(covered > 25, qPrintable(QString::number(covered)));
    }

    void littleIsInSightFromNear()
    {
        const auto cloud = test::makeCloud(kPoints);
        const auto store = filledStore(cloud);
        Camera camera = cameraFor(*cloud, 320, 200);
        camera.setView("top");
        camera.fit({{90, 90, -20}, {110, 110, 40}}, {320, 200});
        // scan lines all across: a tenth of the extent is a tenth of the lines, and what they share with others
        const VisibleStretches visible(layerOf(*store, camera), {320, 200, 1});
        QVERIFY2(visible.share() > 0 && visible.share() < 0.4, qPrintable(QString::number(visible.share())));
        Clip clip;
        clip.box = WorldBounds{{0, 100, -100}, {200, 101, 100}};
        const VisibleStretches cut(layerOf(*store, cameraFor(*cloud, 320, 200), clip), {320, 200, 1});
        QVERIFY2(cut.share() > 0 && cut.share() < 0.15, qPrintable(QString::number(cut.share())));
        camera.pitch = 1.5;  // to the sky
        camera.eye.z = 500;
        QCOMPARE(VisibleStretches(layerOf(*store, camera), {320, 200, 1}).share(), 0.0);
    }
};

QTEST_APPLESS_MAIN(StretchesTest)
#include "StretchesTest.moc"
