// SPDX-License-Identifier: MIT
#include "render/store/Spacing.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace punctum::render
{

namespace
{

constexpr PointIndex kSamples = 4096;
constexpr std::size_t kFewest = 16;

}  // namespace

double pointSpacing(const PointStore& store, const glm::dvec3& stretch)
{
    // Runs of slots are random subsets of the cloud.
    std::vector<glm::vec3> points;
    const PointCloud& cloud = store.cloud();
    const WorldBounds box = cloud.coordinates().toWorld(store.bounds());
    for (Slot slot = 0; slot < store.slotCount() && points.size() < kSamples; ++slot) {
        if (store.positions()[slot].x == 0) continue;
        const PointIndex index = store.order().indexOf(slot);
        if (index < cloud.size()) points.emplace_back((cloud.world(index) - box.min) * stretch);
    }
    if (points.size() < kFewest) return 0;
    std::vector<float> nearest(points.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size(), 64), [&](const auto& r) {
        for (std::size_t i = r.begin(); i != r.end(); ++i) {
            float least = std::numeric_limits<float>::max();
            for (std::size_t k = 0; k < points.size(); ++k) {
                const glm::vec3 d = points[k] - points[i];
                const float squared = d.x * d.x + d.y * d.y + d.z * d.z;
                // points in one place, such as returns of no length, are no neighbors
                least = squared > 0 && squared < least ? squared : least;
            }
            nearest[i] = least;
        }
    });
    const auto middle = nearest.begin() + std::ptrdiff_t(nearest.size() / 2);
    std::nth_element(nearest.begin(), middle, nearest.end());
    if (*middle == std::numeric_limits<float>::max()) return 0;
    const double expected = std::sqrt(std::numbers::ln2 / std::numbers::pi);
    return std::sqrt(double(*middle)) / expected * std::sqrt(double(points.size()) / double(store.filled()));
}

}  // namespace punctum::render
