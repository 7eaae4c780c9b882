// SPDX-License-Identifier: MIT
// GlBackendChecks: colors, and how they follow what changes.
#include "tests/render/GlBackendChecks.h"
#include "tests/render/GlPictures.h"

#include <QTest>

#include <algorithm>
#include <string_view>

namespace punctum::test
{

void GlBackendChecks::attributeSwitchShowsAtOnce()
{
    // 11 blocks of words: more than one frame brings over, so that the visible points' go first.
    const auto cloud = makeCloud(700'000);
    const auto store = filledStore(cloud);
    const GlLimits limits{.blocksAFrame = 3};
    const Camera camera = cameraFor(*cloud);
    DisplaySettings display;
    display.samples = 4;
    View view(gl(limits), {store}, camera, display);
    view.bruteForce();
    for (const char* name : {"Classification", "GpsTime", "RGB"}) {
        display.attribute = name;
        view.renderer.setDisplay(display);
        view.renderer.renderFrame(0.0);
        const Image first = view.renderer.image();
        View reference(cpu(), {store}, camera, display);
        const Image expected = reference.bruteForce();
        QVERIFY2(share(first, expected, reference.renderer.coveredShare()) <= 0.01, name);
    }
}

// After a switch every point has its new word, those too that nobody saw when it happened.
void GlBackendChecks::wordsOfAllPointsFollow()
{
    const auto cloud = makeCloud(700'000);
    const auto store = filledStore(cloud);
    Camera camera = cameraFor(*cloud);
    const Camera home = camera;
    DisplaySettings display;
    View view(gl({.blocksAFrame = 1}), {store}, home, display);
    view.bruteForce();
    camera.zoomTowards(camera.pivot, 0.01);  // next to nothing is visible
    view.renderer.setCamera(camera);
    view.renderer.renderBruteForce();
    display.attribute = "Intensity";
    view.renderer.setDisplay(display);
    for (int k = 0; k < 200 && store->stale(); ++k) view.renderer.renderFrame(0.01);
    QVERIFY(!store->stale());
    view.renderer.setCamera(home);
    view.converge();
    const Image image = view.renderer.image();
    View reference(cpu(), {store}, home, display);
    const Image expected = reference.bruteForce();
    QVERIFY(share(image, expected, reference.renderer.coveredShare()) <= 0.01);
}

void GlBackendChecks::editsShowInTheNextFrame()
{
    const auto cloud = makeCloud(300'000);
    const auto store = filledStore(cloud);
    DisplaySettings display;
    display.attribute = "Classification";
    View view(gl(), {store}, cameraFor(*cloud), display);
    view.converge();
    const Image before = view.renderer.image();
    const auto setAll = [&](std::uint8_t from, std::uint8_t to) {
        const auto points = reclassify(*cloud, from, to);
        view.renderer.valuesChanged(*cloud, {ChangeNotice::Kind::Values, {"Classification"}, points});
        view.renderer.renderFrame(0.0);
    };
    setAll(2, 11);
    const auto count = [&](std::size_t code) {
        const auto& pixels = view.renderer.image().pixels;
        return std::count(pixels.begin(), pixels.end(), display.palette[code]);
    };
    QCOMPARE(count(2), 0);
    QVERIFY(count(11) > 1000);
    setAll(11, 2);
    QCOMPARE(differing(view.renderer.image(), before), 0);
}

// Every kind of word through both resolves: the same ids get the same colors, so that only a scalar on the rim of
// two entries of the color map may differ, by that one entry.
void GlBackendChecks::colorsAreThoseOfTheCpuBackend()
{
    const auto cloud = makeCloud(1000);
    // One point to each of 1000 px: nobody is hidden, and no edge matters.
    const auto x = cloud->columns()[0]->values<std::int32_t>(), y = cloud->columns()[1]->values<std::int32_t>(),
               z = cloud->columns()[2]->values<std::int32_t>();
    for (std::size_t i = 0; i < 1000; ++i) {
        x[i] = std::int32_t(i % 40) * 1000;
        y[i] = std::int32_t(i / 40) * 1000;
        z[i] = 5;
    }
    const auto classes = cloud->findAttribute("Classification")->columns[0]->values<std::uint8_t>();
    for (std::size_t i = 0; i < 1000; ++i) classes[i] = std::uint8_t(i);
    Attribute category = *cloud->findAttribute("Intensity");
    category.name = "Id";
    category.kind = AttributeKind::Category;
    cloud->addAttribute(category);
    Camera camera = cameraFor(*cloud);
    camera.setView("top");
    camera.pan({0.3, 0.2}, kHeight);  // the middle row off the seam between two rows of pixels
    for (const int samples : {1, 4})
        for (const char* name : {"Id", "Classification", "RGB", "Intensity", "GpsTime"}) {
            const auto store = filledStore(cloud);
            DisplaySettings display;
            display.attribute = name;
            display.samples = samples;
            display.backgroundTop = {10, 20, 30, 0};
            display.backgroundBottom = {200, 100, 0, 255};
            View view(gl(), {store}, camera, display);
            View reference(cpu(), {store}, camera, display);
            const Image image = view.bruteForce(), expected = reference.bruteForce();
            int bad = 0;
            for (std::size_t k = 0; k < image.pixels.size(); ++k) {
                const Rgba8 a = image.pixels[k], b = expected.pixels[k];
                const int most =
                    std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b), std::abs(a.a - b.a)});
                bad +=
                    most > (std::string_view(name) == "Intensity" || std::string_view(name) == "GpsTime" ? 8 : 0);
            }
            QVERIFY2(bad == 0, qPrintable(QString("%1, %2 samples: %3").arg(name).arg(samples).arg(bad)));
        }
}

// While a file loads, what has been drawn has its colors, although blocks change faster than they are sent whole.
void GlBackendChecks::colorsAreRightWhileLoading()
{
    const auto cloud = cloudNamed("synthetic");
    const auto store = std::make_shared<PointStore>(cloud, cloud->computeBounds());
    store->fill({0, cloud->size() / 2});
    const Camera camera = cameraFor(*cloud);
    DisplaySettings display;
    display.attribute = "Intensity";
    display.range = {{0.0, 3000.0}};
    const auto begin = [&](ProgressiveRenderer& renderer) {
        renderer.setSize(kWidth, kHeight);
        renderer.setCamera(camera);
        renderer.setDisplay(display);
        renderer.addCloud(store);
        renderer.renderFrame(5.0);  // all there is, in one frame
    };
    ProgressiveRenderer reference(cpu()), renderer(gl({.blocksAFrame = 1}));
    begin(reference);
    begin(renderer);
    const double covered = reference.coveredShare();
    QVERIFY(share(renderer.image(), reference.image(), covered) <= 0.01);
    // And right after a switch in the middle of loading.
    display.attribute = "Classification";
    for (ProgressiveRenderer* r : {&reference, &renderer}) {
        r->setDisplay(display);
        r->renderFrame(5.0);
    }
    QVERIFY(share(renderer.image(), reference.image(), covered) <= 0.01);
}

void GlBackendChecks::loadingSendsEachPointOnce_data()
{
    QTest::addColumn<OrderKind>("order");
    QTest::newRow("stratified") << OrderKind::Stratified;
    QTest::newRow("prime") << OrderKind::Prime;
}

// Parts of a file arrive in no order, and after each a frame draws all there is. What goes to the device comes to
// one copy of the points, and a little; in the prime order, to some copies instead of one a frame.
void GlBackendChecks::loadingSendsEachPointOnce()
{
    QFETCH(OrderKind, order);
    const auto cloud = makeCloud(400'000);
    const RawBounds bounds = cloud->computeBounds();
    const auto store = std::make_shared<PointStore>(cloud, bounds, order);
    DisplaySettings display;
    display.attribute = "Classification";
    const Camera camera = cameraFor(*cloud);
    ProgressiveRenderer renderer(gl());
    renderer.setSize(kWidth, kHeight);
    renderer.setCamera(camera);
    renderer.setDisplay(display);
    renderer.addCloud(store);
    renderer.setPointsAFrame(cloud->size());
    constexpr PointIndex kParts = 25;
    const PointIndex part = cloud->size() / kParts;
    std::uint64_t up = 0;
    for (PointIndex k = 0; k < kParts; ++k) {
        const PointIndex first = k * 7 % kParts * part;
        store->fill({first, first + part});
        const FrameReport report = renderer.renderFrame(1.0);
        QVERIFY(report.filled > 0);
        up += report.bytesUp;
    }
    const double copies = double(up) / (16.0 * double(store->slotCount()));
    qInfo("%.2f copies of the points", copies);
    QVERIFY(copies < (order == OrderKind::Stratified ? 1.5 : 7.0));

    // When all is there, nothing goes a second time but tables and commands.
    renderer.loadingEnded(*cloud, bounds);
    std::uint64_t after = 0;
    for (int frames = 0; !renderer.converged(); ++frames) {
        QVERIFY(frames < 1000);
        after += renderer.renderFrame(1.0).bytesUp;
    }
    QVERIFY2(after < 500'000, qPrintable(QString::number(after)));
    View reference(gl(), {filledStore(cloud, order)}, camera, display);
    QVERIFY(share(renderer.image(), reference) <= m_tolerance.converged);
}

}  // namespace punctum::test
