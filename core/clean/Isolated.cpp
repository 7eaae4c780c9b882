// SPDX-License-Identifier: MIT
#include "core/clean/Isolated.h"

#include "core/Text.h"
#include "core/cells/CellOrder.h"
#include "core/process/Marking.h"
#include "core/process/Values.h"

#include <vector>

namespace punctum
{

namespace
{

/// What a bucket has: its cells with their numbers of points, and the points of those that may be isolated.
struct SparseCells {
    struct Cell {
        CellKey key{};
        std::uint32_t count = 0;
    };
    std::vector<Cell> cells, sparse;
    std::vector<std::uint32_t> points;  ///< of the sparse ones, one cell after another
};

/// Points in the cell and the 26 around it, as far as they are at most `most`.
std::uint64_t pointsAround(const CellTable<std::uint32_t>& counts, const CellKey& key, std::uint64_t most)
{
    std::uint64_t sum = 0;
    for (std::uint32_t z = 0; z < 3; ++z)
        for (std::uint32_t y = 0; y < 3; ++y)
            for (std::uint32_t x = 0; x < 3 && sum <= most; ++x) {
                const std::uint32_t* const here = counts.find({key[0] + x - 1, key[1] + y - 1, key[2] + z - 1});
                if (here != nullptr) sum += *here;
            }
    return sum;
}

}  // namespace

const StepDescription& IsolatedStep::description() const
{
    using Type = StepParameter::Type;
    static const StepDescription about{
        .name = "isolated",
        .title = "Isolated points",
        .group = StepGroup::Cleaning,
        .help =
            "Finds points that are nearly alone: few others lie in their cell of a grid and the 26 cells around "
            "it. Points of the noise classes 7 and 18 do not count.",
        .source = "lasnoise, lasR ivf",
        .parameters = {{.key = "step",
                        .label = "Cell",
                        .help = "The side of a cell.",
                        .fit = {.spacings = 6},
                        .min = 1e-9,
                        .max = 1e9,
                        .unit = StepParameter::Unit::Length},
                       {.key = "isolated",
                        .label = "Others at most",
                        .help = "As many other points may lie in the 27 cells.",
                        .type = Type::Integer,
                        .preset = "5",
                        .min = 0,
                        .max = 1000000},
                       doParameter({"class", "withheld", "delete"}, "class",
                                   "What isolated points get: a class, the flag "
                                   "Withheld, or they are deleted."),
                       doClassParameter("7", "The class isolated points get: 7 low noise, 18 high noise.")},
        .shows = "Classification"};
    return about;
}

std::unique_ptr<Command> IsolatedStep::make(const PointCloud& cloud, const StepValues& values,
                                            const PointSet* within, Progress& progress) const
{
    const auto most = std::uint64_t(*integerValue(values, "isolated")) + 1;  // with the point itself
    const WorldGrid grid(cloud, *realValue(values, "step"));
    const auto leftOut = pointsLeftOut(cloud, true, progress);
    const CellOrder order(grid, leftOut.get(), progress);
    std::vector<SparseCells> buckets(order.buckets());
    order.forEachCell("Counting points in cells", progress,
                      [&](std::size_t b, const CellKey& key, std::span<const std::uint32_t> points) {
                          SparseCells& bucket = buckets[b];
                          bucket.cells.push_back({key, std::uint32_t(points.size())});
                          if (points.size() > most) return;
                          bucket.sparse.push_back(bucket.cells.back());
                          bucket.points.insert(bucket.points.end(), points.begin(), points.end());
                      });
    std::size_t cells = 0;
    for (const SparseCells& bucket : buckets) cells += bucket.cells.size();
    CellTable<std::uint32_t> counts(cells);
    for (SparseCells& bucket : buckets) {
        progress.check();
        for (const auto& cell : bucket.cells) counts[cell.key] = cell.count;
        bucket.cells = {};
    }
    auto points = std::make_shared<PointSet>(cloud.size());
    progress.begin("Telling isolated points", buckets.size());
    tbb::parallel_for(std::size_t(0), buckets.size(), [&](std::size_t b) {
        if (progress.cancelled()) return;
        const std::uint32_t* point = buckets[b].points.data();
        for (const auto& cell : buckets[b].sparse) {
            const bool isolated = pointsAround(counts, cell.key, most) <= most;
            for (std::uint32_t k = 0; k < cell.count; ++k, ++point)
                if (isolated) points->insertShared(*point);
        }
        progress.add(1);
    });
    progress.check();
    if (within != nullptr) points->intersect(*within);
    const PointIndex found = points->count();
    auto command = markPoints("Isolated points", cloud, std::move(points), values, progress);
    if (command) command->setFinding("Found " + pointsText(found) + " nearly alone.");
    return command;
}

}  // namespace punctum
