// SPDX-License-Identifier: MIT
#include "render/store/Spacing.h"

#include "core/measure/Spacing.h"

#include <vector>

namespace punctum::render
{

double pointSpacing(const PointStore& store, const glm::dvec3& stretch)
{
    // Runs of slots are random subsets of the cloud.
    std::vector<glm::vec3> points;
    const PointCloud& cloud = store.cloud();
    const WorldBounds box = cloud.coordinates().toWorld(store.bounds());
    for (Slot slot = 0; slot < store.slotCount() && points.size() < kSpacingSamples; ++slot) {
        if (store.positions()[slot].x == 0) continue;
        const PointIndex index = store.order().indexOf(slot);
        if (index < cloud.size()) points.emplace_back((cloud.world(index) - box.min) * stretch);
    }
    return punctum::pointSpacing(points, store.filled());
}

}  // namespace punctum::render
