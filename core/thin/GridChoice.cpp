// SPDX-License-Identifier: MIT
#include "core/cells/CellOrder.h"
#include "core/process/Marking.h"
#include "core/thin/Choices.h"

#include <tuple>

namespace punctum
{

namespace
{

/// What the points of a cell are compared by: smaller is better.
class CellRank
{
public:
    CellRank(const WorldGrid& grid, const PointCloud& cloud, CellChoice choice, const PointSet* noise)
        : m_grid(grid), m_choice(choice), m_noise(noise), m_up(cloud.coordinates().scale.z < 0 ? -1.0 : 1.0)
    {
    }
    double operator()(std::uint32_t point, const CellKey& key) const
    {
        switch (m_choice) {
            case CellChoice::Middle:
                return m_grid.squaredFromMiddle(point, key);
            case CellChoice::Lowest:
                return m_up * m_grid.raw(point)[2] + last(point);
            case CellChoice::Highest:
                return -m_up * m_grid.raw(point)[2] + last(point);
            case CellChoice::Random:
                return double(mixedBits(m_grid.worldSteps(point)) >> 11);
            case CellChoice::First:
                return double(point);
        }
        return 0;
    }

private:
    double last(std::uint32_t point) const { return m_noise != nullptr && m_noise->contains(point) ? 1e12 : 0; }

    const WorldGrid& m_grid;
    CellChoice m_choice;
    const PointSet* m_noise;
    double m_up;
};

}  // namespace

std::shared_ptr<PointSet> chooseByGrid(const PointCloud& cloud, double cell, CellChoice choice,
                                       const PointSet* leftOut, Progress& progress)
{
    auto kept = std::make_shared<PointSet>(cloud.size());
    const WorldGrid grid(cloud, cell);
    const CellOrder order(grid, leftOut, progress);
    const bool byHeight = choice == CellChoice::Lowest || choice == CellChoice::Highest;
    const auto noise = byHeight ? pointsLeftOut(cloud, true, progress) : nullptr;
    const CellRank rank(grid, cloud, choice, noise.get());
    order.forEachCell("Choosing points", progress,
                      [&](std::size_t, const CellKey& key, std::span<const std::uint32_t> points) {
                          std::uint32_t best = points[0];
                          if (points.size() > 1) {
                              double least = rank(best, key);
                              for (const std::uint32_t p : points.subspan(1)) {
                                  const double here = rank(p, key);
                                  if (here > least || (here == least && grid.raw(p) >= grid.raw(best))) continue;
                                  least = here;
                                  best = p;
                              }
                          }
                          kept->insertShared(best);
                      });
    return kept;
}

}  // namespace punctum
