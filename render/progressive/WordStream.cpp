// SPDX-License-Identifier: MIT
#include "render/progressive/WordStream.h"

#include "render/progressive/Clock.h"

#include <algorithm>
#include <shared_mutex>

namespace punctum::render
{

namespace
{

/// Points of one step of attribute streaming: one or two milliseconds.
constexpr PointIndex kStreamPoints = 1 << 19;

}  // namespace

bool WordStream::anyStale(const ViewClouds& clouds) noexcept
{
    return std::any_of(clouds.begin(), clouds.end(), [](const auto& cloud) { return cloud->store->stale(); });
}

bool WordStream::judgeColors(ViewClouds& clouds)
{
    bool any = false;
    for (const auto& cloud : clouds) {
        PointStore& store = *cloud->store;
        if (!store.encoder() || !store.colorsMisjudged()) continue;
        const std::shared_lock lock(store.cloud().mutex());
        store.show(store.shown());
        any = true;
    }
    return any;
}

bool WordStream::refreshVisible(ViewClouds& clouds, const FrameScene& scene, VisibilityBuffer& buffer)
{
    if (!anyStale(clouds) || !std::exchange(m_visibleOutdated, false)) return false;
    buffer.visibleIds(m_visible);
    std::vector<std::vector<Slot>> slots(scene.layers.size());
    for (const PointId id : m_visible)
        if (const auto place = scene.ids.find(id)) slots[place->layer].push_back(place->slot);
    for (std::size_t layer = 0; layer < clouds.size(); ++layer) {
        PointStore& store = *clouds[layer]->store;
        const std::shared_lock lock(store.cloud().mutex());
        store.refresh(slots[layer]);
    }
    return true;
}

bool WordStream::refreshRest(ViewClouds& clouds, double deadline)
{
    bool fresh = true;
    for (const auto& cloud : clouds) {
        while (cloud->store->stale() && now() < deadline) {
            const std::shared_lock lock(cloud->store->cloud().mutex());
            cloud->store->refreshNext(kStreamPoints);
        }
        fresh = fresh && !cloud->store->stale();
    }
    return fresh;
}

}  // namespace punctum::render
