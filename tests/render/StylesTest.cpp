// SPDX-License-Identifier: MIT
// How points look: their sizes and shapes, mean colors, lit normals.
#include "render/backends/Backends.h"
#include "render/progressive/ProgressiveRenderer.h"
#include "render/store/Spacing.h"
#include "tests/render/AverageChecks.h"
#include "tests/render/RenderedView.h"

#include <QTest>

#include <algorithm>
#include <bit>
#include <cmath>
#include <set>

using namespace punctum;
using namespace punctum::render;
using test::cameraFor;
using test::differing;
using test::filledStore;
using test::kTinyBudget;
using View = test::CpuView;

class StylesTest : public QObject
{
    Q_OBJECT

private Q_SLOTS:
    void stylesConvergeToBruteForce_data();
    void stylesConvergeToBruteForce();
    void spacingIsThatOfTheGrid();
    void sizesFollowTheDepth();
    void pointsStaySmallWhileLoading();
    void averagesAreThoseOfTheNearestPoints();
    void normalsAreLit();
    void averagesFollowChanges();
};

void StylesTest::stylesConvergeToBruteForce_data()
{
    QTest::addColumn<int>("samples");
    QTest::addColumn<int>("sizing");
    QTest::addColumn<bool>("round");
    QTest::addColumn<bool>("averaged");
    QTest::addColumn<bool>("orthographic");
    const char* const names[] = {"pixels", "world size", "density"};
    for (const int samples : {1, 4})
        for (const PointSizing sizing : {PointSizing::Pixels, PointSizing::World, PointSizing::Density})
            for (const bool round : {false, true})
                for (const bool averaged : {false, true})
                    for (const bool orthographic : {false, true})
                        QTest::addRow("%d samples, %s%s%s%s", samples, names[int(sizing)], round ? ", round" : "",
                                      averaged ? ", averaged" : "", orthographic ? ", orthographic" : "")
                            << samples << int(sizing) << round << averaged << orthographic;
}

