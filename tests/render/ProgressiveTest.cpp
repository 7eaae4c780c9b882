// SPDX-License-Identifier: MIT
#include "core/cloud/Visibility.h"
#include "render/backends/Backends.h"
#include "render/progressive/ProgressiveRenderer.h"
#include "render/raster/cpu/CpuBackend.h"
#include "tests/render/RenderedView.h"

#include <QTest>

#include <algorithm>
#include <atomic>
#include <thread>

using namespace punctum;
using namespace punctum::render;
using test::cameraFor;
using test::differing;
using test::filledStore;
using test::kTinyBudget;
using View = test::CpuView;

class ProgressiveTest : public QObject
{
    Q_OBJECT

private Q_SLOTS:
    void agreesWithANaiveRasterizer_data();
    void agreesWithANaiveRasterizer();
    void convergedEqualsBruteForce_data();
    void convergedEqualsBruteForce();
    void movingKeepsThePicture();
    void holesAreClosedInMotionOnly();
    void fixedBudgetsDrawThatMany();
    void idleAfterConvergence();
    void convergesWhileLoading();
    void severalCloudsInOneView();
    void nearerCloudHidesTheOther();
    void movingKeepsPointsOfSeveralClouds();
    void picksWhatIsOnScreen();
    void partsMakeUpThePicture();
    void emptyCloudsAreNoTrouble();
};

void ProgressiveTest::agreesWithANaiveRasterizer_data()
{
    QTest::addColumn<int>("samples");
    QTest::addColumn<double>("size");
    QTest::addColumn<bool>("orthographic");
    for (const int samples : kSampleCounts)
        for (const double size : {1.0, 2.5})
            for (const bool orthographic : {false, true})
                QTest::addRow("%d samples, %g px%s", samples, size, orthographic ? ", orthographic" : "")
                    << samples << size << orthographic;
}

