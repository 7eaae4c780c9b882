// SPDX-License-Identifier: MIT
#include "core/cloud/Visibility.h"

#include "core/cloud/BlockBoxes.h"
#include "core/cloud/LinearSide.h"
#include "core/cloud/Slabs.h"
#include "core/task/Progress.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <shared_mutex>
#include <span>
#include <vector>

namespace punctum
{

namespace
{

constexpr double kStepShare = 1e-6;
constexpr double kClipRounding = 1e-12;  ///< of a few operations in double, as a share of their terms

/// What a clip says of single points, and of boxes of points.
class ClipTest
{
public:
    ClipTest(const Clip& clip, const PointCloud& cloud)
        : m_clip(clip),
          m_cloud(cloud),
          m_x(cloud.rawX()),
          m_y(cloud.rawY()),
          m_z(cloud.rawZ()),
          m_inside(clip.box ? rawInside(*clip.box, cloud.coordinates()) : RawBounds{})
    {
        const CoordinateScale& grid = cloud.coordinates();
        for (const ClipPlane& plane : clip.planes) {
            LinearSide& side = m_sides.emplace_back(plane.normal * grid.scale, -plane.distance);
            for (int axis = 0; axis < 3; ++axis) side.add(plane.normal[axis] * grid.offset[axis]);
        }
    }

    /// Whether all points of the box are outside, or all inside.
    LinearSide::Box of(const RawBounds& box) const
    {
        auto all = LinearSide::Box::Inside;
        if (m_clip.box) {
            if (!m_inside.meets(box)) return LinearSide::Box::Outside;
            if (!m_inside.holds(box)) all = LinearSide::Box::Across;
        }
        for (const LinearSide& side : m_sides) {
            const auto part = side.of(glm::dvec3(box.min), glm::dvec3(box.max), kClipRounding);
            if (part == LinearSide::Box::Outside) return part;
            if (part == LinearSide::Box::Across) all = part;
        }
        return all;
    }

    bool cuts(PointIndex i) const
    {
        bool out = false;
        if (m_clip.box)
            out = (m_x[i] < m_inside.min.x) | (m_x[i] > m_inside.max.x) | (m_y[i] < m_inside.min.y) |
                  (m_y[i] > m_inside.max.y) | (m_z[i] < m_inside.min.z) | (m_z[i] > m_inside.max.z);
        for (const ClipPlane& plane : m_clip.planes)
            out |= glm::dot(plane.normal, m_cloud.world(i)) < plane.distance;
        return out;
    }

private:
    const Clip& m_clip;
    const PointCloud& m_cloud;
    std::span<const std::int32_t> m_x, m_y, m_z;
    RawBounds m_inside;
    std::vector<LinearSide> m_sides;  ///< of raw coordinates
};

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
    const ClipTest clip(visibility.clip, cloud);
    const auto boxes = visibility.clip.any() ? cloud.boxes() : nullptr;
    forEachSlab(cloud, progress, [&](std::size_t firstWord, std::size_t lastWord) {
        std::uint8_t codes[64];
        forStretches(firstWord, lastWord, [&](std::size_t stretch, std::size_t first, std::size_t last) {
            const auto place = boxes ? clip.of((*boxes)[stretch]) : LinearSide::Box::Inside;
            for (std::size_t w = first; w != last; ++w) {
                if (among != nullptr && among->words()[w] == 0) continue;
                const PointRange range{w * 64, std::min<PointIndex>(cloud.size(), w * 64 + 64)};
                if (place == LinearSide::Box::Outside) {
                    words[w] |= ~std::uint64_t(0) >> (64 - range.size());
                    continue;
                }
                std::uint64_t hidden = 0;
                if (visibility.filtered && w < visibility.filtered->words().size())
                    hidden = visibility.filtered->words()[w];
                if (classes) {
                    classes->gatherBits(range, codes);
                    for (PointIndex i = range.first; i < range.last; ++i)
                        hidden |= std::uint64_t(!visibility.classVisible[codes[i - range.first]])
                                  << (i - range.first);
                }
                if (place == LinearSide::Box::Across)
                    for (PointIndex i = range.first; i < range.last; ++i)
                        hidden |= std::uint64_t(clip.cuts(i)) << (i - range.first);
                if (hidden != 0) words[w] |= hidden;
            }
        });
    });
    return set;
}

}  // namespace punctum
