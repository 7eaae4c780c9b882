// SPDX-License-Identifier: MIT
// Slots in the order of runs that lie together: nothing of a picture, a pick or an edit is another one by it.
#include "core/task/Progress.h"
#include "render/progressive/ProgressiveRenderer.h"
#include "render/scene/VisibleStretches.h"
#include "render/store/Arrangement.h"
#include "tests/render/RenderedView.h"
#include "tests/render/SyntheticCloud.h"

#include <QTest>

#include <algorithm>
#include <cstring>
#include <numeric>
#include <random>

using namespace punctum;
using namespace punctum::render;
using test::cameraFor;
using test::differing;
using test::filledStore;
using test::randomCamera;
using View = test::CpuView;

namespace
{

constexpr PointIndex kPoints = 300'000 + 21;

std::vector<std::uint32_t> shuffledRuns(PointIndex points, int bits, std::uint64_t seed)
{
    std::vector<std::uint32_t> runs((points + (PointIndex(1) << bits) - 1) >> bits);
    std::iota(runs.begin(), runs.end(), 0u);
    std::shuffle(runs.begin(), runs.end() - (points % (PointIndex(1) << bits) != 0 ? 1 : 0), std::mt19937_64(seed));
    return runs;
}

/// A patch whose file has it all over the place, by runs of 2^bits points.
std::shared_ptr<PointCloud> scatteredCloud(int bits)
{
    const PointIndex points = kPoints;
    const auto patch = test::makeCloud(points), cloud = test::makeCloud(points);
    const RunOrder order(shuffledRuns(points, bits, 8), bits, points);
    for (std::size_t c = 0; c < cloud->columns().size(); ++c) {
        const std::size_t bytes = cloud->columns()[c]->elementBytes();
        order.forRuns({0, points}, [&](PointRange from, PointIndex to) {
            std::memcpy(cloud->columns()[c]->data() + to * bytes, patch->columns()[c]->data() + from.first * bytes,
                        from.size() * bytes);
        });
    }
    return cloud;
}

std::unique_ptr<Arrangement> arrangementOf(const PointStore& store, double worth = 1)
{
    Progress progress;
    return store.arrangement(store.cloud().computeBounds(), progress, worth);
}

std::shared_ptr<PointStore> arrangedStore(const std::shared_ptr<PointCloud>& cloud)
{
    const auto store = filledStore(cloud);
    if (auto made = arrangementOf(*store)) store->arrange(std::move(*made));
    return store;
}

/// Whether each slot has what the cloud says.
bool slotsAreRight(const PointStore& store)
{
    const PointCloud& cloud = store.cloud();
    const auto& frame = store.frame();
    const Attribute* const classes = cloud.findAttribute("Classification");
    for (PointIndex i = 0; i < cloud.size(); ++i) {
        const Slot s = store.order().slotOf(i);
        const LocalPosition p = store.positions()[s];
        const auto index = std::uint32_t(i);
        std::uint32_t word = 0;
        store.encoder()->encode({&index, 1}, &word);
        if (store.order().indexOf(s) != i || p.x + frame.origin.x != cloud.rawX()[i] ||
            p.y + frame.origin.y != cloud.rawY()[i] || p.z + frame.origin.z != cloud.rawZ()[i] ||
            store.words()[s] != word || double(store.classes()[s]) != classes->number(i))
            return false;
    }
    return true;
}

}  // namespace

class ArrangementTest : public QObject
{
    Q_OBJECT

    /// Scattered by runs of so many points (log 2).
    static void runs()
    {
        QTest::addColumn<int>("bits");
        QTest::newRow("long runs") << RunOrder::kLongBits;
        QTest::newRow("points") << 0;
    }

private Q_SLOTS:
    void ordersAreBijections()
    {
        for (const PointIndex points : {1, 63, 64, 65, 1000, 65'537, 300'001})
            for (const int bits : {0, 3, RunOrder::kLongBits}) {
                SlotOrder order(OrderKind::Stratified, points);
                order.setRuns(std::make_shared<RunOrder>(shuffledRuns(points, bits, 3), bits, points));
                std::vector<bool> taken(order.slotCount(), false);
                std::vector<Slot> slotList(points);
                order.slotsOf({0, points}, slotList.data());
                for (PointIndex i = 0; i < points; ++i) {
                    const Slot slot = order.slotOf(i);
                    QVERIFY(slot < order.slotCount() && !taken[slot]);
                    taken[slot] = true;
                    QVERIFY(slotList[i] == slot && order.indexOf(slot) == i);
                    QVERIFY(order.indexAt(order.placeOf(i)) == i && order.placeAt(slot) == order.placeOf(i));
                }
                for (Slot s = 0; s < order.slotCount(); ++s)
                    if (!taken[s]) QVERIFY(order.indexOf(s) >= points);
                std::vector<Slot> some(points - points / 3);
                order.slotsOf({points / 3, points}, some.data());
                QVERIFY(std::equal(some.begin(), some.end(), slotList.begin() + std::ptrdiff_t(points / 3)));
            }
    }

