// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"
#include "core/cloud/Units.h"
#include "core/task/Progress.h"

#include <tbb/parallel_for.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace punctum
{

/// Square cells seen from above, in blocks of 64 by 64, of which there are only those that have points: strays cost
/// a block each. Cells begin at whole multiples of their size in world coordinates, so that they are the same
/// however the points are dealt out to files. Values of cells are arrays of cells() elements that the caller has.
class CellGrid
{
public:
    static constexpr std::int32_t kSide = 64;
    static constexpr std::size_t kBlock = std::size_t(kSide) * kSide;
    static constexpr std::size_t kNone = SIZE_MAX;
    static constexpr std::size_t kMostCells = std::size_t(1) << 29;  ///< 2 GB for a float of each

    /// The blocks that points of `of` lie in; `size` in units of length. Throws Cancelled, and Error where the
    /// cells are too many for memory (`name`: of the step that wants them).
    CellGrid(const PointCloud& cloud, const PointSet& of, double size, const std::string& name, Progress& progress);

    double size() const noexcept { return m_size; }
    std::size_t blocks() const noexcept { return m_corners.size(); }
    std::size_t cells() const noexcept { return blocks() * kBlock; }
    /// Of a point of one of its blocks; kNone for others.
    std::size_t cellOf(PointIndex point) const noexcept;
    /// The cell so many cells further, up to 64 each way; kNone where there is no block.
    std::size_t beside(std::size_t cell, std::int32_t dx, std::int32_t dy) const noexcept
    {
        const std::size_t block = cell / kBlock;
        std::int32_t x = std::int32_t(cell % kSide) + dx, y = std::int32_t(cell % kBlock / kSide) + dy;
        const std::int32_t bx = x < 0 ? 0 : x < kSide ? 1 : 2, by = y < 0 ? 0 : y < kSide ? 1 : 2;
        const std::uint32_t other = m_around[block][3 * std::size_t(by) + std::size_t(bx)];
        if (other == UINT32_MAX) return kNone;
        x &= kSide - 1;
        y &= kSide - 1;
        return std::size_t(other) * kBlock + std::size_t(y) * kSide + std::size_t(x);
    }
    /// Column and row of a cell, counted from the origin of the world.
    std::array<std::int64_t, 2> place(std::size_t cell) const noexcept
    {
        const auto& corner = m_corners[cell / kBlock];
        return {corner[1] * kSide + std::int64_t(cell % kSide),
                corner[0] * kSide + std::int64_t(cell % kBlock / kSide)};
    }
    /// Calls task(cell) for all cells in parallel, block by block. Throws Cancelled.
    template <typename Task>
    void forCells(Progress& progress, Task&& task) const
    {
        tbb::parallel_for(std::size_t(0), blocks(), [&](std::size_t block) {
            if (progress.cancelled()) return;
            for (std::size_t cell = block * kBlock; cell < (block + 1) * kBlock; ++cell) task(cell);
        });
        progress.check();
    }

private:
    using Corner = std::array<std::int64_t, 2>;  ///< row and column of a block: sorted by rows
    std::array<std::int64_t, 2> column(PointIndex point) const noexcept;
    std::size_t findBlock(const Corner& corner) const noexcept;

    std::array<const std::int32_t*, 2> m_axes{};
    std::array<double, 2> m_scale{}, m_offset{};  ///< raw to cells
    double m_size = 1;
    std::vector<Corner> m_corners;
    std::vector<std::array<std::uint32_t, 9>> m_around;  ///< blocks about each, row by row
};

}  // namespace punctum
