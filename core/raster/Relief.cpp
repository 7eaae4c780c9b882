// SPDX-License-Identifier: MIT
#include "core/raster/Relief.h"

#include "core/task/Progress.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <optional>
#include <string>

namespace punctum
{

namespace
{

constexpr double kDegreesOfRadian = 180.0 / std::numbers::pi;

/// A value of each cell from the raster, row by row in parallel.
template <typename F>
Raster eachCell(const Raster& raster, const std::string& stage, Progress& progress, F f)
{
    Raster out(raster.frame());
    progress.begin(stage, raster.rows());
    tbb::parallel_for(std::size_t(0), raster.rows(), [&](std::size_t row) {
        if (progress.cancelled()) return;
        for (std::size_t column = 0; column < raster.columns(); ++column) out.at(column, row) = f(column, row);
        progress.add(1);
    });
    progress.check();
    return out;
}

/// NaN beyond the edge.
float valueAt(const Raster& raster, std::ptrdiff_t column, std::ptrdiff_t row)
{
    const bool inside =
        column >= 0 && row >= 0 && column < std::ptrdiff_t(raster.columns()) && row < std::ptrdiff_t(raster.rows());
    return inside ? raster.at(std::size_t(column), std::size_t(row)) : Raster::kNone;
}

/// Rise to the east and to the north, units of height for one of X and Y.
struct Gradient {
    double east = 0, north = 0;
};

class HornSlope
{
public:
    HornSlope(const Raster& heights, const glm::dvec3& stretch) : m_heights(heights)
    {
        const double cell = heights.frame().cell;
        m_east = stretch.z / (8.0 * cell * stretch.x);
        m_north = stretch.z / (8.0 * cell * stretch.y);
    }