    void scatteredRunsComeTogether_data() { runs(); }
    void scatteredRunsComeTogether()
    {
        QFETCH(int, bits);
        const auto cloud = scatteredCloud(bits);
        const auto store = filledStore(cloud);
        const auto made = arrangementOf(*store);
        QVERIFY(made != nullptr);
        QCOMPARE(made->runs->runPoints(), PointIndex(1) << bits);
        const RawBounds bounds = cloud->computeBounds();
        QVERIFY(shareOfTenth(*cloud->boxes(), bounds) > 0.9);
        QVERIFY2(shareOfTenth(*made->boxes, bounds) < 0.45,
                 qPrintable(QString::number(shareOfTenth(*made->boxes, bounds))));
        QVERIFY(made->boxes->bounds() == bounds);
        // where it does not pay, all stays as it is
        QVERIFY(arrangementOf(*store, double(kPoints)) == nullptr);
        QVERIFY(arrangementOf(*filledStore(cloud, OrderKind::Prime)) == nullptr);
        store->arrange(std::move(*arrangementOf(*store)));
        QVERIFY(store->arranged() && arrangementOf(*store) == nullptr);
        PointStore half(cloud, bounds);
        half.fill({0, 1000});
        QVERIFY(arrangementOf(half) == nullptr);
    }

    void slotsHoldWhatTheCloudSays_data() { runs(); }
    void slotsHoldWhatTheCloudSays()
    {
        QFETCH(int, bits);
        const auto cloud = scatteredCloud(bits);
        const auto store = arrangedStore(cloud);
        QVERIFY(store->arranged() && !store->stale());
        QVERIFY(slotsAreRight(*store));
        for (std::size_t k = 0; k < store->stretches(); ++k) {
            RawBounds expected;
            const PointIndex first = k * PointStore::kStretchPoints;
            for (PointIndex place = first; place < std::min(cloud->size(), first + PointStore::kStretchPoints);
                 ++place) {
                const PointIndex i = store->order().indexAt(place);
                expected.include(cloud->rawX()[i], cloud->rawY()[i], cloud->rawZ()[i]);
            }
            QVERIFY((*store->boxes())[k] == expected);
        }
    }

