// SPDX-License-Identifier: MIT
#include "core/clean/Outliers.h"

#include "core/cloud/Slabs.h"
#include "core/edit/ClassCommand.h"
#include "core/neighbors/Neighbors.h"
#include "core/process/Values.h"
#include "core/task/Progress.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <mutex>

namespace punctum
{

namespace
{

constexpr std::size_t kSumBlock = 1 << 16;  ///< points whose distances are added by one task

struct Sums {
    double sum = 0, squares = 0;
};

constexpr float kNone = -1;  ///< distance of a deleted point

/// Sums of blocks, added in the order of the blocks: the same on any number of threads.
Sums sumUp(const std::vector<float>& distances, const Progress& progress)
{
    std::vector<Sums> blocks((distances.size() + kSumBlock - 1) / kSumBlock);
    tbb::parallel_for(std::size_t(0), blocks.size(), [&](std::size_t b) {
        if (progress.cancelled()) return;
        const std::size_t last = std::min(distances.size(), (b + 1) * kSumBlock);
        for (std::size_t i = b * kSumBlock; i < last; ++i) {
            if (distances[i] == kNone) continue;
            blocks[b].sum += double(distances[i]);
            blocks[b].squares += double(distances[i] * distances[i]);  // squared as a float, as PCL has it
        }
    });
    progress.check();
    Sums all;
    for (const Sums& s : blocks) {
        all.sum += s.sum;
        all.squares += s.squares;
    }
    return all;
}

}  // namespace

const StepDescription& OutliersStep::description() const
{
    using Type = StepParameter::Type;
    static const StepDescription about{
        .name = "outliers",
        .title = "Statistical outliers",
        .group = StepGroup::Cleaning,
        .help =
            "Classifies points whose mean distance to their neighbors is unusually large (PCL's statistical "
            "outlier removal).",
        .source = "Rusu et al. 2008",
        .parameters = {{.key = "k",
                        .label = "Neighbors",
                        .help = "How many nearest points the mean distance is taken of, not counting the point "
                                "itself.",
                        .type = Type::Integer,
                        .preset = "8",
                        .min = 1,
                        .max = 1000},
                       {.key = "deviations",
                        .label = "Deviations",
                        .help = "How many standard deviations above the mean a point is an outlier.",
                        .preset = "3",
                        .min = 0,
                        .max = 100},
                       {.key = "class",
                        .label = "Class",
                        .help = "The class outliers get.",
                        .type = Type::ClassCode,
                        .preset = "7"}},
        .shows = "Classification"};
    return about;
}

std::unique_ptr<Command> OutliersStep::make(const PointCloud& cloud, const StepValues& values,
                                            const PointSet* within, Progress& progress) const
{
    const auto k = std::size_t(*integerValue(values, "k"));
    const auto code = std::uint32_t(*integerValue(values, "class"));
    const Attribute classes = classAttribute(cloud, code);
    // Of k points or fewer none has k neighbors; nothing is unusual then.
    if (cloud.size() <= k) return nullptr;

    std::vector<float> distances(cloud.size(), kNone);
    double count = 0;
    {
        const auto places = KdOrder::of(cloud, progress);
        const KdOrder& order = *places;
        if (order.size() <= k) return nullptr;
        count = double(order.size());
        forEachNearest(order, k + 1, "Measuring distances", progress, [&](const Neighborhood& n) {
            double sum = 0;
            for (std::size_t j = 1; j <= k; ++j) sum += double(std::sqrt(n.squared[j]));  // 0 is the point itself
            distances[n.point] = float(sum / double(k));
        });
    }
    const Sums sums = sumUp(distances, progress);
    const double mean = sums.sum / count;
    const double variance = (sums.squares - sums.sum * sums.sum / count) / (count - 1);
    const double threshold = mean + *realValue(values, "deviations") * std::sqrt(std::max(0.0, variance));

    auto points = std::make_shared<PointSet>(cloud.size());
    progress.begin("Telling outliers", 2 * cloud.size());
    forEachSlab(cloud, progress, [&](std::size_t firstWord, std::size_t lastWord) {
        const std::size_t last = std::min(distances.size(), lastWord * 64);
        for (std::size_t i = firstWord * 64; i < last; ++i)
            if (double(distances[i]) > threshold) points->insert(i);
    });
    leaveOutValue(*points, cloud, classes, code, progress);
    if (within != nullptr) points->intersect(*within);
    return makeClassCommand("Outliers to " + classLabel(code), classes, std::move(points), code);
}

}  // namespace punctum
