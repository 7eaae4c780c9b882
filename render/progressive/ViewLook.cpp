// SPDX-License-Identifier: MIT
#include "render/progressive/ViewLook.h"

#include "render/progressive/FrameScheduler.h"
#include "render/progressive/SharedLegend.h"
#include "render/store/Spacing.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <memory>
#include <shared_mutex>

namespace punctum::render
{

namespace
{

/// px, while the spacing is guessed from a part of the points.
constexpr double kMostGuessedSize = 4.0;

/// What a slot costs that is out of sight, next to one that is drawn.
constexpr double kUnseenCost = 0.01;

/// A lamp up and left of the eye, as maps have it: what is seen from the top is not all white then.
glm::vec3 lampOf(const Camera& camera)
{
    return glm::vec3(glm::normalize(camera.forward() + 0.55 * camera.right() - 0.55 * camera.up()));
}

PointStyle styleOf(ViewCloud& cloud, const ViewLook& look, std::size_t clouds)
{
    PointStyle style{look.display.leastPixels(), 0.0, look.display.round};
    if (look.display.sizing == PointSizing::World) style.size = look.display.worldSize;
    if (look.display.sizing != PointSizing::Density) return style;
    const PointIndex filled = cloud.store->filled();
    const bool grown = filled > cloud.filledAtSpacing + cloud.filledAtSpacing / 2;
    if (grown || (filled != cloud.filledAtSpacing && !cloud.loading) ||
        cloud.spacingStretch != look.camera.stretch) {
        const std::shared_lock lock(cloud.store->cloud().mutex());
        cloud.spacing = pointSpacing(*cloud.store, look.camera.stretch, clouds);
        cloud.filledAtSpacing = filled;
        cloud.spacingStretch = look.camera.stretch;
    }
    style.size = cloud.spacing * look.display.spacings;
    // Of a part of the points, the spacing is a guess, and larger than it will be: no blocks while a file loads.
    if (cloud.loading) style.most = kMostGuessedSize;
    return style;
}

}  // namespace

int samplesOf(const DisplaySettings& display) noexcept
{
    return *std::find_if(kSampleCounts.rbegin(), kSampleCounts.rend() - 1,
                         [&](int count) { return count <= display.samples; });
}

void makeScene(ViewClouds& clouds, const ViewLook& look, const TargetSize& size, bool partly, FrameScene& scene)
{
    scene.clear();
    Clip clip = look.display.clip;
    clip.planes.insert(clip.planes.end(), look.display.cuts.begin(), look.display.cuts.end());
    const PicturePart part = look.part.value_or(PicturePart{0, 0, size.width, size.height});
    WorldBounds all;
    for (const auto& cloud : clouds)
        all.include(cloud->store->cloud().coordinates().toWorld(cloud->store->bounds()));
    const auto& shown = look.display.classVisible;
    const bool allClasses = std::all_of(shown.begin(), shown.end(), [](bool visible) { return visible; });
    for (const auto& cloud : clouds) {
        scene.add({cloud->store.get(), 0,
                   makeProjection(look.camera, *cloud->store, part, styleOf(*cloud, look, clouds.size()), all)});
        Layer& layer = scene.layers.back();
        layer.clip = makeClip(clip, *cloud->store, layer.projection.reference);
        cloud->weight = 1.0;
        cloud->partly = false;
        // How many of a stretch's points are hidden, or cut off, nobody knows before they are looked at.
        const bool hides = layer.clip.on || cloud->store->hidesAny() || !allClasses;
        const Detail detail = partly && !hides && cloud->store->beyondMemory() ? Detail::OfScreen : Detail::All;
        // While a file loads the boxes still grow. Of what is drawn partly, they are looked at anew with each pass.
        const bool growing = !cloud->store->full();
        if (detail == Detail::All && growing) continue;
        const auto visible = std::make_shared<const VisibleStretches>(layer, size, detail);
        if (growing && !visible->partly()) continue;
        cloud->weight = std::min(1.0, visible->share() + kUnseenCost);
        cloud->partly = visible->partly();
        if (!visible->all()) layer.visible = visible;
    }
    scene.classVisible = shown;
    scene.allClassesVisible = allClasses;
}

ResolveSettings colorsOf(const ViewClouds& clouds, const ViewLook& look)
{
    ResolveSettings settings;
    for (const auto& cloud : clouds) {
        LayerColors colors;
        if (const auto encoder = cloud->store->encoder()) {
            colors.kind = encoder->kind();
            colors.low = float(cloud->range.first - encoder->bias());
            colors.high = float(cloud->range.second - encoder->bias());
            colors.marked = encoder->selection() != nullptr;
        }
        settings.layers.push_back(colors);
    }
    settings.colorMap =
        banded(chosenColorMap(look.display.colorMap, SharedLegend::shownAttribute(clouds, look.display)).table,
               look.display.bands);
    settings.palette = look.display.palette;
    settings.normals = look.display.normals;
    settings.eye = glm::vec3(look.camera.forward());
    settings.light = lampOf(look.camera);
    settings.tone = toneTable(look.display.tone);
    settings.backgroundTop = look.display.backgroundTop;
    settings.backgroundBottom = look.display.backgroundBottom;
    if (look.part) settings.rows = {look.part->y, look.part->height};
    if (!look.part || look.partExtent > 0)
        settings.eyeDome = {float(look.display.eyeDome), !look.camera.orthographic, look.display.eyeDomeReach(),
                            look.part ? look.partExtent : 0.0f};
    settings.closeHoles = look.display.fillHoles && FrameScheduler::partial(clouds);
    return settings;
}

}  // namespace punctum::render
