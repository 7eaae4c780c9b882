// SPDX-License-Identifier: MIT
#include "core/cloud/Section.h"

#include "core/cloud/BlockBoxes.h"
#include "core/cloud/Slabs.h"
#include "core/task/Progress.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <mutex>

namespace punctum
{

namespace
{

/// How far the slab reaches beyond the ends of its line, as a share of its length: planes are tested in float.
constexpr double kSlack = 1e-6;

}  // namespace

bool Section::usable() const noexcept
{
    const double l = length();
    return std::isfinite(l) && l > 0.0 && std::isfinite(width) && width > 0.0;
}

double Section::length() const noexcept
{
    return glm::length((to - from) * glm::dvec2(stretch));
}

glm::dvec2 Section::along() const noexcept
{
    return (to - from) * glm::dvec2(stretch) / length();
}

glm::dvec2 Section::ahead() const noexcept
{
    const glm::dvec2 a = along();
    return {-a.y, a.x};
}

glm::dvec2 Section::placeOf(const glm::dvec3& world) const noexcept
{
    const glm::dvec2 offset = (glm::dvec2(world) - from) * glm::dvec2(stretch);
    return {glm::dot(offset, along()), glm::dot(offset, ahead())};
}

std::array<glm::dvec2, 4> Section::corners() const noexcept
{
    const glm::dvec2 half = ahead() * (width / 2) / glm::dvec2(stretch);
    return {from - half, to - half, to + half, from + half};
}

std::array<ClipPlane, 4> Section::sides() const noexcept
{
    // dot(direction, p * stretch) >= distance, for a place p on the plane
    const auto side = [&](const glm::dvec2& direction, const glm::dvec2& place) {
        const glm::dvec2 normal = direction * glm::dvec2(stretch);
        return ClipPlane{{normal, 0.0}, glm::dot(normal, place)};
    };
    const auto corner = corners();
    const glm::dvec2 slack = (to - from) * kSlack;
    return {side(ahead(), corner[0]), side(-ahead(), corner[2]), side(along(), from - slack),
            side(-along(), to + slack)};
}

Section Section::walked(double distance) const noexcept
{
    const glm::dvec2 step = ahead() * distance / glm::dvec2(stretch);
    Section next = *this;
    next.from += step;
    next.to += step;
    return next;
}

Section Section::turned() const noexcept
{
    Section other = *this;
    std::swap(other.from, other.to);
    return other;
}

WorldBounds Section::box(double low, double high) const noexcept
{
    return {{glm::min(from, to), low}, {glm::max(from, to), high}};
}

void ShownHeights::include(const ShownHeights& other) noexcept
{
    if (other.points == 0) return;
    low = points == 0 ? other.low : std::min(low, other.low);
    high = points == 0 ? other.high : std::max(high, other.high);
    points += other.points;
}

ShownHeights shownHeights(const PointCloud& cloud, const PointSet* hidden, Progress& progress)
{
    PointIndex points = 0;
    std::int32_t low = INT32_MAX, high = INT32_MIN;
    std::mutex gate;
    const auto z = cloud.rawZ();
    const auto boxes = cloud.boxes();
    progress.begin("Finding heights", cloud.size());
    forEachSlab(cloud, progress, [&](std::size_t firstWord, std::size_t lastWord) {
        PointIndex count = 0;
        std::int32_t least = INT32_MAX, most = INT32_MIN;
        forStretches(firstWord, lastWord, [&](std::size_t stretch, std::size_t first, std::size_t last) {
            const PointIndex shown = shownIn(cloud.size(), hidden, first, last);
            if (shown == 0) return;
            count += shown;
            const RawBounds box = (*boxes)[stretch];
            if (box.min.z >= least && box.max.z <= most) return;
            if (shown == boxes->points(stretch).size()) {  // there are points at the least and the greatest height
                least = std::min(least, std::int32_t(box.min.z));
                most = std::max(most, std::int32_t(box.max.z));
                return;
            }
            for (std::size_t w = first; w != last; ++w)
                for (std::uint64_t bits = shownBits(cloud.size(), hidden, w); bits != 0; bits &= bits - 1) {
                    const std::int32_t value = z[w * 64 + std::size_t(std::countr_zero(bits))];
                    least = std::min(least, value);
                    most = std::max(most, value);
                }
        });
        const std::lock_guard lock(gate);
        points += count;
        low = std::min(low, least);
        high = std::max(high, most);
    });
    if (points == 0) return {};
    const CoordinateScale& grid = cloud.coordinates();
    const double a = grid.toWorld(glm::dvec3(low)).z, b = grid.toWorld(glm::dvec3(high)).z;
    return {points, std::min(a, b), std::max(a, b)};  // a scale may be negative
}

}  // namespace punctum
