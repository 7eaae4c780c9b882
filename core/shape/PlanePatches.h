// SPDX-License-Identifier: MIT
#pragma once

#include "core/cells/CellOrder.h"
#include "core/shape/PointPlanes.h"

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace punctum
{

inline constexpr std::uint32_t kNoRegion = std::numeric_limits<std::uint32_t>::max();

/// Points of one cell that lie in one plane. Places are in units of length from where raw coordinates are 0.
struct PlanePatch {
    CellKey key{};
    std::uint32_t count = 0;
    std::array<double, 3> middle{};
    std::array<float, 3> normal{};
    float spread = 0;     ///< variance along the plane, mean of all directions
    float deviation = 0;  ///< standard deviation across it
    std::uint32_t region = kNoRegion;
};

/// The flat patches of a cloud, cell by cell. Which there are depends on places alone; their order does not.
class PlanePatches
{
public:
    /// `planes`: planesOfPoints(). Throws Cancelled.
    PlanePatches(const CellOrder& order, const std::vector<std::uint32_t>& planes, const PlaneOptions& options,
                 Progress& progress);

    std::span<PlanePatch> all() noexcept { return m_patches; }
    std::span<const PlanePatch> all() const noexcept { return m_patches; }
    /// Those of a cell, the flattest seed's first: numbers of patches, from the first to past the last.
    std::pair<std::uint32_t, std::uint32_t> of(const CellKey& key) const noexcept;

private:
    void makeTable(Progress& progress);

    std::vector<PlanePatch> m_patches;   ///< those of a cell one after another
    std::vector<std::uint32_t> m_table;  ///< first patch of a cell, by its key; open addressing, a power of two
};

}  // namespace punctum