void StylesTest::stylesConvergeToBruteForce()
{
    QFETCH(int, samples);
    QFETCH(int, sizing);
    QFETCH(bool, round);
    QFETCH(bool, averaged);
    QFETCH(bool, orthographic);
    const auto cloud = test::makeCloud(150'000);
    const auto store = filledStore(cloud);
    Camera camera = cameraFor(*cloud, 320, 200);
    camera.orthographic = orthographic;
    DisplaySettings display;
    display.samples = samples;
    display.sizing = PointSizing(sizing);
    display.pointSize = 2.5;
    display.worldSize = 1.5;
    display.spacings = 2.5;
    display.round = round;
    display.averaged = averaged;
    View view({store}, camera, display);
    for (int k = 0; k < 4; ++k) {
        camera.orbit(0.03, 0.01);
        view.renderer.setCamera(camera);
        view.renderer.renderFrame(kTinyBudget);
    }
    view.converge();
    // Colors that change when all is added up are added up anew.
    display.range = {0.0, 1500.0};
    view.renderer.setDisplay(display);
    view.converge();
    const Image converged = view.renderer.image();
    View reference({store}, camera, display);
    QCOMPARE(differing(converged, reference.bruteForce()), 0);
    display.averaged = !averaged;
    reference.renderer.setDisplay(display);
    QVERIFY(differing(converged, reference.bruteForce()) > 1000);
}

void StylesTest::spacingIsThatOfTheGrid()
{
    // 200 m x 200 m, a point every 0.5 m and then one every 0.25 m, a little shaken; walls hide 5 % of it.
    for (const auto& [points, spacing] :
         {std::pair(PointIndex(160'000), 0.5), std::pair(PointIndex(640'000), 0.25)}) {
        const auto cloud = test::makeCloud(points);
        const double found = pointSpacing(*filledStore(cloud), glm::dvec3(1));
        QVERIFY2(found > 0.8 * spacing && found < 1.25 * spacing, qPrintable(QString::number(found)));
    }
    QCOMPARE(pointSpacing(*filledStore(test::makeCloud(5)), glm::dvec3(1)), 0.0);
}

// One point in front of the eye: as wide as its size in the world says, and no less than 1 px.
void StylesTest::sizesFollowTheDepth()
{
    const auto cloud = test::makeCloud(1);
    Camera camera;
    camera.pivot = cloud->world(0);
    for (const bool orthographic : {false, true})
        for (const double distance : {20.0, 40.0, 1e5}) {
            camera.orthographic = orthographic;
            camera.eye = camera.pivot - camera.forward() * distance;
            DisplaySettings display;
            display.sizing = PointSizing::World;
            display.worldSize = 2.0;
            View view({filledStore(cloud)}, camera, display);
            view.renderer.renderBruteForce();
            const double side = std::sqrt(view.renderer.coveredShare() * 320 * 200);
            const double expected = std::max(1.0, 2.0 / camera.unitsPerPixel(200));
            QVERIFY2(std::abs(side - expected) <= 1, qPrintable(QString("%1, not %2").arg(side).arg(expected)));
            display.round = true;
            view.renderer.setDisplay(display);
            view.renderer.renderBruteForce();
            const double area = view.renderer.coveredShare() * 320 * 200;
            if (expected > 5) QVERIFY(std::abs(area / (side * side) - 0.785) < 0.1);
        }
}

// While a file loads, the spacing of its first points is a guess: no point is a block then.
void StylesTest::pointsStaySmallWhileLoading()
{
    const auto cloud = test::makeCloud(100'000);
    const auto store = std::make_shared<PointStore>(cloud, cloud->computeBounds());
    // A hundredth of the points, spread over the cloud, as the reader brings them.
    for (PointIndex first = 0; first < 100'000; first += 10'000) store->fill({first, first + 100});
    DisplaySettings display;
    display.sizing = PointSizing::Density;
    Camera camera = cameraFor(*cloud, 320, 200);
    camera.zoomTowards(camera.pivot, 0.1);
    View view({}, camera, display);
    view.renderer.addCloud(store);
    view.renderer.renderBruteForce();
    std::vector<PointId> ids;
    view.renderer.backend().visibleIds(ids);
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
    const double pixels = view.renderer.coveredShare() * 320 * 200;
    QVERIFY(!ids.empty());
    QVERIFY2(pixels <= 16.5 * double(ids.size()), qPrintable(QString("%1 px of %2").arg(pixels).arg(ids.size())));
    // All read, they are as wide as their spacing says, which is more from so near.
    store->fillAll();
    view.renderer.loadingEnded(*cloud, cloud->computeBounds());
    view.renderer.renderBruteForce();
    QVERIFY(view.renderer.coveredShare() > 0.85);
}

// Against a plain loop: the mean color of all points of a pixel that are at most 1 % farther than its nearest one.
void StylesTest::averagesAreThoseOfTheNearestPoints()
{
    const auto cloud = test::makeCloud(300'000);
    const auto store = filledStore(cloud);
    const Camera camera = cameraFor(*cloud, 320, 200);
    DisplaySettings display;
    display.attribute = "RGB";
    display.averaged = true;
    View view({store}, camera, display);
    view.converge(0.1);
    struct Pixel {
        double nearest = 1e300;
        std::vector<std::pair<double, Rgba8>> points;
    };
    std::vector<Pixel> pixels(320 * 200);
    for (PointIndex i = 0; i < cloud->size(); ++i) {
        const glm::dvec3 p = camera.project(cloud->world(i), {320, 200});
        if (p.z <= 0 || p.x < 0 || p.y < 0 || p.x >= 320 || p.y >= 200) continue;
        Pixel& pixel = pixels[std::size_t(p.y) * 320 + std::size_t(p.x)];
        pixel.nearest = std::min(pixel.nearest, p.z);
        const auto color = std::bit_cast<Rgba8>(store->words()[store->order().slotOf(i)]);
        pixel.points.emplace_back(p.z, color);
    }
    int checked = 0, wrong = 0, many = 0;
    for (std::size_t k = 0; k < pixels.size(); ++k) {
        double sum[3] = {}, count = 0;
        for (const auto& [depth, c] : pixels[k].points)
            if (depth <= pixels[k].nearest * 1.01) {
                sum[0] += c.r;
                sum[1] += c.g;
                sum[2] += c.b;
                ++count;
            }
        if (count == 0) continue;
        ++checked;
        many += count > 3;
        const Rgba8 shown = view.renderer.image().pixels[k];
        wrong += std::abs(shown.r - sum[0] / count) > 0.51 || std::abs(shown.g - sum[1] / count) > 0.51 ||
                 std::abs(shown.b - sum[2] / count) > 0.51;
    }
    QVERIFY(checked > 10'000 && many > 5'000);
    // Points within float rounding of a pixel's edge, or of 1 %.
    QVERIFY2(wrong <= checked / 100, qPrintable(QString("%1 of %2").arg(wrong).arg(checked)));
}

// A ball's normals, lit from the upper left: brightest there, gray in the middle, dark at the lower right, from
// wherever one looks; and so whichever side they are of.
void StylesTest::normalsAreLit()
{
    constexpr PointIndex kPoints = 200'000;
    const auto cloud = test::makeCloud(kPoints);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        Attribute part;
        part.name = std::string("Normal") + char('X' + axis);
        part.columns[0] = cloud->addColumn(std::make_shared<Column>(part.name, ScalarType::F32, kPoints));
        cloud->addAttribute(part);
    }
    addComposite(*cloud, "Normal", AttributeKind::Vector, {"NormalX", "NormalY", "NormalZ"});
    const Attribute& normal = *cloud->findAttribute("Normal");
    for (PointIndex i = 0; i < kPoints; ++i) {
        const double z = 2 * double(i) / double(kPoints) - 1, angle = double(i) * 2.399963;
        const double r = std::sqrt(1 - z * z), n[3] = {r * std::cos(angle), r * std::sin(angle), z};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            cloud->columns()[axis]->values<std::int32_t>()[i] = std::int32_t(100'000 * n[axis]);
            normal.columns[axis]->values<float>()[i] =
                i % 2 == 0 ? float(n[axis]) : float(-n[axis]);  // either side
        }
    }
    DisplaySettings display;
    display.attribute = "Normal";
    display.pointSize = 2;
    display.backgroundTop = display.backgroundBottom = {0, 0, 0, 0};
    Camera camera = cameraFor(*cloud, 320, 200);
    View view({filledStore(cloud)}, camera, display);
    for (int turn = 0; turn < 3; ++turn) {
        camera.orbit(1.1, 0.5);
        camera.fit(cloud->coordinates().toWorld(cloud->computeBounds()), {320, 200});
        view.renderer.setCamera(camera);
        view.converge();
        const Image& image = view.renderer.image();
        // Flat ground seen from the top is such a middle: not white.
        const Rgba8 middle = image.at(160, 100);
        QVERIFY2(middle.r > 180 && middle.r < 235 && middle.g == middle.r && middle.b == middle.r,
                 qPrintable(QString::number(middle.r)));
        int left = 0;
        while (image.at(left, 100).a == 0) ++left;
        const int radius = 160 - left, off = radius * 43 / 100;
        const int lamp = image.at(160 - off, 100 - off).r, away = image.at(160 + off * 3 / 2, 100 + off * 3 / 2).r;
        QVERIFY2(lamp > middle.r + 10, qPrintable(QString::number(lamp)));
        QVERIFY2(away < middle.r - 60, qPrintable(QString::number(away)));
    }
    display.normals = NormalLook::Direction;
    view.renderer.setDisplay(display);
    view.converge();
    std::set<std::uint32_t> colors;
    for (const Rgba8 c : view.renderer.image().pixels) colors.insert(std::bit_cast<std::uint32_t>(c));
    QVERIFY(colors.size() > 1000);
}

// Averages that are turned off and on, colors, selections and previews.
void StylesTest::averagesFollowChanges()
{
    QCOMPARE(test::averagesFollowChanges([] { return makeBackend(BackendKind::Cpu); },
                                         [](const Image& a, const Image& b, double covered) {
                                             return test::differing(a, b) >
                                                    0.001 * covered * double(a.pixels.size());
                                         }),
             std::string());
}

QTEST_GUILESS_MAIN(StylesTest)
#include "StylesTest.moc"
