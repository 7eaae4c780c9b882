// SPDX-License-Identifier: MIT
#include "core/above/CellGrid.h"

#include "core/Error.h"
#include "core/task/Progress.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace punctum
{

namespace
{

constexpr std::size_t kMostBlocks = CellGrid::kMostCells / CellGrid::kBlock;
constexpr std::size_t kCellPiece = 1 << 14;  ///< points between two looks at the cancel flag
constexpr double kFurthestCell = 1e15;       ///< beyond, cells are not told apart

}  // namespace

CellGrid::CellGrid(const PointCloud& cloud, const PointSet& of, double size, const std::string& name,
                   Progress& progress)
    : m_size(size)
{
    const TrueLengths lengths = trueLengths(cloud);
    const CoordinateScale& scale = cloud.coordinates();
    m_axes = {cloud.rawX().data(), cloud.rawY().data()};
    for (int a = 0; a < 2; ++a) {
        m_scale[std::size_t(a)] = scale.scale[a] * lengths.stretch[a] / size;
        m_offset[std::size_t(a)] = scale.offset[a] * lengths.stretch[a] / size;
    }
    progress.begin("Laying out cells", cloud.size());
    tbb::enumerable_thread_specific<std::set<Corner>> found;
    tbb::parallel_for(tbb::blocked_range<PointIndex>(0, cloud.size(), kCellPiece), [&](const auto& range) {
        std::set<Corner>& own = found.local();
        for (PointIndex first = range.begin(); first < range.end() && !progress.cancelled(); first += kCellPiece) {
            const PointIndex last = std::min(range.end(), first + kCellPiece);
            Corner before{INT64_MIN, INT64_MIN};
            for (PointIndex i = first; i < last; ++i) {
                if (!of.contains(i)) continue;
                const auto [x, y] = column(i);
                const Corner corner{y >> 6, x >> 6};
                if (corner == before) continue;
                own.insert(corner);
                before = corner;
            }
            progress.add(last - first);
            if (own.size() > kMostBlocks) return;
        }
    });
    progress.check();
    std::set<Corner> all;
    for (auto& own : found) all.merge(own);
    if (all.size() > kMostBlocks)
        throw Error(name + ": cells of this size are too many for a cloud of this extent; give a larger one.");
    m_corners.assign(all.begin(), all.end());
    m_around.resize(blocks());
    for (std::size_t b = 0; b < blocks(); ++b)
        for (std::int64_t dy = -1; dy <= 1; ++dy)
            for (std::int64_t dx = -1; dx <= 1; ++dx) {
                const std::size_t other = findBlock({m_corners[b][0] + dy, m_corners[b][1] + dx});
                m_around[b][std::size_t((dy + 1) * 3 + dx + 1)] =
                    other == kNone ? UINT32_MAX : std::uint32_t(other);
            }
}

std::array<std::int64_t, 2> CellGrid::column(PointIndex point) const noexcept
{
    std::array<std::int64_t, 2> at{};
    for (std::size_t a = 0; a < 2; ++a) {
        const double cell = std::floor(double(m_axes[a][point]) * m_scale[a] + m_offset[a]);
        at[a] = std::int64_t(std::clamp(cell, -kFurthestCell, kFurthestCell));
    }
    return at;
}

std::size_t CellGrid::findBlock(const Corner& corner) const noexcept
{
    const auto at = std::lower_bound(m_corners.begin(), m_corners.end(), corner);
    return at == m_corners.end() || *at != corner ? kNone : std::size_t(at - m_corners.begin());
}

std::size_t CellGrid::cellOf(PointIndex point) const noexcept
{
    const auto [x, y] = column(point);
    const std::size_t block = findBlock({y >> 6, x >> 6});
    if (block == kNone) return kNone;
    return block * kBlock + std::size_t(y & (kSide - 1)) * kSide + std::size_t(x & (kSide - 1));
}

}  // namespace punctum
