// SPDX-License-Identifier: MIT
#include "render/raster/BackendChoice.h"

#include "core/Error.h"
#include "render/camera/Projection.h"
#include "render/gl/EglContext.h"
#include "render/gl/GlObjects.h"

#include <algorithm>
#include <chrono>
#include <memory>

namespace punctum::render
{

namespace
{

/// Enough that starting a draw does not count, few enough for a software renderer.
constexpr PointIndex kPoints = 1 << 19;
constexpr TargetSize kSize{1280, 800, 1};
/// Passes over the points; a picture is made after the last, as it is in a frame.
constexpr int kPasses = 4;
/// A device must be so much faster than the processor: points have to be brought to it, and pictures back.
constexpr double kWorthwhile = 1.2;

double now()
{
    using namespace std::chrono;
    return duration<double>(steady_clock::now().time_since_epoch()).count();
}

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

/// Points a second; less than `least` is found out early, and then inexactly.
double measure(RasterBackend& backend, const PointStore& store, double least)
{
    Camera camera;
    camera.setView("iso");
    camera.fit(store.cloud().coordinates().toWorld(store.bounds()), {kSize.width, kSize.height});
    FrameScene scene;
    scene.layers.push_back({&store, 0, makeProjection(camera, store, kSize)});
    scene.classVisible.fill(true);
    scene.allClassesVisible = true;
    ResolveSettings settings;
    settings.layers.resize(1);
    Image image;
    backend.setTarget(kSize);
    const auto pass = [&](Slot slots) {
        const double started = now();
        backend.clear();
        backend.draw(scene, 0, {0, slots});
        backend.finish();
        return double(slots) / (now() - started);
    };
    // The first times bring points to the device and compile shaders.
    const Slot few = std::min<Slot>(store.slotCount(), PointStore::kBlockSlots);
    pass(few);
    if (const double rate = pass(few); rate < least / 4) return rate;
    pass(store.slotCount());
    backend.resolve(scene, settings, image);
    const double started = now();
    for (int k = 0; k < kPasses; ++k) pass(store.slotCount());
    backend.resolve(scene, settings, image);
    return double(kPoints) * kPasses / (now() - started);
}

}  // namespace

BackendMeasurement measureBackends(const std::optional<std::string>& knownDevice)
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
            const double rate = measure(*makeBackend(kind), *store, best);
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
