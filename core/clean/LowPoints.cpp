// SPDX-License-Identifier: MIT
#include "core/clean/LowPoints.h"

#include "core/Error.h"
#include "core/Text.h"
#include "core/cells/CellOrder.h"
#include "core/cloud/ClassNames.h"
#include "core/edit/ClassCommand.h"
#include "core/process/Marking.h"
#include "core/process/Values.h"

#include <algorithm>
#include <vector>

namespace punctum
{

namespace
{

/// A column's lowest points, heights rising.
struct LowColumn {
    CellKey key{};
    std::size_t first = 0, count = 0;  ///< in the bucket's lists
};
struct Lowest {
    std::vector<LowColumn> columns;
    std::vector<std::int64_t> heights;  ///< raw; turned around where high points are wanted
    std::vector<std::uint32_t> points;
};
/// Where a column's lowest points are.
struct ColumnPlace {
    std::uint32_t bucket = 0, column = 0;
};

/// The low points of the cloud, upside down with `turn` = -1.
class LowFinder
{
public:
    LowFinder(const CellOrder& order, std::size_t most, double gap, int turn)
        : m_order(order), m_most(most), m_gap(gap), m_turn(turn)
    {
    }

    void find(PointSet& found, Progress& progress)
    {
        gatherLowest(progress);
        std::size_t columns = 0;
        for (const Lowest& bucket : m_buckets) columns += bucket.columns.size();
        CellTable<ColumnPlace> places(columns);
        for (std::uint32_t b = 0; b < m_buckets.size(); ++b) {
            progress.check();
            for (std::uint32_t c = 0; c < m_buckets[b].columns.size(); ++c)
                places[m_buckets[b].columns[c].key] = {b, c};
        }
        progress.begin("Looking for gaps", m_buckets.size());
        tbb::parallel_for(std::size_t(0), m_buckets.size(), [&](std::size_t b) {
            std::vector<std::int64_t> heights;
            for (const LowColumn& column : m_buckets[b].columns) {
                if (progress.cancelled()) return;
                tellColumn(m_buckets[b], column, places, heights, found);
            }
            progress.add(1);
        });
        progress.check();
    }

private:
    /// What is kept of a column: as many as a low group may have, and as many as must lie above it.
    std::size_t kept() const { return 2 * m_most + 1; }

    void gatherLowest(Progress& progress)
    {
        m_buckets.assign(m_order.buckets(), {});
        m_order.forEachCell("Finding the lowest points", progress,
                            [&](std::size_t b, const CellKey& key, std::span<const std::uint32_t> points) {
                                thread_local std::vector<std::pair<std::int64_t, std::uint32_t>> sorted;
                                sorted.clear();
                                for (const std::uint32_t p : points)
                                    sorted.emplace_back(std::int64_t(m_order.grid().raw(p)[2]) * m_turn, p);
                                const std::size_t count = std::min(sorted.size(), kept());
                                std::partial_sort(sorted.begin(), sorted.begin() + std::ptrdiff_t(count),
                                                  sorted.end());
                                Lowest& bucket = m_buckets[b];
                                bucket.columns.push_back({key, bucket.points.size(), count});
                                for (std::size_t k = 0; k < count; ++k) {
                                    bucket.heights.push_back(sorted[k].first);
                                    bucket.points.push_back(sorted[k].second);
                                }
                            });
    }

    void tellColumn(const Lowest& bucket, const LowColumn& column, const CellTable<ColumnPlace>& places,
                    std::vector<std::int64_t>& heights, PointSet& found) const
    {
        heights.clear();
        for (std::uint32_t y = 0; y < 3; ++y)
            for (std::uint32_t x = 0; x < 3; ++x) {
                const ColumnPlace* const place =
                    places.find({column.key[0] + x - 1, column.key[1] + y - 1, column.key[2]});
                if (place == nullptr) continue;
                const Lowest& there = m_buckets[place->bucket];
                const LowColumn& other = there.columns[place->column];
                const auto first = there.heights.begin() + std::ptrdiff_t(other.first);
                heights.insert(heights.end(), first, first + std::ptrdiff_t(other.count));
            }
        if (heights.size() < m_most + 2) return;
        const std::size_t most = std::min(heights.size(), kept());
        std::partial_sort(heights.begin(), heights.begin() + std::ptrdiff_t(most), heights.end());
        const double step = m_order.grid().scale()[2];
        // The largest group with a gap above it, and enough above the gap.
        for (std::size_t group = std::min(m_most, most - m_most - 1); group > 0; --group) {
            if (double(heights[group] - heights[group - 1]) * step < m_gap) continue;
            for (std::size_t k = 0; k < column.count; ++k)
                if (bucket.heights[column.first + k] < heights[group])
                    found.insertShared(bucket.points[column.first + k]);
            return;
        }
    }

