// SPDX-License-Identifier: MIT
#include "tests/render/GlBackendChecks.h"

#include "core/Error.h"
#include "core/las/Reader.h"
#include "core/task/Progress.h"
#include "render/camera/Projection.h"
#include "render/progressive/ProgressiveRenderer.h"
#include "tests/render/GlPictures.h"

#include <QTest>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <set>
#include <thread>

namespace punctum::test
{

using namespace punctum::render;

void GlBackendChecks::initTestCase()
{
    try {
        m_egl = EglContext::create();
    } catch (const Error& e) {
        QSKIP(e.what());
    }
    qInfo("%s", qPrintable(QString::fromStdString(gl()->description())));
}

std::shared_ptr<PointCloud> GlBackendChecks::cloudNamed(const QString& name)
{
    auto& cloud = m_clouds[name];
    if (cloud) return cloud;
    if (name == "synthetic") return cloud = makeCloud(300'000);
    const std::filesystem::path file = std::filesystem::path(PUNCTUM_TEST_DATA) / name.toStdString();
    if (!std::filesystem::exists(file)) return nullptr;
    Progress progress;
    return cloud = las::load(file, progress);
}

void GlBackendChecks::agreesWithTheCpuBackend_data()
{
    QTest::addColumn<QString>("file");
    QTest::addColumn<int>("samples");
    QTest::addColumn<double>("size");
    QTest::addColumn<bool>("orthographic");
    for (const char* file : {"synthetic", "autzen_trim.las", "tls_clip.laz", "lion_takanawa.copc.laz"})
        for (const int samples : m_samples)
            for (const double size : {1.0, 3.0})
                for (const bool orthographic : {false, true}) {
                    const bool synthetic = std::string_view(file) == "synthetic";
                    if (samples > 4 && (orthographic || !synthetic)) continue;  // one cloud serves
                    if (!synthetic && orthographic != (size > 1.0)) continue;   // what the cloud has no part in
                    QTest::addRow("%s, %d samples, %g px%s", file, samples, size,
                                  orthographic ? ", orthographic" : "")
                        << file << samples << size << orthographic;
                }
}

// What the constructor was told of the covered pixels may differ, for these reasons:
// - two points of one sample that are equally deep: the CPU backend shows the smaller id, OpenGL the one drawn
// first
//   (a converged picture; drawn in one pass, as here, these are the same);
// - the last bit of a float: whether products and sums are rounded together, and how a reciprocal is, is up to the
//   driver, so that points on the edge of a sample, or nearly equally deep, fall on the other side;
// - drivers whose 4 samples lie elsewhere than samplePlaces() (description() tells) differ at the rims of points.
void GlBackendChecks::agreesWithTheCpuBackend()
{
    QFETCH(QString, file);
    QFETCH(int, samples);
    QFETCH(double, size);
    QFETCH(bool, orthographic);
    const auto cloud = cloudNamed(file);
    if (!cloud) QSKIP(qPrintable(file + " is not there."));
    const auto store = filledStore(cloud);
    Camera camera = cameraFor(*cloud);
    camera.orthographic = orthographic;
    DisplaySettings display;
    display.attribute = "Z";
    display.samples = samples;
    display.pointSize = size;
    BesideCpu both(gl(), {store}, camera, display);
    QVERIFY(both.covered > 0.05);
    qInfo("%s of the covered pixels differ", qPrintable(percent(both.different())));
    QVERIFY(both.different() <= m_tolerance.cpu);
    QVERIFY(std::abs(both.view.renderer.coveredShare() - both.covered) <= 0.001);
}

// Points whose middle lies outside the picture reach into it with their squares, on all four sides.
void GlBackendChecks::edgesOfThePictureAreComplete()
{
    const auto cloud = cloudNamed("synthetic");
    Camera camera = cameraFor(*cloud);
    camera.zoomTowards(camera.pivot, 0.02);
    DisplaySettings display;
    display.attribute = "Z";
    display.pointSize = 21.0;
    for (const int samples : {1, 4}) {
        display.samples = samples;
        const auto store = filledStore(cloud);
        const BesideCpu both(gl(), {store}, camera, display);
        QVERIFY(both.covered > 0.3);
        QVERIFY(both.different() <= 0.01);
        int border = 0, covered = 0;
        for (int y = 0; y < kHeight; ++y)
            for (const int x : {0, kWidth - 1}) {
                border += !(both.image.at(x, y) == both.expected.at(x, y));
                ++covered;
            }
        for (int x = 0; x < kWidth; ++x)
            for (const int y : {0, kHeight - 1}) {
                border += !(both.image.at(x, y) == both.expected.at(x, y));
                ++covered;
            }
        QVERIFY2(border <= covered / 50, qPrintable(QString::number(border)));
    }
}

void GlBackendChecks::convergedEqualsBruteForce_data()
{
    QTest::addColumn<int>("samples");
    QTest::addColumn<bool>("orthographic");
    for (const int samples : m_samples)
        for (const bool orthographic : {false, true})
            QTest::addRow("%d samples%s", samples, orthographic ? ", orthographic" : "") << samples << orthographic;
}

void GlBackendChecks::convergedEqualsBruteForce()
{
    QFETCH(int, samples);
    QFETCH(bool, orthographic);
    const auto cloud = cloudNamed("synthetic");
    const auto store = filledStore(cloud);
    Camera camera = cameraFor(*cloud);
    camera.orthographic = orthographic;
    DisplaySettings display;
    display.samples = samples;
    View view(gl(), {store}, camera, display);
    for (int k = 0; k < 5; ++k) {
        camera.orbit(0.03, 0.01);
        view.renderer.setCamera(camera);
        view.renderer.renderFrame(0.001);
    }
    view.converge(0.001);
    const Image converged = view.renderer.image();
    View reference(gl(), {store}, camera, display);
    const Image expected = reference.bruteForce();
    QVERIFY(share(converged, expected, reference.renderer.coveredShare()) <= m_tolerance.converged);
    // From near: what is out of sight is left out, and nothing else.
    camera.fit({{90, 90, -20}, {110, 110, 40}}, {expected.width, expected.height});
    view.renderer.setCamera(camera);
    view.converge(0.01);
    reference.renderer.setCamera(camera);
    QVERIFY(share(view.renderer.image(), reference.bruteForce(), reference.renderer.coveredShare()) <=
            m_tolerance.converged);
    camera = cameraFor(*cloud);
    for (int k = 0; k < 5; ++k) camera.orbit(0.03, 0.01);
    camera.orthographic = orthographic;
    view.renderer.setCamera(camera);
    // Once more over the same buffer: nothing is left of the picture before.
    view.bruteForce();
    QCOMPARE(differing(view.renderer.image(), expected), 0);
}

// What is out of sight is left out, in every piece of memory and by every way of filling, and nothing else.
void GlBackendChecks::outOfSightMakesNoDifference()
{
    const std::vector stores{filledStore(cloudNamed("synthetic")), filledStore(makeCloud(150'000))};
    Camera camera = cameraFor(stores.front()->cloud());
    View view(gl({.chunkSlots = PointStore::kBlockSlots}), stores, camera, {});
    View reference(gl(), stores, camera, {});
    const PointIndex all = stores.front()->cloud().size() + stores.back()->cloud().size();
    int part = 0;
    for (int k = 0; k < 8; ++k) {
        camera.orthographic = k % 2 == 1;
        camera.yaw = 0.8 * k;
        camera.pitch = -1.4 + 0.2 * k;
        const double x = 20.0 * k, y = 180 - 15.0 * k, reach = k % 3 == 0 ? 2.0 : 12.0;
        camera.fit({{x, y, 0}, {x + reach, y + reach, 5}}, {kWidth, kHeight});
        DisplaySettings display;
        display.pointSize = k % 4 == 1 ? 6 : 1;
        if (k % 4 == 2) display.cuts.push_back({camera.right(), glm::dot(camera.right(), camera.pivot) + 1});
        display.averaged = k == 3;
        for (View* each : {&view, &reference}) {
            each->renderer.setDisplay(display);
            each->renderer.setCamera(camera);
        }
        view.renderer.setPointsAFrame(k % 3 == 2 ? 100'000 : 0);  // else the device decides, where it can
        view.converge(0.005);
        part += view.renderer.pointsInSight() < all / 2 ? 1 : 0;
        const double different = share(view.renderer.image(), reference);
        QVERIFY2(different <= std::max(m_tolerance.converged, k == 3 ? kAveraged : 0.0),
                 qPrintable(percent(different)));
    }
    QVERIFY2(part >= 4, qPrintable(QString::number(part)));
}

// How much a frame draws is decided by the device: nothing but the first run where there is no time, all that is
// offered where there is enough, and the picture comes to the same.
void GlBackendChecks::deviceKeepsTheBudget()
{
    const auto cloud = cloudNamed("synthetic");
    const auto store = filledStore(cloud), other = filledStore(makeCloud(150'000));
    if (!gl()->keepsTime()) QSKIP("This driver does not write times to buffers.");
    View view(gl({.chunkSlots = PointStore::kBlockSlots}), {store, other}, cameraFor(*cloud), {});
    const PointIndex all = store->slotCount() + other->slotCount();

    const FrameReport least = view.renderer.renderFrame(0.0);
    QVERIFY2(least.filled > 0 && least.filled < all / 4, qPrintable(QString::number(least.filled)));
    for (int k = 0; k < 3; ++k) {  // while that is so, frame by frame
        const FrameReport next = view.renderer.renderFrame(0.0);
        QVERIFY(next.filled > 0 && next.filled < all / 4);
    }
    for (int k = 0; k < 1000 && !view.renderer.converged(); ++k) view.renderer.renderFrame(10.0);
    QVERIFY(view.renderer.converged());
    const Image converged = view.renderer.image();
    QVERIFY(share(converged, view) <= m_tolerance.converged);

    // With time for all of it, one frame does it.
    Camera camera = view.renderer.camera();
    camera.orbit(0.3, 0.0);
    view.renderer.setCamera(camera);
    const FrameReport whole = view.renderer.renderFrame(10.0);
    QCOMPARE(whole.filled, all);
    QVERIFY(whole.converged);
    QVERIFY(share(view.renderer.image(), view) <= m_tolerance.converged);

    // A number of points is kept by the processor.
    camera.orbit(0.3, 0.0);
    view.renderer.setCamera(camera);
    view.renderer.setPointsAFrame(100'000);
    const FrameReport fixed = view.renderer.renderFrame(10.0);
    QVERIFY(fixed.filled >= 100'000 && fixed.filled < 110'000);
}

void GlBackendChecks::movingKeepsThePicture()
{
    const auto cloud = makeCloud(1'000'000);
    const auto store = filledStore(cloud);
    for (const int samples : {1, 4}) {
        DisplaySettings display;
        display.samples = samples;
        Camera camera = cameraFor(*cloud);
        View view(gl(), {store}, camera, display);
        view.bruteForce();
        const double converged = view.renderer.coveredShare();
        camera.orbit(0.02, 0.0);
        view.renderer.setCamera(camera);
        const FrameReport frame = view.renderer.renderFrame(0.0);
        QVERIFY(frame.filled < cloud->size() / 5);
        QVERIFY2(view.renderer.coveredShare() > 0.9 * converged,
                 qPrintable(QString::number(view.renderer.coveredShare() / converged)));
    }
}

void GlBackendChecks::chunksMakeNoDifference()
{
    // Bands of 65 rows at 1 sample and of 16 at 4 samples; 5 chunks, and 2 runs of the resolve shader.
    const GlLimits limits{.chunkSlots = PointStore::kBlockSlots, .bandSamples = 65 * kWidth};
    const auto cloud = cloudNamed("synthetic");
    const auto store = filledStore(cloud);
    for (const int samples : {1, 4}) {
        DisplaySettings display;
        display.samples = samples;
        display.attribute = "Intensity";
        Camera camera = cameraFor(*cloud);
        View whole(gl(), {store}, camera, display);
        View parts(gl(limits), {store}, camera, display);
        QCOMPARE(differing(whole.bruteForce(), parts.bruteForce()), 0);
        const double covered = whole.renderer.coveredShare();
        camera.orbit(0.5, 0.1);
        for (View* view : {&whole, &parts}) {
            view->renderer.setCamera(camera);
            view->converge();
        }
        QVERIFY(share(whole.renderer.image(), parts.renderer.image(), covered) <= 0.001);
        std::vector<PointId> a, b;
        parts.bruteForce();
        whole.bruteForce();
        whole.renderer.backend().visibleIds(a);
        parts.renderer.backend().visibleIds(b);
        QCOMPARE(std::set(a.begin(), a.end()), std::set(b.begin(), b.end()));
    }
}

void GlBackendChecks::severalCloudsComeAndGo()
{
    const auto a = makeCloud(100'000);
    const auto b = makeCloud(150'000, {glm::dvec3(0.0005), glm::dvec3(150, 30, 4)});
    auto storeA = filledStore(a);
    const auto storeB = filledStore(b);
    Camera camera;
    WorldBounds bounds = a->coordinates().toWorld(a->computeBounds());
    bounds.include(b->coordinates().toWorld(b->computeBounds()));
    camera.fit(bounds, {kWidth, kHeight});
    DisplaySettings display;
    display.attribute = "Z";
    View view(gl(), {storeA, storeB}, camera, display);
    view.converge();
    View both(cpu(), {storeA, storeB}, camera, display);
    const Image expected = both.bruteForce();
    QVERIFY(share(view.renderer.image(), expected, both.renderer.coveredShare()) <= 0.01);

    view.renderer.removeCloud(*a);
    view.converge();
    View alone(cpu(), {storeB}, camera, display);
    QVERIFY(share(view.renderer.image(), alone) <= 0.01);

    view.add(storeA);
    view.converge();
    View again(cpu(), {storeB, storeA}, camera, display);
    QVERIFY(share(view.renderer.image(), again) <= 0.01);

    view.renderer.removeCloud(*a);
    view.renderer.removeCloud(*b);
    view.converge();
    QCOMPARE(view.renderer.coveredShare(), 0.0);
    View nothing(cpu(), {}, camera, display);
    QCOMPARE(differing(view.renderer.image(), nothing.bruteForce()), 0);
}

void GlBackendChecks::hiddenClassesVanishAndComeBack()
{
    const auto cloud = makeCloud(300'000);
    const auto store = filledStore(cloud);
    DisplaySettings display;
    display.attribute = "Classification";
    View view(gl(), {store}, cameraFor(*cloud), display);
    const Image all = view.bruteForce();
    display.classVisible[6] = false;
    view.renderer.setDisplay(display);
    view.converge();
    const auto shows = [&](const Image& image, std::size_t code) {
        return std::count(image.pixels.begin(), image.pixels.end(), display.palette[code]) > 0;
    };
    QVERIFY(shows(all, 6) && shows(all, 2));
    QVERIFY(!shows(view.renderer.image(), 6) && shows(view.renderer.image(), 2));
    View reference(cpu(), {store}, cameraFor(*cloud), display);
    QVERIFY(share(view.renderer.image(), reference) <= 0.01);

    // Points that are put into a hidden class vanish too.
    auto everything = std::make_shared<PointSet>(cloud->size());
    for (PointIndex i = 0; i < cloud->size(); ++i) everything->insert(i);
    const auto classes = cloud->findAttribute("Classification")->columns[0]->values<std::uint8_t>();
    const std::vector<std::uint8_t> kept(classes.begin(), classes.end());
    std::fill(classes.begin(), classes.end(), std::uint8_t(6));
    view.renderer.valuesChanged(*cloud, {ChangeNotice::Kind::Values, {"Classification"}, everything});
    view.converge();
    QCOMPARE(view.renderer.coveredShare(), 0.0);
    std::copy(kept.begin(), kept.end(), classes.begin());
    view.renderer.valuesChanged(*cloud, {ChangeNotice::Kind::Values, {"Classification"}, everything});
    display.classVisible.fill(true);
    view.renderer.setDisplay(display);
    view.converge();
    QVERIFY(share(view.renderer.image(), all, view.renderer.coveredShare()) <= 0.001);
}

void GlBackendChecks::convergesWhileLoading()
{
    const auto cloud = makeCloud(600'000);
    const RawBounds bounds = cloud->computeBounds();
    const auto store = std::make_shared<PointStore>(cloud, bounds);
    const Camera camera = cameraFor(*cloud);
    ProgressiveRenderer renderer(gl());
    renderer.setSize(kWidth, kHeight);
    renderer.setCamera(camera);
    renderer.addCloud(store);
    std::atomic<bool> done = false;
    std::thread loader([&] {
        constexpr PointIndex kBatch = 10'000;
        for (PointIndex k = 0; k < 60; ++k) {
            const PointIndex first = k * 7 % 60 * kBatch;
            store->fill({first, first + kBatch});
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
        }
        done = true;
    });
    DisplaySettings display;
    display.attribute = "Intensity";
    bool switched = false;
    while (!done) {
        renderer.renderFrame(0.002);
        if (!switched && store->filled() > 200'000) {
            renderer.setDisplay(display);
            switched = true;
        }
    }
    loader.join();
    renderer.loadingEnded(*cloud, bounds);
    renderer.setDisplay(display);
    int frames = 0;
    while (!renderer.renderFrame(0.01).converged) QVERIFY(++frames < 10'000);
    View reference(gl(), {filledStore(cloud)}, camera, display);
    const Image expected = reference.bruteForce();
    QVERIFY(share(renderer.image(), expected, reference.renderer.coveredShare()) <= 0.001);
}

// A store whose frame was wrong: what was visible stays so when the frame is made anew, without a further draw.
void GlBackendChecks::rebuiltStoresAreSeen()
{
    const auto cloud = cloudNamed("synthetic");
    const RawBounds bounds = cloud->computeBounds();
    RawBounds wrong = bounds;
    wrong.min.x += 50'000 + (std::int64_t(1) << 29);  // a frame keeps that much room for surprises
    wrong.max.x = wrong.min.x + 1000;
    PointStore store(cloud, wrong);
    store.fillAll();
    QVERIFY(store.outgrown());
    const Camera camera = cameraFor(*cloud);
    const TargetSize size{kWidth, kHeight, 1};
    FrameScene scene;
    scene.add({&store, 0, makeProjection(camera, store, size)});
    const auto backend = gl();
    backend->setTarget(size);
    backend->draw(scene, 0, {0, store.slotCount()});
    const double before = backend->coveredShare();
    QVERIFY(before > 0.05);
    store.setBounds(bounds);
    QVERIFY(!store.outgrown());
    scene.layers[0].projection = makeProjection(camera, store, size);
    backend->reproject(scene);
    QVERIFY(std::abs(backend->coveredShare() - before) < 0.01 * before);
    backend->draw(scene, 0, {0, store.slotCount()});
    QVERIFY(backend->coveredShare() > 1.1 * before);
}

// The points of the buffer, drawn by their ids into an empty one, are all that it showed; so on the processor.
void GlBackendChecks::pointsOfAListAreSeen()
{
    const auto cloud = cloudNamed("synthetic");
    const auto first = filledStore(makeCloud(70'000)), second = filledStore(cloud);
    const Camera camera = cameraFor(*cloud);
    for (const int samples : {1, 4}) {
        const TargetSize size{kWidth, kHeight, samples};
        FrameScene scene;
        for (const auto& store : {first, second}) scene.add({store.get(), 0, makeProjection(camera, *store, size)});
        std::unique_ptr<RasterBackend> backends[] = {gl(), cpu()};
        for (const auto& backend : backends) {
            backend->setTarget(size);
            for (std::size_t layer = 0; layer < 2; ++layer)
                backend->draw(scene, layer, {0, scene.layers[layer].store->slotCount()});
            std::vector<float> before, after;
            backend->depths(before);
            std::vector<PointId> ids;
            backend->visibleIds(ids);
            QVERIFY(
                std::any_of(ids.begin(), ids.end(), [&](PointId id) { return scene.ids.find(id)->layer == 1; }));
            backend->clear();
            QCOMPARE(backend->coveredShare(), 0.0);
            backend->redraw(scene, ids);
            backend->depths(after);
            QVERIFY(before == after);
            ids.push_back(kNoPoint - 1);  // nobody's
            backend->redraw(scene, ids);
            backend->redraw(scene, {});
            QCOMPARE(backend->coveredShare(), 0.0);
        }
    }
}

// A cloud is closed and another one opened that has everything alike but its points: the place in memory, the
// number of points, the bounds.
void GlBackendChecks::otherStoresAtTheSameAddressAreSeen()
{
    const auto cloud = makeCloud(300'000);
    const auto other = makeCloud(300'000);
    const RawBounds bounds = cloud->computeBounds();
    for (std::int32_t& z : other->columns()[2]->values<std::int32_t>())
        z = std::int32_t(bounds.min.z + bounds.max.z - z);
    DisplaySettings display;
    display.attribute = "Z";
    const Camera camera = cameraFor(*cloud);
    View reference(cpu(), {filledStore(other)}, camera, display);
    const Image expected = reference.bruteForce();

    alignas(PointStore) std::byte place[sizeof(PointStore)];
    const auto put = [&](const std::shared_ptr<PointCloud>& c) {
        auto store =
            std::shared_ptr<PointStore>(new (place) PointStore(c, bounds), [](PointStore* s) { s->~PointStore(); });
        store->fillAll();
        return store;
    };
    auto store = put(cloud);
    View view(gl(), {store}, camera, display);
    view.bruteForce();
    view.renderer.removeCloud(*cloud);
    const auto* const address = store->positions().data();
    store.reset();
    store = put(other);
    if (store->positions().data() != address) qInfo("The memory was not given out again: an easy case.");
    view.add(store);
    QVERIFY(share(view.bruteForce(), expected, reference.renderer.coveredShare()) <= 0.01);
    view.renderer.removeCloud(*other);
}

void GlBackendChecks::impossibleSizesAreErrors()
{
    const auto backend = gl();
    backend->setTarget({64, 48, 4});
    QVERIFY_EXCEPTION_THROWN(backend->setTarget({1 << 20, 10, 1}), Error);
    QVERIFY_EXCEPTION_THROWN(backend->setTarget({10, 10, 3}), Error);
    backend->setTarget({0, 0, 1});
    Image image;
    backend->resolve({}, {}, image);
    QVERIFY(image.pixels.empty());
    QCOMPARE(backend->coveredShare(), 0.0);
    backend->setTarget({7, 5, 1});
    backend->resolve({}, {}, image);
    QCOMPARE(image.pixels.size(), std::size_t(35));
    QCOMPARE(image.pixels.front(), ResolveSettings().backgroundTop);
    QCOMPARE(image.pixels.back(), ResolveSettings().backgroundBottom);
}

}  // namespace punctum::test