    std::optional<Gradient> at(std::size_t column, std::size_t row) const
    {
        const float middle = m_heights.at(column, row);
        if (std::isnan(middle)) return std::nullopt;
        std::array<double, 9> z;  // from north-west, row by row
        const auto c = std::ptrdiff_t(column), r = std::ptrdiff_t(row);
        for (std::ptrdiff_t k = 0; k < 9; ++k)
            z[std::size_t(k)] = double(valueAt(m_heights, c + k % 3 - 1, r + k / 3 - 1));
        // beyond an edge as the other side goes on; corners of corners from the two sides beside them
        const std::array<double, 9> there = z;
        const auto complete = [&](std::size_t k, double otherwise) {
            if (!std::isnan(there[k])) return;
            z[k] = std::isnan(there[8 - k]) ? otherwise : 2.0 * double(middle) - there[8 - k];
        };
        for (const std::size_t k : {1, 3, 5, 7}) complete(k, double(middle));
        for (const std::size_t k : {0, 2, 6, 8})
            complete(k, z[k < 3 ? 1 : 7] + z[k % 3 == 0 ? 3 : 5] - double(middle));
        return Gradient{((z[2] + 2 * z[5] + z[8]) - (z[0] + 2 * z[3] + z[6])) * m_east,
                        ((z[0] + 2 * z[1] + z[2]) - (z[6] + 2 * z[7] + z[8])) * m_north};
    }

private:
    const Raster& m_heights;
    double m_east, m_north;
};

}  // namespace

Raster slopeOf(const Raster& heights, const glm::dvec3& stretch, Progress& progress)
{
    const HornSlope horn(heights, stretch);
    return eachCell(heights, "Measuring slopes", progress, [&](std::size_t column, std::size_t row) {
        const auto g = horn.at(column, row);
        return g ? float(std::atan(std::hypot(g->east, g->north)) * kDegreesOfRadian) : Raster::kNone;
    });
}

Raster aspectOf(const Raster& heights, const glm::dvec3& stretch, Progress& progress)
{
    const HornSlope horn(heights, stretch);
    return eachCell(heights, "Measuring directions", progress, [&](std::size_t column, std::size_t row) {
        const auto g = horn.at(column, row);
        if (!g || (g->east == 0.0 && g->north == 0.0)) return Raster::kNone;
        const double degrees = std::atan2(-g->east, -g->north) * kDegreesOfRadian;
        return float(degrees < 0.0 ? degrees + 360.0 : degrees);
    });
}

Raster hillshadeOf(const Raster& heights, const Sun& sun, const glm::dvec3& stretch, Progress& progress)
{
    const HornSlope horn(heights, stretch * glm::dvec3(1.0, 1.0, sun.exaggeration));
    const double azimuth = sun.azimuth / kDegreesOfRadian, altitude = sun.altitude / kDegreesOfRadian;
    const double east = std::sin(azimuth) * std::cos(altitude), north = std::cos(azimuth) * std::cos(altitude),
                 up = std::sin(altitude);
    return eachCell(heights, "Shading", progress, [&](std::size_t column, std::size_t row) {
        const auto g = horn.at(column, row);
        if (!g) return Raster::kNone;
        const double light =
            (up - g->east * east - g->north * north) / std::sqrt(1.0 + g->east * g->east + g->north * g->north);
        return float(std::lround(1.0 + 254.0 * std::clamp(light, 0.0, 1.0)));
    });
}

Raster holesFilled(const Raster& raster, std::size_t reach, Progress& progress)
{
    // half of the eight directions; the other half is across
    constexpr std::pair<int, int> kAcross[] = {{1, 0}, {1, 1}, {0, 1}, {-1, 1}};
    return eachCell(raster, "Filling holes", progress, [&](std::size_t column, std::size_t row) {
        const float own = raster.at(column, row);
        if (!std::isnan(own)) return own;
        double sum = 0, weights = 0;
        int closed = 0;
        for (const auto& [dx, dy] : kAcross) {
            int ends = 0;
            for (const int way : {1, -1})
                for (std::size_t d = 1; d <= reach; ++d) {
                    const std::ptrdiff_t step = way * std::ptrdiff_t(d);
                    const float found =
                        valueAt(raster, std::ptrdiff_t(column) + dx * step, std::ptrdiff_t(row) + dy * step);
                    if (std::isnan(found)) continue;
                    const double weight = 1.0 / (double(d * d) * (dx != 0 && dy != 0 ? 2.0 : 1.0));
                    sum += weight * double(found);
                    weights += weight;
                    ++ends;
                    break;
                }
            closed += ends == 2 ? 1 : 0;
        }
        return closed >= 2 ? float(sum / weights) : Raster::kNone;
    });
}

Raster smoothed(const Raster& raster, int times, Progress& progress)
{
    Raster now = raster;
    for (int t = 0; t < times; ++t)
        now = eachCell(now, "Smoothing", progress, [&](std::size_t column, std::size_t row) {
            if (std::isnan(now.at(column, row))) return Raster::kNone;
            double sum = 0, weights = 0;
            for (int k = 0; k < 9; ++k) {
                const int dx = k % 3 - 1, dy = k / 3 - 1;
                const float value = valueAt(now, std::ptrdiff_t(column) + dx, std::ptrdiff_t(row) + dy);
                if (std::isnan(value)) continue;
                const double weight = double(4 >> (std::abs(dx) + std::abs(dy)));
                sum += weight * double(value);
                weights += weight;
            }
            return float(sum / weights);
        });
    return now;
}

Raster pitsFilled(const Raster& raster, double depth, Progress& progress)
{
    return eachCell(raster, "Filling pits", progress, [&](std::size_t column, std::size_t row) {
        const float own = raster.at(column, row);
        if (std::isnan(own)) return own;
        std::array<float, 8> around;
        std::size_t n = 0;
        for (int k = 0; k < 9; ++k) {
            if (k == 4) continue;
            const float value =
                valueAt(raster, std::ptrdiff_t(column) + k % 3 - 1, std::ptrdiff_t(row) + k / 3 - 1);
            if (!std::isnan(value)) around[n++] = value;
        }
        if (n < 5) return own;
        std::nth_element(around.begin(), around.begin() + std::ptrdiff_t(n / 2),
                         around.begin() + std::ptrdiff_t(n));
        return double(around[n / 2]) - double(own) > depth ? around[n / 2] : own;
    });
}

}  // namespace punctum
