// SPDX-License-Identifier: MIT
#include "render/backends/BackendChoice.h"

#include "core/Error.h"
#include "render/backends/Backends.h"
#include "render/gl/EglContext.h"
#include "render/gl/GlObjects.h"
#include "render/progressive/ProgressiveRenderer.h"

#include <algorithm>
#include <memory>

namespace punctum::render
{

namespace
{

/// Enough that starting a draw does not count, few enough for a software renderer.
constexpr PointIndex kPoints = 1 << 19;
constexpr int kWidth = 1280, kHeight = 800;
/// Drawn in each frame beside what was visible: some, so that there are holes.
constexpr PointIndex kFramePoints = kPoints / 4;
constexpr double kTurn = 0.02;  ///< radians a frame
constexpr int kMostFrames = 20;
constexpr double kEnough = 0.2;  ///< s of frames
/// A device must be so much faster than the processor: points have to be brought to it, and pictures back.
constexpr double kWorthwhile = 1.2;

/// A rough square, its points in no order.
std::shared_ptr<PointStore> makeStore()
{
    const auto cloud = std::make_shared<PointCloud>(kPoints, CoordinateScale{glm::dvec3(0.001), glm::dvec3(0.0)});
    std::span<std::int32_t> raw[3];
    for (int axis = 0; axis < 3; ++axis) {
        Attribute a;
        a.name = std::string(1, char('X' + axis));
        a.standard = a.scaled = true;
        a.scale = 0.001;
        a.columns[0] = cloud->addColumn(std::make_shared<Column>(a.name, ScalarType::I32, kPoints));
        raw[axis] = a.columns[0]->values<std::int32_t>();
        cloud->addAttribute(a);
    }
    std::uint32_t state = 1;
    const auto random = [&state](std::uint32_t range) {
        state = state * 1664525u + 1013904223u;  // Numerical Recipes; looks do not matter
        return std::int32_t(state >> 8) % std::int32_t(range);
    };
    for (PointIndex i = 0; i < kPoints; ++i) {
        raw[0][i] = random(1'000'000);
        raw[1][i] = random(1'000'000);
        raw[2][i] = random(50'000);
    }
    auto store = std::make_shared<PointStore>(cloud, cloud->computeBounds());
    store->fillAll();
    return store;
}

/// Points a second, of frames in motion; less than `least` is found out early, and then inexactly.
double measure(BackendKind kind, const std::shared_ptr<PointStore>& store, const MeasuredLook& look, double least)
{
    DisplaySettings display = look.display;
    display.attribute.clear();
    display.range.reset();
    display.clip = {};
    display.classVisible.fill(true);
    display.averaged = false;                                                         // frames in motion never are
    if (display.sizing == PointSizing::World) display.sizing = PointSizing::Density;  // a length in this cloud
    Camera camera;
    camera.setView("iso");
    camera.fit(store->cloud().coordinates().toWorld(store->bounds()), {kWidth, kHeight});
    ProgressiveRenderer renderer(makeBackend(kind));
    renderer.keepOnDevice(look.keepOnDevice);
    renderer.setDisplay(display);
    renderer.setSize(kWidth, kHeight);
    renderer.addCloud(store);
    renderer.loadingEnded(store->cloud(), store->bounds());
    renderer.setPointsAFrame(kFramePoints);
    double seconds = 0;
    const auto frame = [&] {
        camera.orbit(kTurn, 0.0);
        renderer.setCamera(camera);
        const FrameReport report = renderer.renderFrame(1.0);
        seconds += report.seconds;
        return report.filled;
    };
    // The first brings points to the device and compiles shaders.
    frame();
    seconds = 0;
    PointIndex drawn = frame();
    if (double(drawn) / seconds < least / 4) return double(drawn) / seconds;
    for (int k = 0; k < 2 || (k < kMostFrames && seconds < kEnough); ++k) drawn += frame();
    return double(drawn) / seconds;
}

}  // namespace

BackendMeasurement measureBackends(const MeasuredLook& look, const std::optional<std::string>& knownDevice)
{
    BackendMeasurement result;
    EglContext context;
    try {
        context = EglContext::create();
        const GlInfo info = requireGl43();
        result.device = info.renderer + ", " + info.driver;
    } catch (const Error&) {
        // no OpenGL, or too old a one: the processor draws
    }
    if (knownDevice == result.device) return result;
    const std::shared_ptr<PointStore> store = makeStore();
    double best = 0;
    for (const BackendKind kind : kBackendKinds) {
        if (needsGl(kind) && result.device.empty()) continue;
        try {
            const double rate = measure(kind, store, look, best);
            result.rates.push_back({kind, rate});
            if (best == 0 || rate > best * (result.fastest == BackendKind::Cpu ? kWorthwhile : 1.0)) {
                best = rate;
                result.fastest = kind;
            }
        } catch (const Error&) {
            // it does not work here
        }
    }
    return result;
}

}  // namespace punctum::render
