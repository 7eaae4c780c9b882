// SPDX-License-Identifier: MIT
#include "core/above/Vegetation.h"

#include "core/Error.h"
#include "core/above/GroundHeights.h"
#include "core/above/PointClasses.h"
#include "core/cloud/Slabs.h"
#include "core/edit/ClassCommand.h"
#include "core/task/Progress.h"

#include <algorithm>
#include <array>
#include <string>

namespace punctum
{

namespace
{

constexpr std::array<const char*, 3> kVegetationBounds = {"low", "medium", "high"};
constexpr std::array<const char*, 3> kVegetationClasses = {"low-class", "medium-class", "high-class"};

}  // namespace

const StepDescription& VegetationStep::description() const
{
    using Type = StepParameter::Type;
    using Unit = StepParameter::Unit;
    const auto bound = [](const char* key, const char* label, const char* help, double meters) {
        return StepParameter{.key = key,
                             .label = label,
                             .help = help,
                             .fit = {.meters = meters},
                             .min = 0,
                             .max = 1e6,
                             .unit = Unit::Length};
    };
    const auto code = [](const char* key, const char* label, const char* help, const char* preset) {
        return StepParameter{
            .key = key, .label = label, .help = help, .type = Type::ClassCode, .preset = preset, .advanced = true};
    };
    static const StepDescription about{
        .name = "vegetation",
        .title = "Vegetation by height",
        .group = StepGroup::Objects,
        .help =
            "Classifies low, medium and high vegetation by the height above ground, of points that are neither "
            "ground nor anything else yet; run it after buildings. Heights are those of HeightAboveGround, or "
            "measured.",
        .source = "ASPRS LAS 1.4, table 17",
        .parameters = {bound("low", "Low from", "Height from which points are low vegetation.", 0.5),
                       bound("medium", "Medium from", "Height from which vegetation is medium.", 2),
                       bound("high", "High from", "Height from which vegetation is high.", 5),
                       {.key = "from",
                        .label = "Of classes",
                        .help = "The classes whose points may become vegetation.",
                        .type = Type::ClassCodes,
                        .preset = "0-1,3-5",
                        .advanced = true},
                       code("low-class", "Class of low", "The class that low vegetation gets.", "3"),
                       code("medium-class", "Class of medium", "The class that medium vegetation gets.", "4"),
                       code("high-class", "Class of high", "The class that high vegetation gets.", "5"),
                       groundParameter("The classes that are ground, where heights are to be measured.")},
        .shows = "Classification"};
    return about;
}

std::unique_ptr<Command> VegetationStep::make(const PointCloud& cloud, const StepValues& values,
                                              const PointSet* within, Progress& progress) const
{
    std::array<double, 3> from{};
    std::array<std::uint32_t, 3> codes{};
    for (std::size_t k = 0; k < 3; ++k) {
        from[k] = double(float(*realValue(values, kVegetationBounds[k])));  // as heights are
        codes[k] = std::uint32_t(*integerValue(values, kVegetationClasses[k]));
        if (k > 0 && from[k] < from[k - 1])
            throw Error(std::string("vegetation: ") + kVegetationBounds[k] + " is below " +
                        kVegetationBounds[k - 1] + "; the heights must rise.");
    }
    const Attribute classes = classAttribute(cloud, *std::max_element(codes.begin(), codes.end()));
    if (cloud.size() == 0) return nullptr;
    const ClassSet mayChange = classesValue(values, "from");
    const HighPoints known = highPoints(cloud, classesValue(values, "ground"), from, "vegetation", progress);
    const std::vector<PointSet>& high = known.atLeast;
    const auto codeOf = [&](PointIndex i) {
        return high[2].contains(i) ? codes[2] : high[1].contains(i) ? codes[1] : codes[0];
    };

    const ClassReader classOf(cloud);
    const auto deleted = deletedPoints(cloud);
    auto points = std::make_shared<PointSet>(cloud.size());
    progress.begin("Classifying by height", cloud.size());
    forEachSlab(cloud, progress, [&](std::size_t firstWord, std::size_t lastWord) {
        const PointRange range = pointsOfWords(cloud.size(), firstWord, lastWord);
        for (PointIndex i = range.first; i < range.last; ++i) {
            const unsigned now = classOf(i);
            if (!mayChange[now] || !high[0].contains(i)) continue;
            if (deleted && deleted->contains(i)) continue;
            if (codeOf(i) != now) points->insert(i);
        }
    });
    if (within != nullptr) points->intersect(*within);
    std::vector<std::byte> ofPoints;
    ofPoints.reserve(points->count());
    for (std::size_t word = 0; word < points->words().size(); ++word) {
        if (word % kTaskWords == 0) progress.check();
        points->forEachInWords(word, word + 1, [&](PointIndex i) { ofPoints.push_back(std::byte(codeOf(i))); });
    }
    auto command = makeClassCommand("Vegetation by height", classes, std::move(points), std::move(ofPoints));
    if (command) command->setFinding(known.finding);
    return command;
}

}  // namespace punctum