    const CellOrder& m_order;
    std::size_t m_most;
    double m_gap;
    int m_turn;
    std::vector<Lowest> m_buckets;
};

/// Whether the classes are whole bytes, as in point formats 6 to 10, where 18 is high noise.
std::uint32_t highClass(const Attribute& classes)
{
    return classes.maxBits() >= 255 ? kHighNoise : kLowNoise;
}

}  // namespace

const StepDescription& LowPointsStep::description() const
{
    using Type = StepParameter::Type;
    using Unit = StepParameter::Unit;
    static const StepDescription about{
        .name = "low",
        .title = "Low and high points",
        .group = StepGroup::Cleaning,
        .help =
            "Finds single points and small groups far below all others around them, and far above them where "
            "that is wanted: birds and clouds get class 18, in point formats 0 to 5 class 7.",
        .parameters = {{.key = "step",
                        .label = "Cell",
                        .help =
                            "The side of the columns of a grid; a point is compared with those in its column and "
                            "the eight around it.",
                        .fit = {.spacings = 5},
                        .min = 1e-9,
                        .max = 1e9,
                        .unit = Unit::Length},
                       {.key = "depth",
                        .label = "Depth",
                        .help = "How far below the lowest of all others low points are, at least.",
                        .fit = {.spacings = 1, .meters = 0.5},
                        .min = 0,
                        .max = 1e9,
                        .unit = Unit::Length},
                       {.key = "count",
                        .label = "Points at most",
                        .help = "Of how many points a low or high group is made at most.",
                        .type = Type::Integer,
                        .preset = "5",
                        .min = 1,
                        .max = 1000},
                       {.key = "class",
                        .label = "Class",
                        .help = "The class low points get.",
                        .type = Type::ClassCode,
                        .preset = "7"},
                       {.key = "high",
                        .label = "High points, too",
                        .help = "Whether points far above all others are looked for as well.",
                        .type = Type::Choice,
                        .preset = "no",
                        .choices = {"no", "yes"}},
                       {.key = "height",
                        .label = "Height",
                        .help = "How far above the highest of all others high points are, at least.",
                        .fit = {.spacings = 5, .meters = 10},
                        .min = 0,
                        .max = 1e9,
                        .unit = Unit::Length,
                        .when = {"high", "yes"}}},
        .shows = "Classification"};
    return about;
}

std::unique_ptr<Command> LowPointsStep::make(const PointCloud& cloud, const StepValues& values,
                                             const PointSet* within, Progress& progress) const
{
    const auto code = std::uint32_t(*integerValue(values, "class"));
    const Attribute classes = classAttribute(cloud, code);
    const auto most = std::size_t(*integerValue(values, "count"));
    const WorldGrid grid(cloud, *realValue(values, "step"), 2);
    const auto leftOut = pointsLeftOut(cloud, true, progress);
    const CellOrder order(grid, leftOut.get(), progress);
    auto low = std::make_shared<PointSet>(cloud.size());
    LowFinder(order, most, *realValue(values, "depth"), 1).find(*low, progress);
    PointSet high(cloud.size());
    if (textValue(values, "high") == "yes") {
        LowFinder(order, most, *realValue(values, "height"), -1).find(high, progress);
        high.remove(*low);
    }
    if (within != nullptr) {
        low->intersect(*within);
        high.intersect(*within);
    }
    const PointIndex lows = low->count(), highs = high.count();
    std::vector<std::byte> codes;
    codes.reserve(lows + highs);
    const auto both = std::make_shared<PointSet>(*low);
    both->insert(high);
    both->forEach([&](PointIndex i) { codes.push_back(std::byte(high.contains(i) ? highClass(classes) : code)); });
    auto command = makeClassCommand("Low points to " + classLabel(code), classes, both, std::move(codes));
    if (command)
        command->setFinding("Found " + grouped(lows) + " low" +
                            (textValue(values, "high") == "yes" ? " and " + grouped(highs) + " high" : "") +
                            (lows + highs == 1 ? " point." : " points."));
    return command;
}

}  // namespace punctum
