// SPDX-License-Identifier: MIT
#include "render/store/Spacing.h"

#include "core/measure/Spacing.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace punctum::render
{

namespace
{

constexpr std::size_t kFewestSamples = 256;  ///< of a cloud among many: the median is off by some percent then

}  // namespace

double pointSpacing(const PointStore& store, const glm::dvec3& stretch, std::size_t clouds)
{
    // The time goes with the square of their number.
    const auto share = std::size_t(double(kSpacingSamples) / std::sqrt(double(std::max<std::size_t>(clouds, 1))));
    const std::size_t most = std::max(kFewestSamples, share);
    // Runs of slots are random subsets of the cloud.
    std::vector<glm::vec3> points;
    const PointCloud& cloud = store.cloud();
    const WorldBounds box = cloud.coordinates().toWorld(store.bounds());
    for (Slot slot = 0; slot < store.slotCount() && points.size() < most; ++slot) {
        if (store.positions()[slot].x == 0) continue;
        const PointIndex index = store.order().indexOf(slot);
        if (index < cloud.size()) points.emplace_back((cloud.world(index) - box.min) * stretch);
    }
    return punctum::pointSpacing(points, store.filled());
}

}  // namespace punctum::render
