// SPDX-License-Identifier: MIT
#include "core/cloud/Visibility.h"

#include "core/cloud/Slabs.h"
#include "core/task/Progress.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <shared_mutex>

namespace punctum
{

namespace
{

constexpr double kStepShare = 1e-6;

}  // namespace

RawBounds rawInside(const WorldBounds& box, const CoordinateScale& coordinates) noexcept
{
    // Within what a double holds exactly; raw coordinates are 32 bits.
    constexpr double kLimit = 4e15;
    const glm::dvec3 a = coordinates.toRaw(box.min), b = coordinates.toRaw(box.max);
    RawBounds raw;
    for (int axis = 0; axis < 3; ++axis) {
        const double low = std::min(a[axis], b[axis]),
                     high = std::max(a[axis], b[axis]);  // a scale may be negative
        raw.min[axis] = std::int64_t(std::clamp(std::ceil(low - kStepShare), -kLimit, kLimit));
        raw.max[axis] = std::int64_t(std::clamp(std::floor(high + kStepShare), -kLimit, kLimit));
    }
    return raw;
}

std::shared_ptr<PointSet> hiddenPoints(const PointCloud& cloud, const Visibility& visibility, Progress& progress,
                                       const PointSet* among)
{
    const bool allClasses = std::all_of(visibility.classVisible.begin(), visibility.classVisible.end(),
                                        [](bool visible) { return visible; });
    std::optional<Attribute> classes;
    if (!allClasses) {
        const std::shared_lock lock(cloud.mutex());
        if (const Attribute* const found = cloud.findAttribute("Classification")) classes = *found;
    }
    const auto deleted = deletedPoints(cloud);
    if (!classes && !visibility.clip.any() && !visibility.filtered && !deleted) return nullptr;
    auto set = deleted ? std::make_shared<PointSet>(*deleted) : std::make_shared<PointSet>(cloud.size());
    if (!classes && !visibility.clip.any() && !visibility.filtered) return set;
    const auto words = set->words();
    progress.begin("Finding hidden points", cloud.size());
    const RawBounds inside =
        visibility.clip.box ? rawInside(*visibility.clip.box, cloud.coordinates()) : RawBounds{};
    const auto x = cloud.rawX(), y = cloud.rawY(), z = cloud.rawZ();
    forEachSlab(cloud, progress, [&](std::size_t firstWord, std::size_t lastWord) {
        std::uint8_t codes[64];
        for (std::size_t w = firstWord; w != lastWord; ++w) {
            if (among != nullptr && among->words()[w] == 0) continue;
            const PointRange range{w * 64, std::min<PointIndex>(cloud.size(), w * 64 + 64)};
            std::uint64_t hidden = 0;
            if (visibility.filtered && w < visibility.filtered->words().size())
                hidden = visibility.filtered->words()[w];
            if (classes) classes->gatherBits(range, codes);
            for (PointIndex i = range.first; i < range.last; ++i) {
                bool out = classes && !visibility.classVisible[codes[i - range.first]];
                if (visibility.clip.box)
                    out |= (x[i] < inside.min.x) | (x[i] > inside.max.x) | (y[i] < inside.min.y) |
                           (y[i] > inside.max.y) | (z[i] < inside.min.z) | (z[i] > inside.max.z);
                for (const ClipPlane& plane : visibility.clip.planes)
                    out |= glm::dot(plane.normal, cloud.world(i)) < plane.distance;
                hidden |= std::uint64_t(out) << (i - range.first);
            }
            words[w] |= hidden;
        }
    });
    return set;
}

}  // namespace punctum
