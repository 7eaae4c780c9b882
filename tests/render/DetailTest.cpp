// SPDX-License-Identifier: MIT
// Of a cloud that lies beyond memory a picture asks for no more points than the screen can show, and says so; which
// they are depends on the view alone, and the picture is that of all of these.
#include "core/Memory.h"
#include "render/scene/ScreenDensity.h"
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

constexpr PointIndex kPoints = 1'500'000;
constexpr TargetSize kSize{320, 200, 1};

/// A store whose slots lie in files.
std::shared_ptr<PointStore> storeBeyond(const std::shared_ptr<PointCloud>& cloud, bool fill = true)
{
    setMemoryBudget(std::uint64_t(4) << 20);
    auto store = std::make_shared<PointStore>(cloud, cloud->computeBounds());
    setMemoryBudget(0);
    if (fill) store->fillAll();
    return store;
}

VisibleStretches stretchesOf(const PointStore& store, const Camera& camera)
{
    return {layerOf(store, camera), kSize, Detail::OfScreen};
}

Camera fartherBy(Camera camera, double times)
{
    camera.eye = camera.pivot + (camera.eye - camera.pivot) * times;
    return camera;
}

/// The picture of the points that are asked for, by a renderer that draws all but hidden ones.
Image pictureOf(const std::shared_ptr<PointCloud>& cloud, const VisibleStretches& asked, const Camera& camera)
{
    const auto store = filledStore(cloud);
    PointSet others(cloud->size());
    for (PointIndex i = 0; i < cloud->size(); ++i)
        if (!asked.draws(store->order().slotOf(i))) others.insert(i);
    View view({store}, camera, DisplaySettings());
    view.renderer.hide(*cloud, &others);
    return view.bruteForce();
}

double coveredOf(const Image& part, const Image& whole, const Rgba8& background)
{
    std::size_t covered = 0, all = 0;
    for (std::size_t k = 0; k < whole.pixels.size(); ++k) {
        if (whole.pixels[k] == background) continue;
        ++all;
        covered += part.pixels[k] == background ? 0 : 1;
    }
    return double(covered) / double(std::max<std::size_t>(1, all));
}

}  // namespace

class DetailTest : public QObject
{
    Q_OBJECT

    std::shared_ptr<PointCloud> m_cloud = test::makeCloud(kPoints);

private Q_SLOTS:
    void densityIsThatOfAllRectangles()
    {
        ScreenDensity density({320, 200, 1});
        // Two lie across each other in the right half, 40 points a px each; a third is beyond the picture.
        density.add({0, 0, 320, 208}, 40.0 * 320 * 208);
        density.add({160, 0, 320, 208}, 40.0 * 160 * 208);
        density.add({5000, 5000, 5100, 5100}, 0.0);
        density.finish(8.0);
        QCOMPARE(density.share({0, 0, 100, 100}), 8.0 / 40.0);
        QCOMPARE(density.share({200, 10, 300, 100}), 8.0 / 80.0);
        QCOMPARE(density.share({-900, 10, 900, 100}), (8.0 / 40.0 + 8.0 / 80.0) / 2);
    }

    void whatIsSmallKeepsItsPoints()
    {
        // 1,000 points each on a px of its own, four of them across the corner of cells: none is lost.
        ScreenDensity density({320, 200, 1});
        for (int k = 0; k < 4; ++k) density.add({15.5, 15.5, 16.5, 16.5}, 1000);
        density.add({100, 100, 101, 101}, 1000);
        density.finish(1.0);
        QCOMPARE(density.share({15.5, 15.5, 16.5, 16.5}), 4 * 256 / 4000.0);
        QCOMPARE(density.share({100, 100, 101, 101}), 256 / 1000.0);
        QCOMPARE(density.share({300, 180, 310, 190}), 1.0);
    }

    void allOfItInMemory()
    {
        const auto store = filledStore(m_cloud);
        QVERIFY(!store->beyondMemory());
        View view({store}, fartherBy(cameraFor(*m_cloud, 320, 200), 6), DisplaySettings());
        view.converge();
        QVERIFY(!view.renderer.renderFrame(0).partly);
        QCOMPARE(view.renderer.pointsInSight(), kPoints);
        QCOMPARE(differing(view.renderer.image(), view.bruteForce()), 0);
    }

