// SPDX-License-Identifier: MIT
#include "core/cells/WorldGrid.h"

#include "core/Error.h"

#include <algorithm>
#include <cmath>

namespace punctum
{

namespace
{

constexpr double kOnFace = 1e-6;  ///< of a cell
constexpr double kMostCells = 4294967290.0;
constexpr double kWhole = 1e-6;  ///< of a step: an offset is a number of whole ones

}  // namespace

WorldGrid::WorldGrid(const PointCloud& cloud, double size, int axes)
    : m_points(cloud.size()), m_lengths(trueLengths(cloud))
{
    if (cloud.size() > UINT32_MAX)
        throw Error("This step handles up to 4,294,967,295 points; split the cloud first.");
    {
        const std::shared_lock lock(cloud.mutex());
        for (std::size_t a = 0; a < 3; ++a) m_columns[a] = cloud.columns()[a];
    }
    const RawBounds bounds = cloud.computeBounds();
    for (std::size_t a = 0; a < 3; ++a) {
        const int axis = int(a);
        m_raw[a] = m_columns[a]->values<std::int32_t>().data();
        const double step = std::fabs(cloud.coordinates().scale[axis]);
        m_scale[a] = step * m_lengths.stretch[axis];
        if (step > 0) {
            const double zero =
                std::clamp(cloud.coordinates().offset[axis] / cloud.coordinates().scale[axis], -9e15, 9e15);
            m_zero[a] = std::llround(zero);
            m_rest[a] = zero - double(m_zero[a]);
            if (std::fabs(m_rest[a]) < kWhole) m_rest[a] = 0;
        }
        if (int(a) >= axes) {
            m_size[a] = INFINITY;  // one cell for all
            continue;
        }
        m_size[a] = std::max(size, m_scale[a]);
        if (bounds.empty() || !(m_scale[a] > 0)) continue;
        const double factor = cloud.coordinates().scale[axis] * m_lengths.stretch[axis] / m_size[a];
        const double shift = cloud.coordinates().offset[axis] * m_lengths.stretch[axis] / m_size[a];
        const auto cell = [&](std::int64_t raw) { return std::floor(double(raw) * factor + shift + kOnFace); };
        const double first = std::min(cell(bounds.min[axis]), cell(bounds.max[axis]));
        if (std::fabs(cell(bounds.max[axis]) - cell(bounds.min[axis])) > kMostCells)
            throw Error("The cells are too small for so large a cloud; make them larger.");
        // One cell before the first, so that every cell that has points has neighbors on all sides.
        m_first[a] = std::int64_t(first) - 1;
        m_factor[a] = factor;
        m_shift[a] = shift - double(m_first[a]) + kOnFace;
    }
}

double WorldGrid::squaredFromMiddle(std::size_t point, const CellKey& key) const noexcept
{
    const auto steps = worldSteps(point), cell = absolute(key);
    double sum = 0;
    for (std::size_t a = 0; a < 3; ++a) {
        if (m_factor[a] == 0.0) continue;
        const double place = (double(steps[a]) + m_rest[a]) * m_factor[a];
        const double d = (place - double(cell[a]) - 0.5) * m_size[a];
        sum += d * d;
    }
    // Places as far from the middle, on its two sides, must not be told apart by last bits.
    return double(float(sum));
}

}  // namespace punctum
