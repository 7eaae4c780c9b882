// SPDX-License-Identifier: MIT
// Clouds that are hard on searches for neighbors, and distances by looking at all points.
#pragma once

#include "core/edit/Command.h"
#include "core/steps/Steps.h"
#include "core/task/Progress.h"
#include "tests/core/MadeCloud.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <vector>

namespace punctum
{

inline void place(PointCloud& cloud, PointIndex i, double x, double y, double z)
{
    rawAxis(cloud, 0)[i] = std::int32_t(x);
    rawAxis(cloud, 1)[i] = std::int32_t(y);
    rawAxis(cloud, 2)[i] = std::int32_t(z);
}

/// Clouds of raw coordinates; each is trouble for one part of the search.
inline std::shared_ptr<PointCloud> makeTrouble(const std::string& kind, PointIndex n)
{
    std::mt19937_64 random(11);
    const auto unit = [&] { return double(random() >> 11) * 0x1p-53; };
    CoordinateScale scale{glm::dvec3(0.001), glm::dvec3(457000.0, 5552000.0, 100.0)};
    if (kind == "degrees") scale = {glm::dvec3(1e-8, 1e-8, 0.001), glm::dvec3(13.0, 52.0, 0.0)};
    const auto cloud = makeFrame(n, scale);
    for (PointIndex i = 0; i < n; ++i) {
        if (kind == "plane" || kind == "degrees") {
            place(*cloud, i, unit() * 2e5, unit() * 2e5, 1000 * unit());
        } else if (kind == "volume") {
            place(*cloud, i, unit() * 1e5, unit() * 1e5, unit() * 1e5);
        } else if (kind == "scanner") {  // density falls with the fourth power: terrestrial
            const double r = 1e6 / (1.0 + 300.0 * unit()), angle = 6.283 * unit();
            place(*cloud, i, r * std::cos(angle), r * std::sin(angle), 3e4 * unit() * r / 1e6);
        } else if (kind == "isolated") {  // a dense patch, and few points far from everything
            const bool far = i % 97 == 0;
            place(*cloud, i, far ? 1e9 * (unit() - 0.5) : 1e4 * unit(), far ? 1e9 * (unit() - 0.5) : 1e4 * unit(),
                  100 * unit());
        } else if (kind == "doubled") {  // many points share a place
            place(*cloud, i, std::floor(unit() * 40) * 500, std::floor(unit() * 40) * 500, 0);
        } else if (kind == "one place") {
            place(*cloud, i, 5, 5, 5);
        } else if (kind == "line") {
            place(*cloud, i, double(i) * 10, 7, 7);
        } else if (kind == "grid") {  // ties everywhere
            place(*cloud, i, double(i % 100) * 250, double(i / 100 % 100) * 250, double(i / 10'000) * 250);
        } else if (kind == "corners") {  // the whole range of int32
            place(*cloud, i, random() % 2 != 0 ? INT32_MAX : INT32_MIN, random() % 2 != 0 ? INT32_MAX : INT32_MIN,
                  double(std::int32_t(random())));
        }
    }
    return cloud;
}

inline constexpr const char* kTrouble[] = {"plane",   "degrees",   "volume", "scanner", "isolated",
                                           "doubled", "one place", "line",   "corners"};

inline double distance2(const PointCloud& cloud, PointIndex a, PointIndex b)
{
    const glm::dvec3 d = glm::dvec3(double(cloud.rawX()[a]) - double(cloud.rawX()[b]),
                                    double(cloud.rawY()[a]) - double(cloud.rawY()[b]),
                                    double(cloud.rawZ()[a]) - double(cloud.rawZ()[b])) *
                         cloud.coordinates().scale;
    return d.x * d.x + d.y * d.y + d.z * d.z;
}

/// Squared distances to all points, the k smallest sorted in front.
inline std::vector<double> allDistances(const PointCloud& cloud, PointIndex from, std::size_t k)
{
    std::vector<double> d(cloud.size());
    for (PointIndex i = 0; i < cloud.size(); ++i) d[i] = distance2(cloud, from, i);
    std::partial_sort(d.begin(), d.begin() + std::ptrdiff_t(k), d.end());
    return d;
}

inline std::unique_ptr<Command> runStep(const PointCloud& cloud, const std::string& text)
{
    const ParsedStep parsed = parseStep(text);
    Progress progress;
    return parsed.step->run(cloud, parsed.values, progress);
}

}  // namespace punctum