    void windowsAreCountedAlike()
    {
        const auto store = storeBeyond(m_cloud);
        std::mt19937_64 random(3);
        const Camera whole = cameraFor(*m_cloud, 320, 200);
        int partly = 0;
        for (int round = 0; round < 30; ++round) {
            const VisibleStretches visible = stretchesOf(*store, fartherBy(randomCamera(random, whole), 4));
            if (!visible.partly()) continue;
            ++partly;
            const Slot window = store->order().windowSize(), count = store->slotCount();
            const Slot first = Slot(random() % (count / window)) * window;
            const Slot last = first + Slot(random() % ((count - first) / window + 1)) * window;
            std::vector<SlotRange> pieces;
            visible.pieces({first, last}, count, pieces);
            std::uint64_t inPieces = 0, asked = 0;
            for (const SlotRange& piece : pieces) {
                inPieces += piece.size();
                for (Slot slot = piece.first; slot < piece.last; ++slot) QVERIFY(visible.draws(slot));
            }
            for (Slot slot = first; slot < last; ++slot)
                asked += slot % window / store->stretchPlaces() < store->stretches() && visible.draws(slot) ? 1 : 0;
            QCOMPARE(inPieces, asked);
            QCOMPARE(visible.drawn({first, last}), asked);
            if (asked > 0) {
                const Slot end = visible.runOf(first, asked, count);
                QVERIFY(end <= last && visible.drawn({first, end}) == asked);
            }
        }
        QVERIFY2(partly > 10, qPrintable(QString::number(partly)));
    }

    void isThePictureOfWhatIsAskedFor()
    {
        const auto store = storeBeyond(m_cloud);
        QVERIFY(store->beyondMemory());
        std::mt19937_64 random(7);
        const Camera whole = cameraFor(*m_cloud, 320, 200);
        int partly = 0;
        for (int round = 0; round < 24; ++round) {
            const Camera camera = round == 0 ? whole : fartherBy(randomCamera(random, whole), 3);
            View view({store}, camera, DisplaySettings());
            view.converge();
            if (!view.renderer.renderFrame(0).partly) continue;
            ++partly;
            const VisibleStretches asked = stretchesOf(*store, camera);
            QVERIFY(asked.partly());
            QCOMPARE(differing(view.renderer.image(), pictureOf(m_cloud, asked, camera)), 0);
        }
        QVERIFY2(partly > 7, qPrintable(QString::number(partly)));
    }

    void coversWhatAllPointsCover()
    {
        const auto store = storeBeyond(m_cloud);
        for (const double times : {1.0, 2.0, 5.0}) {
            View view({store}, fartherBy(cameraFor(*m_cloud, 320, 200), times), DisplaySettings());
            DisplaySettings plain;
            plain.backgroundTop = plain.backgroundBottom = {1, 2, 3, 255};
            plain.eyeDome = 0;
            view.renderer.setDisplay(plain);
            view.converge();
            const Image part = view.renderer.image();
            const PointIndex asked = view.renderer.pointsInSight();
            const double covered = coveredOf(part, view.bruteForce(), plain.backgroundTop);
            const std::string told = std::to_string(times) + ": " + std::to_string(covered) + " of the pixels, " +
                                     std::to_string(asked) + " points";
            QVERIFY2(covered > 0.98, told.c_str());
            QVERIFY2(asked < kPoints / 2 || times < 2, told.c_str());
        }
    }

