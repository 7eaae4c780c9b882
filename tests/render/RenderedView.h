// SPDX-License-Identifier: MIT
#pragma once

#include "render/backends/Backends.h"
#include "render/progressive/ProgressiveRenderer.h"
#include "tests/render/SyntheticCloud.h"

#include <climits>
#include <cmath>
#include <memory>
#include <random>
#include <utility>
#include <vector>

namespace punctum::test
{

/// A store that has all points of its cloud.
inline std::shared_ptr<render::PointStore> filledStore(const std::shared_ptr<PointCloud>& cloud,
                                                       render::OrderKind order = render::OrderKind::Stratified)
{
    auto store = std::make_shared<render::PointStore>(cloud, cloud->computeBounds(), order);
    store->fillAll();
    return store;
}

/// Sees all of a cloud, from above at a slant.
inline render::Camera cameraFor(const PointCloud& cloud, int width, int height)
{
    render::Camera camera;
    camera.yaw = 0.4;
    camera.fit(cloud.coordinates().toWorld(cloud.computeBounds()), {width, height});
    return camera;
}

/// A camera that sees some of a patch of 200 by 200 m.
inline render::Camera randomCamera(std::mt19937_64& random, const render::Camera& whole)
{
    const auto number = [&](double low, double high) {
        return low + (high - low) * double(random() >> 11) / double(std::uint64_t(1) << 53);
    };
    render::Camera camera = whole;
    camera.yaw = number(-3.2, 3.2);
    camera.pitch = number(-1.57, 0.5);
    camera.pivot = {number(0, 200), number(0, 200), number(-10, 20)};
    camera.eye = camera.pivot - camera.forward() * std::exp(number(0.0, 6.0));
    camera.orthographic = random() % 2 == 0;
    return camera;
}

/// The whole path of a picture, on any backend.
struct RenderedView {
    render::ProgressiveRenderer renderer;

    RenderedView(std::unique_ptr<render::RasterBackend> backend,
                 const std::vector<std::shared_ptr<render::PointStore>>& stores, const render::Camera& camera,
                 const render::DisplaySettings& display, int width, int height)
        : renderer(std::move(backend))
    {
        for (const auto& store : stores) add(store);
        renderer.setSize(width, height);
        renderer.setCamera(camera);
        renderer.setDisplay(display);
    }
    void add(const std::shared_ptr<render::PointStore>& store)
    {
        renderer.addCloud(store);
        renderer.loadingEnded(store->cloud(), store->cloud().computeBounds());
    }
    /// Frames until the picture is finished.
    int converge(double budget)
    {
        int frames = 1;
        while (!renderer.renderFrame(budget).converged && frames < 100'000) ++frames;
        return frames;
    }
    render::Image bruteForce()
    {
        renderer.renderBruteForce();
        return renderer.image();
    }
};

/// Seconds: many frames until convergence.
inline constexpr double kTinyBudget = 0.0005;

/// Drawn by the processor.
struct CpuView : RenderedView {
    CpuView(const std::vector<std::shared_ptr<render::PointStore>>& stores, const render::Camera& camera,
            const render::DisplaySettings& display)
        : RenderedView(render::makeBackend(render::BackendKind::Cpu), stores, camera, display, 320, 200)
    {
    }
    int converge(double budget = kTinyBudget) { return RenderedView::converge(budget); }
};

/// A cloud's layer in a picture of CpuView's size, as the renderer makes it.
inline render::Layer layerOf(const render::PointStore& store, const render::Camera& camera, const Clip& clip = {},
                             const render::PointStyle& style = {})
{
    render::Layer layer{&store, 0, render::makeProjection(camera, store, render::TargetSize{320, 200, 1}, style)};
    layer.clip = render::makeClip(clip, store, layer.projection.reference);
    return layer;
}

/// Pixels that are not the same in both.
inline int differing(const render::Image& a, const render::Image& b)
{
    if (a.width != b.width || a.height != b.height) return INT_MAX;
    int n = 0;
    for (std::size_t k = 0; k < a.pixels.size(); ++k) n += !(a.pixels[k] == b.pixels[k]);
    return n;
}

}  // namespace punctum::test
