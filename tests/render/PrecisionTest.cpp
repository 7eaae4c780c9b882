// SPDX-License-Identifier: MIT
#include "core/Error.h"
#include "render/backends/Backends.h"
#include "render/gl/EglContext.h"
#include "tests/render/RenderedView.h"

#include <QTest>

#include <cmath>

using namespace punctum;
using namespace punctum::render;

namespace
{

constexpr int kWidth = 640, kHeight = 480;
constexpr std::int32_t kLinePoints = 81;
/// Between two points of the line, in steps of the file's grid: exactly straight, however the numbers are stored.
constexpr glm::i64vec3 kStep{3, 1, 2};

}  // namespace

/// Straight lines are straight where coordinates are large, extents are large and steps are small.
class PrecisionTest : public QObject
{
    Q_OBJECT

private Q_SLOTS:
    void linesAreStraight_data();
    void linesAreStraight();
};

void PrecisionTest::linesAreStraight_data()
{
    QTest::addColumn<bool>("degrees");
    QTest::addColumn<double>("scale");
    QTest::addColumn<double>("offset");
    QTest::addColumn<int>("extent");  // steps of the grid, on each side of the line
    QTest::addColumn<bool>("orthographic");
    QTest::addColumn<int>("backend");
    const struct {
        const char* name;
        bool degrees;
        double scale, offset;
        int extent;
    } clouds[] = {{"at 5,000,000 m", false, 0.001, 5e6, 2000},
                  {"100 km wide", false, 0.001, 3e5, 50'000'000},
                  {"1000 km wide", false, 0.001, 3e5, 500'000'000},
                  {"4000 km wide, the whole of the integers", false, 0.001, 0, 2'000'000'000},
                  {"in degrees", true, 1e-8, 47.0, 2000},
                  {"in degrees, 10 wide", true, 1e-8, 47.0, 500'000'000},
                  {"a scale of 1e-9", false, 1e-9, 15.0, 100'000}};
    for (const auto& cloud : clouds)
        for (const bool orthographic : {false, true})
            for (const BackendKind backend : kBackendKinds)
                QTest::addRow("%s%s, %s", cloud.name, orthographic ? ", orthographic" : "",
                              std::string(nameOf(backend)).c_str())
                    << cloud.degrees << cloud.scale << cloud.offset << cloud.extent << orthographic << int(backend);
}

// A line through the middle of the cloud, so near that a step of the grid is 2 px. Each of its points must be drawn
// in the pixel where arithmetic in double puts it, give or take a rounding at the pixel's edge. Where the integers
// span more than 2^30 steps the store keeps every second to fourth: there the grid is seen, and no more than that.
void PrecisionTest::linesAreStraight()
{
    QFETCH(bool, degrees);
    QFETCH(double, scale);
    QFETCH(double, offset);
    QFETCH(int, extent);
    QFETCH(bool, orthographic);
    QFETCH(int, backend);
    EglContext context;
    if (needsGl(BackendKind(backend))) {
        try {
            context = EglContext::create();
        } catch (const Error& e) {
            QSKIP(e.what());
        }
    }
    const glm::dvec3 origin =
        degrees ? glm::dvec3(offset / 2, offset, 300) : glm::dvec3(offset, -2 * offset, offset / 3);
    const auto cloud = test::makeCloud(kLinePoints + 2, {{scale, scale, degrees ? 0.001 : scale}, origin});
    std::span<std::int32_t> raw[3];
    for (std::size_t axis = 0; axis < 3; ++axis) raw[axis] = cloud->columns()[axis]->values<std::int32_t>();
    for (std::int32_t k = 0; k < kLinePoints; ++k)
        for (std::size_t axis = 0; axis < 3; ++axis)
            raw[axis][std::size_t(k)] =
                std::int32_t(std::int64_t(k - kLinePoints / 2) * kStep[int(axis)]) + extent / 100;
    for (std::size_t axis = 0; axis < 3; ++axis) {  // what makes the cloud so large; outside of the picture
        raw[axis][kLinePoints] = -extent;
        raw[axis][kLinePoints + 1] = extent;
    }
    const auto store = test::filledStore(cloud);

    Camera camera;
    camera.yaw = 0.3;
    camera.pitch = -0.4;
    camera.orthographic = orthographic;
    if (degrees)
        camera.stretch =
            trueLengths(CoordinateUnits::degreesAndMeters(), cloud->coordinates().toWorld(cloud->computeBounds()))
                .stretch;
    camera.pivot = cloud->world(kLinePoints / 2);
    const double step = scale * camera.stretch.y;  // view units; 2 px at the pivot
    camera.eye =
        camera.pivot - camera.forward() * (step * kHeight / 2 / (2 * std::tan(camera.fovY / 2))) / camera.stretch;
    DisplaySettings display;
    display.backgroundTop = display.backgroundBottom = {0, 0, 0, 0};
    test::RenderedView view(makeBackend(BackendKind(backend)), {store}, camera, display, kWidth, kHeight);
    const Image image = view.bruteForce();

    const double tolerance = store->frame().shift == 0 ? 0.01 : 2.0 * double(1 << store->frame().shift);
    int inPicture = 0;
    double worst = 0;
    for (PointIndex i = 0; i < PointIndex(kLinePoints); ++i) {
        const glm::dvec3 px = camera.project(cloud->world(i), {kWidth, kHeight});
        if (px.z <= 0 || px.x < 8 || px.y < 8 || px.x >= kWidth - 8 || px.y >= kHeight - 8) continue;
        ++inPicture;
        double nearest = 1e9;  // distance to the nearest pixel that shows a point; 0 inside it
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) {
                if (image.at(x, y).a == 0) continue;
                const double dx = std::max({x - px.x, px.x - x - 1, 0.0}),
                             dy = std::max({y - px.y, px.y - y - 1, 0.0});
                nearest = std::min(nearest, std::hypot(dx, dy));
            }
        worst = std::max(worst, nearest);
    }
    QVERIFY2(inPicture > kLinePoints / 4, qPrintable(QString::number(inPicture)));
    QVERIFY2(worst <= tolerance, qPrintable(QString("a point is %1 px from its place").arg(worst)));
}

QTEST_APPLESS_MAIN(PrecisionTest)
#include "PrecisionTest.moc"