    /// Neither what was seen before, nor the time of a frame, is to be seen in the picture.
    void dependsOnTheViewAlone()
    {
        const auto store = storeBeyond(m_cloud);
        const Camera whole = cameraFor(*m_cloud, 320, 200), far = fartherBy(whole, 4), near = fartherBy(whole, 0.2);
        View once({store}, far, DisplaySettings());
        once.converge(1.0);
        View moved({store}, near, DisplaySettings());
        moved.converge();
        for (const Camera& camera : {whole, near, far}) {
            moved.renderer.setCamera(camera);
            moved.renderer.renderFrame(test::kTinyBudget);
        }
        moved.converge();
        QCOMPARE(differing(moved.renderer.image(), once.renderer.image()), 0);
        moved.renderer.setPointsAFrame(50'000);
        moved.renderer.setCamera(near);
        moved.converge();
        moved.renderer.setCamera(far);
        moved.converge();
        QCOMPARE(differing(moved.renderer.image(), once.renderer.image()), 0);
    }

    /// Few points, next to all there are, are drawn when they come in sight: what is looked at is soon full while
    /// the rest is still read.
    void fewNewPointsAreDrawnInSight()
    {
        const auto store = storeBeyond(m_cloud, false);
        store->setSlotsOfGrowing(kPoints / 16);
        const Camera whole = fartherBy(cameraFor(*m_cloud, 320, 200), 2);
        View view({}, whole, DisplaySettings());
        view.renderer.addCloud(store);
        store->fill({0, kPoints - 30'000});
        view.converge();
        QVERIFY(view.renderer.renderFrame(0).partly);
        QVERIFY(view.renderer.renderFrame(0).current);
        store->fill({kPoints - 30'000, kPoints - 20'000});  // less than a 64th
        QVERIFY(!view.renderer.renderFrame(0).current);
        QTest::qSleep(150);
        view.converge();
        QVERIFY(view.renderer.renderFrame(0).current);
        View other({}, whole, DisplaySettings());
        other.renderer.addCloud(store);
        other.converge();
        QCOMPARE(differing(view.renderer.image(), other.renderer.image()), 0);
        // out of sight nothing is drawn again
        Camera away = whole;
        away.eye.x += 1e7;
        away.pivot.x += 1e7;
        view.renderer.setCamera(away);
        view.converge();
        store->fill({kPoints - 20'000, kPoints - 10'000});
        QVERIFY(view.renderer.renderFrame(0).current);
    }

    /// How many of a stretch are hidden is not known, so all are looked at.
    void hiddenPointsTakeNothingFromOthers()
    {
        const auto store = storeBeyond(m_cloud), whole = filledStore(m_cloud);
        const Camera far = fartherBy(cameraFor(*m_cloud, 320, 200), 5);
        DisplaySettings display;
        display.classVisible.fill(false);
        display.classVisible[6] = true;
        View view({store}, far, display), other({whole}, far, display);
        view.converge();
        QVERIFY(!view.renderer.renderFrame(0).partly);
        QCOMPARE(differing(view.renderer.image(), other.bruteForce()), 0);
    }

    /// Of points ahead those are taken that a picture of the whole is drawn of, and they stay in it.
    void pointsAheadAreSeen()
    {
        const auto store = storeBeyond(m_cloud, false);
        store->setSlotsOfGrowing(kPoints / 64);
        QVERIFY(store->windowsOfGrowing() <= 16);
        for (PointIndex first = 0; first + 1024 < kPoints; first += 50'000) store->fillAhead({first, first + 1024});
        QVERIFY(store->filled() < 16 * 31);
        View view({}, cameraFor(*m_cloud, 320, 200), DisplaySettings());
        view.renderer.addCloud(store);
        const auto seen = [&] {
            view.converge();
            std::vector<bool> pieces(30);
            view.renderer.visiblePoints(*m_cloud).forEach([&](PointIndex i) { pieces[i / 50'000] = true; });
            return std::count(pieces.begin(), pieces.end(), true);
        };
        QVERIFY(view.converge() > 0 && view.renderer.renderFrame(0).partly);
        QCOMPARE(seen(), 30);
        store->fill({0, 200'000});
        QCOMPARE(seen(), 30);
    }

    /// While points arrive the picture comes on, rests in between, and is in the end that of a store filled at
    /// once.
    void comesOnWhileLoading()
    {
        const auto store = storeBeyond(m_cloud, false), whole = storeBeyond(m_cloud);
        const Camera far = fartherBy(cameraFor(*m_cloud, 320, 200), 2);
        View view({}, far, DisplaySettings()), other({whole}, far, DisplaySettings());
        other.converge();
        view.renderer.addCloud(store);
        double before = 0;
        for (PointIndex first = 0; first < kPoints; first += kPoints / 10) {
            store->fill({first, std::min(kPoints, first + kPoints / 10)});
            view.converge();
            const double covered = view.renderer.coveredShare();
            QVERIFY2(covered >= before && covered > 0, qPrintable(QString::number(covered)));
            before = covered;
        }
        view.renderer.loadingEnded(*m_cloud, m_cloud->computeBounds());
        view.converge();
        QVERIFY(view.renderer.renderFrame(0).partly);
        QCOMPARE(differing(view.renderer.image(), other.renderer.image()), 0);
    }
};

QTEST_APPLESS_MAIN(DetailTest)
#include "DetailTest.moc"
