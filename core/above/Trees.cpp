// SPDX-License-Identifier: MIT
#include "core/above/Trees.h"

#include "core/Text.h"
#include "core/above/Crowns.h"
#include "core/above/GroundHeights.h"
#include "core/above/PointClasses.h"
#include "core/cloud/Slabs.h"
#include "core/cloud/Units.h"
#include "core/process/FilledAttribute.h"
#include "core/process/ObjectNumbers.h"
#include "core/task/Progress.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <limits>

namespace punctum
{

namespace
{

constexpr const char* kTreeName = "TreeId";

/// Replaces *value by `height` where that is more; NaN is less than all.
void raiseTo(float& value, float height) noexcept
{
    std::atomic_ref<float> shared(value);
    float now = shared.load(std::memory_order_relaxed);
    while (!(now >= height) && !shared.compare_exchange_weak(now, height, std::memory_order_relaxed)) {
    }
}

std::string lengthOfOneDecimal(float length)
{
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.1f", double(length));
    return text.data();
}

}  // namespace

const StepDescription& TreesStep::description() const
{
    using Type = StepParameter::Type;
    using Unit = StepParameter::Unit;
    static const StepDescription about{
        .name = "trees",
        .title = "Trees",
        .group = StepGroup::Objects,
        .help =
            "Finds the tops of trees and numbers the points of each crown as TreeId; 0: of none. Heights are "
            "those of HeightAboveGround, or measured from the ground. Of some points alone, those trees are "
            "numbered that they are of, and numbers go on from those of the other points.",
        .source = "Popescu and Wynne 2004; Dalponte and Coomes 2016",
        .parameters =
            {{.key = "height",
              .label = "Least height",
              .help = "Trees and their points are at least so high above the ground.",
              .fit = {.meters = 2},
              .min = 0,
              .max = 1e6,
              .unit = Unit::Length},
             {.key = "window",
              .label = "Window",
              .help = "A top has nothing higher within this distance, which grows with the height of the top.",
              .fit = {.meters = 1.5},
              .min = 0,
              .max = 1e6,
              .unit = Unit::Length},
             {.key = "growth",
              .label = "Growth of the window",
              .help = "Per cent of a top's height by which its window is wider.",
              .preset = "3",
              .min = 0,
              .max = 100,
              .advanced = true,
              .unit = Unit::PerCent},
             {.key = "widest",
              .label = "Widest crown",
              .help = "The farthest that points of a tree lie from its top, seen from above.",
              .fit = {.meters = 10},
              .min = 0,
              .max = 1e6,
              .advanced = true,
              .unit = Unit::Length},
             {.key = "cell",
              .label = "Cell",
              .help = "Side of the cells whose highest points make the surface of the crowns.",
              .fit = {.spacings = 0.5, .meters = 0.5},
              .min = 1e-6,
              .max = 1e6,
              .advanced = true,
              .unit = Unit::Length},
             {.key = "smoothing",
              .label = "Smoothing",
              .help = "Standard deviation of the blur of that surface.",
              .fit = {.meters = 0.3},
              .min = 0,
              .max = 1e6,
              .advanced = true,
              .unit = Unit::Length},
             {.key = "share",
              .label = "Least share",
              .help = "Per cent of a tree's height below which the surface is not of its crown.",
              .preset = "45",
              .min = 0,
              .max = 100,
              .advanced = true,
              .unit = Unit::PerCent},
             {.key = "of",
              .label = "Of classes",
              .help = "The classes whose points may be of trees.",
              .type = Type::ClassCodes,
              .preset = "0-1,3-5,8,12",
              .advanced = true},
             groundParameter("The classes that are ground, where heights are to be measured.")},
        .shows = kTreeName};
    return about;
}

std::unique_ptr<Command> TreesStep::make(const PointCloud& cloud, const StepValues& values, const PointSet* within,
                                         Progress& progress) const
{
    if (cloud.size() == 0) return nullptr;
    FilledAttribute ids(cloud, {.name = kTreeName,
                                .description = "number of the tree; 0: none",
                                .type = ScalarType::U32,
                                .kind = AttributeKind::Category});
    const PointHeights known = heightsAboveGround(cloud, classesValue(values, "ground"), "trees", progress);
    const std::vector<float>& heights = known.values;
    CrownOptions options;
    options.leastHeight = *realValue(values, "height");
    options.smoothing = *realValue(values, "smoothing");
    options.window = *realValue(values, "window");
    options.windowGrowth = *realValue(values, "growth") / 100;
    options.leastShare = *realValue(values, "share") / 100;
    options.widest = *realValue(values, "widest");
    const auto least = float(options.leastHeight);

    PointSet candidates = pointsOfClasses(cloud, classesValue(values, "of"), progress);
    tbb::parallel_for(std::size_t(0), candidates.words().size(), [&](std::size_t word) {
        candidates.forEachInWords(word, word + 1, [&](PointIndex i) {
            if (!(heights[i] >= least)) candidates.remove(i);
        });
    });
    const CellGrid grid(cloud, candidates, *realValue(values, "cell"), "trees", progress);
    std::vector<float> surface(grid.cells(), std::numeric_limits<float>::quiet_NaN());
    const auto forCandidates = [&](const char* stage, auto&& each) {
        progress.begin(stage, cloud.size());
        forEachSlab(cloud, progress, [&](std::size_t firstWord, std::size_t lastWord) {
            candidates.forEachInWords(firstWord, lastWord, each);
        });
    };
    forCandidates("Finding the crowns' surface",
                  [&](PointIndex i) { raiseTo(surface[grid.cellOf(i)], heights[i]); });
    const Crowns crowns = findCrowns(grid, surface, options, progress);

    // A crown may have no points where a hole was filled, or none that may change.
    std::vector<float> highest(crowns.tops.size(), std::numeric_limits<float>::quiet_NaN());
    std::vector<std::uint32_t> numbers(highest.size(), 0);
    forCandidates("Measuring trees", [&](PointIndex i) {
        const std::uint32_t crown = crowns.crownOf[grid.cellOf(i)];
        if (crown == kNoCrown) return;
        raiseTo(highest[crown], heights[i]);
        const std::atomic_ref numbered(numbers[crown]);
        if (numbered.load(std::memory_order_relaxed) == 0 && (within == nullptr || within->contains(i)))
            numbered.store(1, std::memory_order_relaxed);
    });
    for (std::size_t crown = 0; crown < highest.size(); ++crown)
        if (numbers[crown] == 0) highest[crown] = std::numeric_limits<float>::quiet_NaN();
    const auto count = std::size_t(std::count(numbers.begin(), numbers.end(), 1u));
    std::uint32_t next = firstNumber(ids, count, within, progress);
    for (std::uint32_t& number : numbers)
        if (number != 0) number = next++;
    std::erase_if(highest, [](float height) { return std::isnan(height); });
    progress.begin("Numbering trees", cloud.size());
    forEachSlab(cloud, progress, [&](std::size_t firstWord, std::size_t lastWord) {
        const PointRange range = pointsOfWords(cloud.size(), firstWord, lastWord);
        for (PointIndex i = range.first; i < range.last; ++i) {
            if (within != nullptr && !within->contains(i)) continue;
            const std::uint32_t crown = candidates.contains(i) ? crowns.crownOf[grid.cellOf(i)] : kNoCrown;
            ids.set(i, crown == kNoCrown ? 0 : double(numbers[crown]));
        }
    });
    auto command = std::make_unique<AttributesCommand>("Trees", std::vector{ids.attribute()});
    if (highest.empty()) {
        command->setFinding("No trees.");
    } else {
        const auto [low, high] = std::minmax_element(highest.begin(), highest.end());
        const std::string unit = trueLengths(cloud).unit;
        command->setFinding((highest.size() == 1 ? "1 tree" : grouped(highest.size()) + " trees") +
                            (highest.size() == 1 ? ", height " : ", heights " + lengthOfOneDecimal(*low) + " to ") +
                            lengthOfOneDecimal(*high) + (unit.empty() ? "" : " " + unit) + "." +
                            (known.finding.empty() ? "" : " " + known.finding));
    }
    return command;
}

}  // namespace punctum
