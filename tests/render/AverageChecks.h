// SPDX-License-Identifier: MIT
#pragma once

#include "tests/render/RenderedView.h"

#include <functional>
#include <string>
#include <vector>

namespace punctum::test
{

/// What is averaged follows what changes, in the very next frame, without the camera being moved. `make`: the
/// backend that is tried. `different`: whether two pictures are not the same on it. Empty when all is right.
inline std::string averagesFollowChanges(
    const std::function<std::unique_ptr<render::RasterBackend>()>& make,
    const std::function<bool(const render::Image&, const render::Image&, double covered)>& different)
{
    using namespace render;
    constexpr int kWide = 200, kHigh = 130;
    const auto cloud = makeCloud(150'000);
    const auto store = filledStore(cloud);
    const Camera camera = cameraFor(*cloud, kWide, kHigh);
    DisplaySettings display;
    display.attribute = "Intensity";
    display.colorMap = "grey";
    display.averaged = true;
    RenderedView view(make(), {store}, camera, display, kWide, kHigh);
    view.converge(0.02);
    const Image averaged = view.renderer.image();
    const double covered = view.renderer.coveredShare();

    // Off shows the nearest points at once, and on again the means.
    DisplaySettings nearest = display;
    nearest.averaged = false;
    RenderedView plain(make(), {filledStore(cloud)}, camera, nearest, kWide, kHigh);
    plain.converge(0.02);
    const Image points = plain.renderer.image();
    if (!different(points, averaged, covered)) return "the two looks are the same";
    view.renderer.setDisplay(nearest);
    view.renderer.renderFrame(1.0);
    if (different(view.renderer.image(), points, covered)) return "means stay when they are off";
    view.renderer.setDisplay(display);
    view.converge(0.02);
    if (different(view.renderer.image(), averaged, covered)) return "means do not come back";

    // Colors of classes, changed while means are off.
    DisplaySettings classes = display;
    classes.attribute = "Classification";
    view.renderer.setDisplay(classes);
    view.converge(0.02);
    classes.averaged = false;
    view.renderer.setDisplay(classes);
    view.renderer.renderFrame(1.0);
    classes.averaged = true;
    for (auto& color : classes.palette) color = {1, 2, 200, 255};
    view.renderer.setDisplay(classes);
    view.renderer.renderFrame(1.0);
    for (const Rgba8& c : view.renderer.image().pixels)
        if (c.b != 200 && c.b > 60) return "old colors of classes";
    view.renderer.setDisplay(display);
    view.converge(0.02);

    // What is selected has a color of its own: nothing of the gray picture stays.
    const auto gray = [&] {
        int n = 0;
        for (const Rgba8& c : view.renderer.image().pixels) n += c.r == c.g && c.g == c.b;
        return n;
    };
    if (gray() < 1000) return "the picture is not gray";
    auto all = std::make_shared<PointSet>(cloud->size());
    for (PointIndex i = 0; i < cloud->size(); ++i) all->insert(i);
    view.renderer.setSelection(*cloud, all);
    view.renderer.renderFrame(0.0);
    if (gray() > 0) return std::to_string(gray()) + " px of the colors before selecting";
    view.converge(0.02);
    if (gray() > 0) return std::to_string(gray()) + " px of the colors before selecting, in the finished picture";
    view.renderer.setSelection(*cloud, nullptr);
    view.renderer.renderFrame(0.0);
    view.converge(0.02);
    if (different(view.renderer.image(), averaged, covered)) return "the selection stays";

    // A preview of what a change would mark.
    auto preview = std::make_shared<Preview>();
    Attribute shown = *cloud->findAttribute("Intensity");
    shown.columns[0] = std::make_shared<Column>("Intensity", shown.columns[0]->type(), cloud->size());
    preview->attributes = {shown};
    preview->points = all;
    view.renderer.setPreview(*cloud, preview);
    view.renderer.renderFrame(0.0);
    for (const Rgba8& c : view.renderer.image().pixels)
        if (c.r == c.g && c.g == c.b && c.r != view.renderer.image().pixels.front().r && c.r > 140)
            return "colors before the preview";
    view.renderer.setPreview(*cloud, nullptr);
    view.converge(0.02);
    if (different(view.renderer.image(), averaged, covered)) return "the preview stays";
    return {};
}

}  // namespace punctum::test