    void changesMeanwhileAreKept_data() { runs(); }
    /// Attributes, selections, previews, edits and hidden points before, while and after slots are arranged.
    void changesMeanwhileAreKept()
    {
        QFETCH(int, bits);
        const auto cloud = scatteredCloud(bits);
        const auto store = filledStore(cloud);
        PointSet hidden(cloud->size());
        auto selected = std::make_shared<PointSet>(cloud->size());
        for (PointIndex i = 0; i < cloud->size(); i += 3) hidden.insert(i);
        selected->insert(PointRange{500, 90'000});
        store->hide(&hidden);
        auto made = arrangementOf(*store);
        store->show(*cloud->findAttribute("Intensity"));
        store->setSelection(selected);
        const auto changed = test::reclassify(*cloud, 2, 9);
        store->markStale(changed.get());
        store->arrange(std::move(*made));
        QVERIFY(store->stale());
        std::vector<Slot> seen;
        for (PointIndex i = 100; i < 5000; ++i) seen.push_back(store->order().slotOf(i));
        QCOMPARE(store->refresh(seen), seen.size());
        while (store->stale()) store->refreshNext(50'000);
        QVERIFY(slotsAreRight(*store));
        for (PointIndex i = 0; i < cloud->size(); ++i)
            QCOMPARE(store->hidden()[store->order().slotOf(i)] != 0, hidden.contains(i));
        // and as ever afterwards
        store->show(*cloud->findAttribute("RGB"));
        while (store->stale()) store->refreshNext(70'000);
        QVERIFY(slotsAreRight(*store));
        const auto few = test::reclassify(*cloud, 6, 5);
        store->markStale(few.get());
        while (store->stale()) store->refreshNext(70'000);
        hidden.clear();
        hidden.insert(PointRange{7, 77'777});
        store->hide(&hidden);
        QVERIFY(slotsAreRight(*store));
        for (PointIndex i = 0; i < cloud->size(); ++i)
            QCOMPARE(store->hidden()[store->order().slotOf(i)] != 0, hidden.contains(i));
    }

    void nothingInSightIsMissed_data() { runs(); }
    /// A view that is full equals one that looks at every point; in the file's order, too, but for points of one
    /// depth, of which the smaller slot wins.
    void nothingInSightIsMissed()
    {
        QFETCH(int, bits);
        const auto cloud = scatteredCloud(bits);
        const auto store = arrangedStore(cloud), plain = filledStore(cloud);
        QVERIFY(store->arranged());
        std::mt19937_64 random(11);
        const Camera whole = cameraFor(*cloud, 320, 200);
        int covered = 0;
        for (int round = 0; round < 40; ++round) {
            const Camera camera = randomCamera(random, whole);
            DisplaySettings display;
            display.samples = round % 3 == 0 ? 4 : 1;
            if (round % 4 == 1) display.sizing = PointSizing::Density;
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
            if (view.renderer.pointsInSight() < cloud->size() / 2) ++covered;
            const auto hit = view.renderer.pick(160, 100, 50);
            if (hit) QVERIFY(cloud->world(hit->index) == hit->world);
            if (display.sizing == PointSizing::Density) continue;  // whose spacing is estimated by other points
            View others({plain}, camera, display);
            const int apart = differing(converged, others.bruteForce());
            QVERIFY2(apart < 20, qPrintable(QString::number(apart)));
            if (hit && apart == 0) {
                const auto same = others.renderer.pick(160, 100, 50);
                QVERIFY(same && same->world == hit->world);
            }
        }
        QVERIFY2(covered > 15, qPrintable(QString::number(covered)));
    }

    void viewsGoOnWithOtherSlots_data() { runs(); }
    /// While it is drawn, with a second view beside it that is not full.
    void viewsGoOnWithOtherSlots()
    {
        QFETCH(int, bits);
        const auto cloud = scatteredCloud(bits);
        const auto store = filledStore(cloud);
        const Camera camera = cameraFor(*cloud, 320, 200);
        View view({store}, camera, {}), beside({store}, camera, {});
        view.converge(1.0);
        beside.renderer.renderFrame(0.0005);
        view.renderer.arrange(*cloud, std::move(*arrangementOf(*store)));
        beside.renderer.storesChanged(ProgressiveRenderer::StoreChange::Slots);
        QVERIFY(!view.renderer.converged() && !view.renderer.pick(160, 100, 5));
        // The picture goes on: nothing is lost in the frame that draws one window of the new slots.
        for (View* const one : {&view, &beside}) {
            const Image before = one->renderer.image();
            const double covered = one->renderer.coveredShare();
            QVERIFY(covered > 0.1);
            one->renderer.setPointsAFrame(1);
            QVERIFY(!one->renderer.renderFrame(1.0).converged);
            one->renderer.setPointsAFrame(0);
            QVERIFY2(one->renderer.coveredShare() >= 0.999 * covered,
                     qPrintable(QString::number(one->renderer.coveredShare() / covered)));
            if (one == &view) QVERIFY(differing(one->renderer.image(), before) < 20);
        }
        view.converge();
        beside.converge();
        View reference({store}, camera, {});
        const Image expected = reference.bruteForce();
        QCOMPARE(differing(view.renderer.image(), expected), 0);
        QCOMPARE(differing(beside.renderer.image(), expected), 0);
    }

    /// With another cloud before it in the numbering, moved at once, and with one taken out before the next frame.
    void severalCloudsGoOn()
    {
        const auto cloud = scatteredCloud(RunOrder::kLongBits);
        for (const bool taken : {false, true}) {
            const auto other = filledStore(test::makeCloud(70'000)), store = filledStore(cloud);
            Camera camera = cameraFor(*cloud, 320, 200);
            View view({other, store}, camera, {}), plain({other, filledStore(cloud)}, camera, {});
            view.converge(1.0);
            plain.converge(1.0);
            view.renderer.arrange(*cloud, std::move(*arrangementOf(*store)));
            if (taken) view.renderer.removeCloud(other->cloud());
            camera.yaw += 0.01;
            for (View* const one : {&view, &plain}) {
                one->renderer.setCamera(camera);
                one->renderer.setPointsAFrame(1);
                one->renderer.renderFrame(1.0);
                one->renderer.setPointsAFrame(0);
            }
            if (!taken) QVERIFY(view.renderer.coveredShare() > 0.97 * plain.renderer.coveredShare());
            view.converge();
            View reference(taken ? std::vector{store} : std::vector{other, store}, camera, {});
            const Image expected = reference.bruteForce();
            QCOMPARE(differing(view.renderer.image(), expected), 0);
        }
    }
};

QTEST_APPLESS_MAIN(ArrangementTest)
#include "ArrangementTest.moc"