// Against a loop over all points in double precision that shares no code with the backend. Up to 0.2 % of the
// samples may differ: points within float rounding of a sample's edge, and depths equal to float.
void ProgressiveTest::agreesWithANaiveRasterizer()
{
    QFETCH(int, samples);
    QFETCH(double, size);
    QFETCH(bool, orthographic);
    const auto cloud = test::makeCloud(60'000);
    const auto store = filledStore(cloud);
    constexpr int w = 320, h = 200;
    Camera camera = cameraFor(*cloud, w, h);
    camera.orthographic = orthographic;
    DisplaySettings display;
    display.samples = samples;
    display.pointSize = size;
    View view({store}, camera, display);
    view.renderer.renderBruteForce();
    const auto cells = dynamic_cast<CpuBackend&>(view.renderer.backend()).cells();

    std::vector<double> depth(std::size_t(w * h * samples), 1e300);
    std::vector<PointId> id(depth.size(), kNoPoint);
    for (PointIndex i = 0; i < cloud->size(); ++i) {
        const glm::dvec3 p = camera.project(cloud->world(i), {w, h});
        if (p.z <= 0) continue;
        for (int y = int(p.y - size) - 1; y <= int(p.y + size) + 1; ++y)
            for (int x = int(p.x - size) - 1; x <= int(p.x + size) + 1; ++x) {
                if (x < 0 || y < 0 || x >= w || y >= h) continue;
                for (int s = 0; s < samples; ++s) {
                    const double sx = x + samplePlaces(samples)[s][0] / double(kSampleSteps);
                    const double sy = y + samplePlaces(samples)[s][1] / double(kSampleSteps);
                    // the square's left and top edges lie on the grid of samples
                    const double left = std::floor((p.x - size / 2) * 16) / 16;
                    const double top = std::floor((p.y - size / 2) * 16) / 16;
                    if (sx <= left || sx > left + size || sy <= top || sy > top + size) continue;
                    const auto at = std::size_t((y * w + x) * samples + s);
                    if (p.z < depth[at]) {
                        depth[at] = p.z;
                        id[at] = store->order().slotOf(i);
                    }
                }
            }
    }
    std::size_t different = 0, covered = 0;
    for (std::size_t k = 0; k < cells.size(); ++k) {
        different += PointId(cells[k]) != id[k];
        covered += id[k] != kNoPoint;
    }
    QVERIFY(covered > cells.size() / 10);
    QVERIFY2(different <= covered / 500,
             qPrintable(QString("%1 of %2 samples differ").arg(different).arg(covered)));
}

void ProgressiveTest::convergedEqualsBruteForce_data()
{
    QTest::addColumn<int>("samples");
    QTest::addColumn<double>("size");
    QTest::addColumn<bool>("orthographic");
    QTest::addColumn<int>("order");
    for (const int samples : {1, 4, 16})
        for (const double size : {1.0, 3.0})
            for (const bool orthographic : {false, true})
                for (const OrderKind order : {OrderKind::Prime, OrderKind::Stratified})
                    QTest::addRow("%d samples, %g px%s, %s", samples, size, orthographic ? ", orthographic" : "",
                                  order == OrderKind::Prime ? "prime" : "stratified")
                        << samples << size << orthographic << int(order);
}

void ProgressiveTest::convergedEqualsBruteForce()
{
    QFETCH(int, samples);
    QFETCH(double, size);
    QFETCH(bool, orthographic);
    QFETCH(int, order);
    const auto cloud = test::makeCloud(400'000);
    const auto store = filledStore(cloud, OrderKind(order));
    Camera camera = cameraFor(*cloud, 320, 200);
    camera.orthographic = orthographic;
    DisplaySettings display;
    display.samples = samples;
    display.pointSize = size;
    View view({store}, camera, display);
    // Frames in motion first, so that the converged image has reprojected points in it.
    for (int k = 0; k < 10; ++k) {
        camera.orbit(0.03, 0.01);
        view.renderer.setCamera(camera);
        view.renderer.renderFrame(kTinyBudget);
    }
    view.renderer.setPointsAFrame(60'000);
    QVERIFY(view.converge() > 1);
    const Image converged = view.renderer.image();
    View reference({store}, camera, display);
    QCOMPARE(differing(converged, reference.bruteForce()), 0);
    QVERIFY(view.renderer.coveredShare() > 0.1);
}

// Nearly all of a turned picture is there in the first frame after the turn, although only a few points were drawn.
void ProgressiveTest::movingKeepsThePicture()
{
    const auto cloud = test::makeCloud(2'000'000);
    const auto store = filledStore(cloud);
    Camera camera = cameraFor(*cloud, 320, 200);
    View view({store}, camera, {});
    view.converge(0.02);
    const double converged = view.renderer.coveredShare();
    camera.orbit(0.02, 0.0);
    view.renderer.setCamera(camera);
    const FrameReport frame = view.renderer.renderFrame(0.0);
    QVERIFY(frame.filled < cloud->size() / 10);
    QVERIFY(!frame.converged);
    QVERIFY2(view.renderer.coveredShare() > 0.9 * converged,
             qPrintable(QString::number(view.renderer.coveredShare() / converged)));
}

void ProgressiveTest::holesAreClosedInMotionOnly()
{
    const auto cloud = test::makeCloud(400'000);
    const auto store = filledStore(cloud);
    Camera camera = cameraFor(*cloud, 320, 200);
    DisplaySettings plain, filling;
    plain.backgroundTop = plain.backgroundBottom = filling.backgroundTop = filling.backgroundBottom = {0, 0, 0, 0};
    filling.fillHoles = true;
    View view({store}, camera, plain), filled({store}, camera, filling);
    view.converge();
    filled.converge();
    QCOMPARE(differing(view.renderer.image(), filled.renderer.image()), 0);  // none in a finished picture
    QCOMPARE(differing(filled.renderer.image(), filled.bruteForce()), 0);
    camera.orbit(0.1, 0.02);
    const auto empty = [](const Image& image) {
        return std::count_if(image.pixels.begin(), image.pixels.end(), [](const Rgba8& c) { return c.a == 0; });
    };
    for (View* v : {&view, &filled}) {
        v->renderer.setPointsAFrame(1);
        v->renderer.setCamera(camera);
        QVERIFY(!v->renderer.renderFrame(0.01).converged);
    }
    const auto before = empty(view.renderer.image()), after = empty(filled.renderer.image());
    QVERIFY2(after < before, qPrintable(QString("%1 and %2 empty pixels").arg(before).arg(after)));
    filled.converge();
    view.converge();
    QCOMPARE(differing(view.renderer.image(), filled.renderer.image()), 0);
}

void ProgressiveTest::fixedBudgetsDrawThatMany()
{
    const auto cloud = test::makeCloud(500'000);
    const auto store = filledStore(cloud);
    View view({store}, cameraFor(*cloud, 320, 200), {});
    const PointIndex window = store->order().windowSize();
    for (const PointIndex points : {PointIndex(50'000), PointIndex(120'000)}) {
        view.renderer.setPointsAFrame(points);
        Camera camera = view.renderer.camera();
        camera.orbit(0.1, 0);
        view.renderer.setCamera(camera);
        PointIndex drawn = 0;
        for (bool done = false; !done;) {
            const FrameReport frame = view.renderer.renderFrame(1e-6);
            done = frame.converged;
            drawn += frame.filled;
            // The last run before the end of the order, and the last of all, are shorter.
            QVERIFY(frame.filled <= points + 2 * window);
            QVERIFY(done || frame.filled >= points || drawn == store->slotCount());
        }
        QCOMPARE(drawn, PointIndex(store->slotCount()));
    }
}

void ProgressiveTest::idleAfterConvergence()
{
    const auto cloud = test::makeCloud(50'000);
    View view({filledStore(cloud)}, cameraFor(*cloud, 320, 200), {});
    view.converge();
    QVERIFY(view.renderer.converged());
    const FrameReport report = view.renderer.renderFrame(0.01);
    QCOMPARE(report.filled, PointIndex(0));
    QCOMPARE(report.seconds, 0.0);
    view.renderer.setCamera(view.renderer.camera());
    QVERIFY(view.renderer.converged());
}

void ProgressiveTest::convergesWhileLoading()
{
    const auto cloud = test::makeCloud(600'000);
    const RawBounds bounds = cloud->computeBounds();
    const auto store = std::make_shared<PointStore>(cloud, bounds);
    ProgressiveRenderer renderer(makeBackend(BackendKind::Cpu));
    renderer.setSize(320, 200);
    const Camera camera = cameraFor(*cloud, 320, 200);
    renderer.setCamera(camera);
    renderer.addCloud(store);
    QVERIFY(renderer.renderFrame(0.001).converged);  // nothing yet, and no endless loop
    std::atomic<bool> done = false;
    std::thread loader([&] {
        constexpr PointIndex kBatch = 10'000;
        for (PointIndex k = 0; k < 60; ++k) {
            const PointIndex first = k * 7 % 60 * kBatch;
            store->fill({first, first + kBatch});
            std::this_thread::sleep_for(std::chrono::microseconds(500));
        }
        done = true;
    });
    double covered = 0;
    bool switched = false;
    while (!done) {
        renderer.renderFrame(0.001);
        if (store->filled() > 200'000 && !switched) {
            DisplaySettings display;
            display.attribute = "Intensity";
            renderer.setDisplay(display);
            switched = true;
        }
        if (!done) covered = std::max(covered, renderer.coveredShare());
    }
    loader.join();
    QVERIFY(covered > 0.1);
    renderer.loadingEnded(*cloud, bounds);
    int frames = 0;
    while (!renderer.renderFrame(0.002).converged) QVERIFY(++frames < 10'000);
    DisplaySettings display;
    display.attribute = "Intensity";
    View reference({filledStore(cloud)}, camera, display);
    reference.converge();
    QCOMPARE(differing(renderer.image(), reference.bruteForce()), 0);
}

// Exactly the points that hiddenPoints() names are missing: of a converged picture that was turned meanwhile, on
// every backend; the rest fills the holes, and all come back.
// Hidden points have no part in the range: by class, filter and clip; what is cut off in one view alone has.
void ProgressiveTest::severalCloudsInOneView()
{
    const auto a = test::makeCloud(100'000);
    const auto b = test::makeCloud(150'000, {glm::dvec3(0.0005), glm::dvec3(150, 30, 4)});
    const auto storeA = filledStore(a), storeB = filledStore(b);
    Camera camera;
    WorldBounds bounds = a->coordinates().toWorld(a->computeBounds());
    bounds.include(b->coordinates().toWorld(b->computeBounds()));
    camera.fit(bounds, {320, 200});
    DisplaySettings display;
    display.attribute = "Z";
    View view({storeA, storeB}, camera, display);
    view.converge();
    const Image converged = view.renderer.image();
    View reference({storeA, storeB}, camera, display);
    QCOMPARE(differing(converged, reference.bruteForce()), 0);
    view.renderer.removeCloud(*a);
    view.converge();
    View alone({storeB}, camera, display);
    QCOMPARE(differing(view.renderer.image(), alone.bruteForce()), 0);
}

/// Depths of several clouds compare, whatever their extents, in perspective and seen in parallel.
void ProgressiveTest::nearerCloudHidesTheOther()
{
    const auto lower = test::makeCloud(100'000);
    const auto upper = test::makeCloud(100'000, {glm::dvec3(0.001), glm::dvec3(0, 0, 60)});
    upper->findAttribute("X")->columns[0]->values<std::int32_t>()[0] = 2'000'000;  // 2 km to the east
    const auto lowerStore = filledStore(lower), upperStore = filledStore(upper);
    const WorldBounds box = lower->coordinates().toWorld(lower->computeBounds());
    for (const bool orthographic : {false, true})
        for (const char* from : {"top", "bottom"}) {
            Camera camera;
            camera.orthographic = orthographic;
            camera.setView(from);
            camera.fit(box, {320, 200});
            camera.zoomTowards(camera.pivot, 3.0);
            View view({lowerStore, upperStore}, camera, {});
            view.converge();
            const std::size_t nearer = std::string_view(from) == "top" ? 1 : 0;
            int hits = 0;
            for (int y = 85; y < 115; y += 3)
                for (int x = 145; x < 175; x += 3)
                    if (const auto hit = view.renderer.pick(x, y)) {
                        QVERIFY2(hit->cloud == nearer, from);
                        ++hits;
                    }
            QVERIFY(hits > 50);
        }
}

/// While the view moves, points of one cloud hide those of another and give them free again: each is where it
/// belongs.
void ProgressiveTest::movingKeepsPointsOfSeveralClouds()
{
    const auto a = test::makeCloud(60'000);
    const auto b = test::makeCloud(60'000, {glm::dvec3(0.001), glm::dvec3(3, 2, 1)});
    for (const bool orthographic : {false, true}) {
        Camera camera = cameraFor(*a, 320, 200);
        camera.orthographic = orthographic;
        View view({filledStore(a), filledStore(b)}, camera, {});
        view.converge();
        int hits[2] = {0, 0};
        for (int frame = 0; frame < 12; ++frame) {
            camera.orbit(frame % 4 < 2 ? 0.1 : -0.1, 0.02);
            view.renderer.setCamera(camera);
            view.renderer.renderFrame(1e-9);
            for (int y = 1; y < 200; y += 3)
                for (int x = 1; x < 320; x += 3)
                    if (const auto hit = view.renderer.pick(x, y, 0)) {
                        const glm::dvec3 px = camera.project(hit->world, {320, 200});
                        QVERIFY2(std::abs(px.x - x - 0.5) <= 2 && std::abs(px.y - y - 0.5) <= 2,
                                 qPrintable(QStringLiteral("cloud %1, %2 and %3 px off, frame %4")
                                                .arg(hit->cloud)
                                                .arg(px.x - x)
                                                .arg(px.y - y)
                                                .arg(frame)));
                        ++hits[hit->cloud];
                    }
        }
        QVERIFY(hits[0] > 1000 && hits[1] > 1000);
    }
}

// Clouds that come up with attributes of their own show that of the legend; what lacks it does not spoil its range.
void ProgressiveTest::picksWhatIsOnScreen()
{
    const auto cloud = test::makeCloud(100'000);
    const auto store = filledStore(cloud);
    const Camera camera = cameraFor(*cloud, 320, 200);
    View view({store}, camera, {});
    view.converge();
    int hits = 0;
    for (int y = 5; y < 200; y += 13)
        for (int x = 5; x < 320; x += 17)
            if (const auto hit = view.renderer.pick(x, y, 3)) {
                const glm::dvec3 px = camera.project(hit->world, {320, 200});
                QVERIFY(std::abs(px.x - x - 0.5) <= 4 && std::abs(px.y - y - 0.5) <= 4);
                QCOMPARE(hit->world, cloud->world(hit->index));
                ++hits;
            }
    QVERIFY(hits > 50);
    QVERIFY(!view.renderer.pick(-100, -100));
}

void ProgressiveTest::emptyCloudsAreNoTrouble()
{
    const auto cloud = test::makeCloud(0);
    const auto store = std::make_shared<PointStore>(cloud, RawBounds{});
    View view({store}, {}, {});
    QVERIFY(view.converge() < 5);
    QVERIFY(!view.renderer.pick(10, 10));
    const auto one = test::makeCloud(1);
    View single({filledStore(one)}, cameraFor(*one, 320, 200), {});
    QVERIFY(single.converge() < 5);
    QVERIFY(single.renderer.coveredShare() > 0);
}

/// Tiles are the picture, but for pixels on whose edge a point lies: their origin shifts what float rounds.
void ProgressiveTest::partsMakeUpThePicture()
{
    const auto cloud = test::makeCloud(40'000);
    const auto store = filledStore(cloud);
    for (const bool orthographic : {false, true})
        for (const int samples : {1, 4}) {
            Camera camera = cameraFor(*cloud, 320, 200);
            camera.orthographic = orthographic;
            DisplaySettings display;
            display.samples = samples;
            display.pointSize = 2;
            View whole({store}, camera, display);
            const Image picture = whole.bruteForce();
            View tiles({store}, camera, display);
            tiles.renderer.setSize(128, 128);
            int unlike = 0, covered = 0;
            for (int y = 0; y < 200; y += 128)
                for (int x = 0; x < 320; x += 128) {
                    tiles.renderer.setPart(PicturePart{x, y, 320, 200});
                    const Image tile = tiles.bruteForce();
                    covered += int(tiles.renderer.coveredShare() * 128 * 128);
                    for (int r = 0; r < std::min(128, 200 - y); ++r)
                        for (int c = 0; c < std::min(128, 320 - x); ++c)
                            unlike += !(tile.at(c, r) == picture.at(x + c, y + r));
                }
            QVERIFY(covered > 5000);
            QVERIFY2(unlike <= 32, qPrintable(QString::number(unlike)));  // of 64,000
            tiles.renderer.setPart(std::nullopt);
            tiles.renderer.setSize(320, 200);
            QCOMPARE(differing(tiles.bruteForce(), picture), 0);
        }
}

QTEST_APPLESS_MAIN(ProgressiveTest)
#include "ProgressiveTest.moc"
