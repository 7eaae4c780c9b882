// SPDX-License-Identifier: MIT
#include "core/measure/Spacing.h"

#include "core/task/Progress.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <shared_mutex>

namespace punctum
{

namespace
{

constexpr std::size_t kFewest = 16;
constexpr PointIndex kTries = 64;  ///< points in a row that are looked at for one that is not deleted

}  // namespace

double pointSpacing(const std::vector<glm::vec3>& sample, PointIndex points)
{
    if (sample.size() < kFewest || points == 0) return 0;
    std::vector<float> nearest(sample.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, sample.size(), 64), [&](const auto& r) {
        for (std::size_t i = r.begin(); i != r.end(); ++i) {
            float least = std::numeric_limits<float>::max();
            for (std::size_t k = 0; k < sample.size(); ++k) {
                const glm::vec3 d = sample[k] - sample[i];
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
    return std::sqrt(double(*middle)) / expected * std::sqrt(double(sample.size()) / double(points));
}

double pointSpacing(const PointCloud& cloud, const glm::dvec3& stretch, Progress& progress)
{
    std::vector<glm::vec3> sample;
    PointIndex living = cloud.size();
    {
        const std::shared_lock lock(cloud.mutex());
        const PointSet* const deleted = cloud.deleted().get();
        if (deleted != nullptr) living -= deleted->count();
        const PointIndex wanted = std::min<PointIndex>(cloud.size(), kSpacingSamples);
        glm::dvec3 origin(0.0);
        for (PointIndex k = 0; k < wanted; ++k) {
            // One of each run of points, not always the same one: scan lines repeat, and must not beat with it.
            const PointIndex first = k * cloud.size() / wanted, last = (k + 1) * cloud.size() / wanted;
            const std::uint64_t hash = (std::uint64_t(k) + 1) * 0x9E3779B97F4A7C15u;
            PointIndex i = first + (hash >> 32) % (last - first);
            if (deleted != nullptr) {
                const PointIndex end = std::min(last, i + kTries);
                while (i < end && deleted->contains(i)) ++i;
                if (i == end) continue;
            }
            if (sample.empty()) origin = cloud.world(i);
            sample.emplace_back((cloud.world(i) - origin) * stretch);
        }
    }
    progress.check();
    return pointSpacing(sample, living);
}

double roundLength(double length) noexcept
{
    if (!(length > 0.0) || !std::isfinite(length)) return 1.0;
    const double power = std::pow(10.0, std::floor(std::log10(length)));
    constexpr std::array<double, 4> kSteps{1.0, 2.0, 5.0, 10.0};
    const auto further = [&](double a, double b) {
        return std::abs(std::log(a * power / length)) < std::abs(std::log(b * power / length));
    };
    return *std::min_element(kSteps.begin(), kSteps.end(), further) * power;
}

}  // namespace punctum
