// SPDX-License-Identifier: MIT
#include "core/Error.h"
#include "core/cloud/Visibility.h"
#include "core/task/Progress.h"
#include "render/backends/Backends.h"
#include "render/gl/EglContext.h"
#include "render/progressive/ProgressiveRenderer.h"
#include "tests/render/RenderedView.h"

#include <QTest>

#include <algorithm>

using namespace punctum;
using namespace punctum::render;
using test::cameraFor;
using test::differing;
using test::filledStore;
using View = test::CpuView;

/// What a view shows of its points follows attributes, edits, filters and the range that all clouds share.
class ProgressiveWordsTest : public QObject
{
    Q_OBJECT

private Q_SLOTS:
    void attributeSwitchShowsAtOnce();
    void editsShowInTheNextFrame();
    void hiddenClassesVanishAndComeBack();
    void hiddenPointsAndClipsAreNotDrawn_data();
    void hiddenPointsAndClipsAreNotDrawn();
    void rangeIsSecondToNinetyEighthPercentile();
    void rangeIsOfWhatIsShown();
    void oneLegendForAllClouds();
};

void ProgressiveWordsTest::attributeSwitchShowsAtOnce()
{
    const auto cloud = test::makeCloud(1'000'000);
    const auto store = filledStore(cloud);
    const Camera camera = cameraFor(*cloud, 320, 200);
    View view({store}, camera, {});
    view.converge(0.02);
    DisplaySettings display;
    for (const char* name : {"Classification", "GpsTime", "RGB", "Intensity"}) {
        display.attribute = name;
        view.renderer.setDisplay(display);
        view.renderer.renderFrame(0.0);  // one frame, with time for next to nothing
        const Image first = view.renderer.image();
        QCOMPARE(view.renderer.shownAttribute(), std::string(name));
        View reference({filledStore(cloud)}, camera, display);
        reference.converge(0.1);
        QCOMPARE(differing(first, reference.bruteForce()), 0);
    }
    view.converge();
    QVERIFY(!store->stale());
}

void ProgressiveWordsTest::editsShowInTheNextFrame()
{
    const auto cloud = test::makeCloud(1'000'000);
    const auto store = filledStore(cloud);
    DisplaySettings display;
    display.attribute = "Classification";
    const Camera camera = cameraFor(*cloud, 320, 200);
    View view({store}, camera, display);
    view.converge(0.02);
    const Image before = view.renderer.image();
    const auto setAll = [&](std::uint8_t from, std::uint8_t to) {
        const auto points = test::reclassify(*cloud, from, to);
        view.renderer.valuesChanged(*cloud, {ChangeNotice::Kind::Values, {"Classification"}, points});
        view.renderer.renderFrame(0.0);
    };
    setAll(2, 11);
    View reference({filledStore(cloud)}, camera, display);
    QCOMPARE(differing(view.renderer.image(), reference.bruteForce()), 0);
    QVERIFY(differing(view.renderer.image(), before) > 1000);
    setAll(11, 2);
    QCOMPARE(differing(view.renderer.image(), before), 0);
}

void ProgressiveWordsTest::hiddenClassesVanishAndComeBack()
{
    const auto cloud = test::makeCloud(300'000);
    const auto store = filledStore(cloud);
    DisplaySettings display;
    display.attribute = "Classification";
    View view({store}, cameraFor(*cloud, 320, 200), display);
    view.converge();
    const Image all = view.renderer.image();
    display.classVisible[6] = false;
    view.renderer.setDisplay(display);
    view.converge();
    const Rgba8 building = display.palette[6];
    const auto shows = [&](const Image& image) {
        return std::count(image.pixels.begin(), image.pixels.end(), building) > 0;
    };
    QVERIFY(shows(all));
    QVERIFY(!shows(view.renderer.image()));
    // A point that becomes a hidden class vanishes too.
    auto everything = std::make_shared<PointSet>(cloud->size());
    const auto classes = cloud->findAttribute("Classification")->columns[0]->values<std::uint8_t>();
    const std::vector<std::uint8_t> kept(classes.begin(), classes.end());
    for (PointIndex i = 0; i < cloud->size(); ++i) everything->insert(i);
    std::fill(classes.begin(), classes.end(), std::uint8_t(6));
    view.renderer.valuesChanged(*cloud, {ChangeNotice::Kind::Values, {"Classification"}, everything});
    view.converge();
    QCOMPARE(view.renderer.coveredShare(), 0.0);
    std::copy(kept.begin(), kept.end(), classes.begin());
    view.renderer.valuesChanged(*cloud, {ChangeNotice::Kind::Values, {"Classification"}, everything});
    display.classVisible.fill(true);
    view.renderer.setDisplay(display);
    view.converge();
    QCOMPARE(differing(view.renderer.image(), all), 0);
}

void ProgressiveWordsTest::hiddenPointsAndClipsAreNotDrawn_data()
{
    QTest::addColumn<int>("backend");
    for (const BackendKind kind : kBackendKinds)
        QTest::addRow("%s", std::string(nameOf(kind)).c_str()) << int(kind);
}

void ProgressiveWordsTest::hiddenPointsAndClipsAreNotDrawn()
{
    QFETCH(int, backend);
    EglContext context;
    if (needsGl(BackendKind(backend))) {
        try {
            context = EglContext::create();
        } catch (const Error& e) {
            QSKIP(e.what());
        }
    }
    const auto cloud = test::makeCloud(120'000, {glm::dvec3(0.001), glm::dvec3(4e5, 5e6, 100)});
    const auto store = filledStore(cloud);
    Camera camera = cameraFor(*cloud, 320, 200);
    Progress progress;
    Visibility visibility;
    visibility.clip.box = WorldBounds{{400'020, 5'000'010, 0}, {400'180, 5'000'190, 112}};
    visibility.clip.planes = {{{1, 0.5, 0}, 400'030 + 0.5 * 5'000'000}, {{0, -1, 0}, -5'000'170}};
    auto filtered = std::make_shared<PointSet>(cloud->size());
    for (PointIndex i = 0; i < cloud->size(); i += 3) filtered->insert(i);
    visibility.filtered = filtered;
    visibility.classVisible[6] = false;
    const auto hidden = hiddenPoints(*cloud, visibility, progress);

    DisplaySettings display;
    display.pointSize = 2;
    View view({store}, camera, display);
    view.renderer.setBackend(makeBackend(BackendKind(backend)));
    view.converge();
    const Image all = view.renderer.image();
    display.clip = visibility.clip;
    display.classVisible = visibility.classVisible;
    view.renderer.setDisplay(display);
    view.renderer.hide(*cloud, filtered.get());
    view.renderer.renderFrame(0.0);
    std::vector<PointId> ids;
    const auto wrong = [&] {
        view.renderer.backend().visibleIds(ids);
        return std::count_if(ids.begin(), ids.end(),
                             [&](PointId id) { return hidden->contains(store->order().indexOf(id)); });
    };
    QCOMPARE(wrong(), 0);
    camera.orbit(0.3, 0.1);
    view.renderer.setCamera(camera);
    view.converge();
    QCOMPARE(wrong(), 0);
    QVERIFY(ids.size() > 5'000);

    // As a cloud that has the others alone.
    const auto rest = test::makeCloud(cloud->size() - hidden->count(), cloud->coordinates());
    PointIndex to = 0;
    for (PointIndex i = 0; i < cloud->size(); ++i) {
        if (hidden->contains(i)) continue;
        for (std::size_t axis = 0; axis < 3; ++axis)
            rest->columns()[axis]->values<std::int32_t>()[to] = cloud->columns()[axis]->values<std::int32_t>()[i];
        ++to;
    }
    View reference({filledStore(rest)}, camera, display);
    reference.renderer.renderBruteForce();
    QVERIFY(std::abs(view.renderer.coveredShare() - reference.renderer.coveredShare()) < 0.001);

    display.clip = {};
    display.classVisible.fill(true);
    view.renderer.setDisplay(display);
    view.renderer.hide(*cloud, nullptr);
    view.renderer.setCamera(cameraFor(*cloud, 320, 200));
    view.converge();
    QVERIFY(differing(view.renderer.image(), all) <= (backend == int(BackendKind::GlPoints) ? 300 : 0));
}

void ProgressiveWordsTest::rangeIsSecondToNinetyEighthPercentile()
{
    const auto cloud = test::makeCloud(200'000);
    cloud->findAttribute("Intensity")->columns[0]->values<std::uint16_t>()[0] = 65535;
    DisplaySettings display;
    display.attribute = "Intensity";  // 0..2999, evenly
    View view({filledStore(cloud)}, cameraFor(*cloud, 320, 200), display);
    view.converge();
    QVERIFY(std::abs(view.renderer.range().first - 60) < 15);
    QVERIFY(std::abs(view.renderer.range().second - 2940) < 15);
    display.range = {{100.0, 200.0}};
    view.renderer.setDisplay(display);
    view.converge();
    QCOMPARE(view.renderer.range(), std::pair(100.0, 200.0));

    // deleted points have no part in it, however few are left
    display.range.reset();
    view.renderer.setDisplay(display);
    view.converge();
    const auto gone = std::make_shared<PointSet>(cloud->size());
    const Attribute intensity = *cloud->findAttribute("Intensity");
    for (PointIndex i = 0; i < cloud->size(); ++i)
        if (intensity.number(i) < 1000 || intensity.number(i) > 1010) gone->insert(i);
    {
        const std::unique_lock lock(cloud->mutex());
        cloud->setDeleted(gone);
    }
    view.renderer.valuesChanged(*cloud, {ChangeNotice::Kind::Deleted, {}, gone});
    view.converge();
    QVERIFY(view.renderer.range().first >= 1000 && view.renderer.range().second <= 1010);
}

void ProgressiveWordsTest::rangeIsOfWhatIsShown()
{
    for (const OrderKind order : {OrderKind::Stratified, OrderKind::Prime}) {
        const auto cloud = test::makeCloud(200'000);
        DisplaySettings display;
        display.attribute = "Z";  // walls (class 6) are the highest
        View view({filledStore(cloud, order)}, cameraFor(*cloud, 320, 200), display);
        view.converge();
        const auto all = view.renderer.range();
        const auto changed = [&] {
            view.converge();
            return view.renderer.range() != all;
        };
        display.classVisible[6] = false;
        view.renderer.setDisplay(display);
        QVERIFY(changed());
        QVERIFY(view.renderer.range().second < 13.5);
        display.classVisible.fill(true);
        display.clip.box = WorldBounds{{0, 0, 0}, {200, 200, 5}};
        view.renderer.setDisplay(display);
        QVERIFY(changed());
        QVERIFY(view.renderer.range().first >= 0 && view.renderer.range().second <= 5);
        display.clip = {};
        display.cuts = {{{0, 0, 1}, 5}};
        view.renderer.setDisplay(display);
        QVERIFY(!changed());
        display.cuts.clear();
        view.renderer.setDisplay(display);
        PointSet filtered(cloud->size());
        const Attribute& z = *cloud->findAttribute("Z");
        for (PointIndex i = 0; i < cloud->size(); ++i)
            if (z.number(i) < 20) filtered.insert(i);
        view.renderer.hide(*cloud, &filtered);
        QVERIFY(changed());
        QVERIFY(view.renderer.range().first >= 20);
        view.renderer.hide(*cloud, nullptr);
        QVERIFY(!changed());
    }
}

void ProgressiveWordsTest::oneLegendForAllClouds()
{
    const auto fill = [](PointCloud& cloud, const char* name, auto value) {
        for (auto& v : cloud.findAttribute(name)->columns[0]->values<decltype(value)>()) v = value;
    };
    const auto bright = test::makeCloud(20'000), plain = test::makeCloud(20'000), poor = test::makeCloud(20'000);
    for (const auto& cloud : {bright, plain, poor})
        for (const char* name : {"Red", "Green", "Blue"}) fill(*cloud, name, std::uint16_t(0));
    for (const auto& cloud : {plain, poor}) {
        fill(*cloud, "Intensity", std::uint16_t(3000));
        fill(*cloud, "Classification", std::uint8_t(2));
    }
    poor->removeAttribute("Intensity");
    View view({filledStore(bright), filledStore(plain), filledStore(poor)}, cameraFor(*bright, 320, 200), {});
    view.converge();
    QCOMPARE(view.renderer.shownAttribute(), std::string("Intensity"));
    QVERIFY(view.renderer.range().first >= 0 && view.renderer.range().first < 200);
    QCOMPARE(view.renderer.range().second, 3000.0);
    DisplaySettings display;
    display.attribute = "Intensity";
    View chosen({filledStore(bright), filledStore(plain), filledStore(poor)}, cameraFor(*bright, 320, 200),
                display);
    QCOMPARE(differing(view.renderer.image(), chosen.bruteForce()), 0);

    // What was chosen is what is told, also where the first cloud lacks it.
    View other({filledStore(poor), filledStore(bright)}, cameraFor(*bright, 320, 200), display);
    other.converge();
    QCOMPARE(other.renderer.shownAttribute(), std::string("Intensity"));
    QVERIFY(other.renderer.range().second > 2000);
}

QTEST_APPLESS_MAIN(ProgressiveWordsTest)
#include "ProgressiveWordsTest.moc"
