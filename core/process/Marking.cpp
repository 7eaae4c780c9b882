// SPDX-License-Identifier: MIT
#include "core/process/Marking.h"

#include "core/Error.h"
#include "core/cloud/ClassNames.h"
#include "core/cloud/Slabs.h"
#include "core/edit/ClassCommand.h"
#include "core/edit/DeleteCommand.h"
#include "core/process/Values.h"
#include "core/task/Progress.h"

#include <utility>

namespace punctum
{

namespace
{

Attribute withheldAttribute(const PointCloud& cloud)
{
    const std::shared_lock lock(cloud.mutex());
    const Attribute* const found = cloud.findAttribute("Withheld");
    if (found == nullptr || found->type() != ScalarType::U8)
        throw Error("This cloud has no Withheld flags; choose a class, or delete the points.");
    return *found;
}

}  // namespace

StepParameter doParameter(std::vector<std::string> choices, std::string preset, std::string help)
{
    return {.key = "do",
            .label = "Do",
            .help = std::move(help),
            .type = StepParameter::Type::Choice,
            .preset = std::move(preset),
            .choices = std::move(choices)};
}

StepParameter doClassParameter(std::string preset, std::string help)
{
    const bool optional = preset.empty();
    return {.key = "class",
            .label = "Class",
            .help = std::move(help),
            .type = StepParameter::Type::ClassCode,
            .preset = std::move(preset),
            .optional = optional,
            .when = {"do", "class"}};
}

std::unique_ptr<Command> markPoints(const std::string& name, const PointCloud& cloud,
                                    std::shared_ptr<PointSet> points, const StepValues& values, Progress& progress)
{
    const std::string what = textValue(values, "do");
    if (const auto deleted = deletedPoints(cloud)) points->remove(*deleted);
    if (what == "delete") {
        if (points->count() == 0) return nullptr;
        return std::make_unique<DeleteCommand>(name + ": delete", std::move(points));
    }
    if (what == "withheld") {
        const Attribute flag = withheldAttribute(cloud);
        progress.begin("Marking points", cloud.size());
        leaveOutValue(*points, cloud, flag, 1, progress);
        const PointIndex count = points->count();
        if (count == 0) return nullptr;
        return std::make_unique<ValueCommand>(name + ": withheld", flag, std::move(points),
                                              std::vector<std::byte>(count, std::byte(1u << flag.bitShift)));
    }
    const auto code = integerValue(values, "class");
    if (!code) throw Error("Say which class the points get: class=.");
    const Attribute classes = classAttribute(cloud, std::uint32_t(*code));
    progress.begin("Marking points", cloud.size());
    leaveOutValue(*points, cloud, classes, std::uint32_t(*code), progress);
    return makeClassCommand(name + " to " + classLabel(std::uint32_t(*code)), classes, std::move(points),
                            std::uint32_t(*code));
}

std::shared_ptr<const PointSet> pointsLeftOut(const PointCloud& cloud, bool noise, Progress& progress)
{
    std::shared_ptr<const PointSet> deleted = deletedPoints(cloud);
    if (!noise) return deleted;
    Attribute classes;
    {
        const std::shared_lock lock(cloud.mutex());
        const Attribute* const found = cloud.findAttribute("Classification");
        if (found == nullptr || found->type() != ScalarType::U8 || found->columns[0]->components() != 1)
            return deleted;
        classes = *found;
    }
    auto all = deleted ? std::make_shared<PointSet>(*deleted) : std::make_shared<PointSet>(cloud.size());
    const std::uint8_t* const byte = classes.columns[0]->values<std::uint8_t>().data();
    const auto mask = std::uint8_t(classes.maxBits());
    const unsigned shift = classes.bitShift;
    progress.begin("Leaving out noise", cloud.size());
    forEachSlab(cloud, progress, [&](std::size_t firstWord, std::size_t lastWord) {
        const std::size_t last = std::min<std::size_t>(cloud.size(), lastWord * 64);
        for (std::size_t i = firstWord * 64; i < last; ++i) {
            const auto code = std::uint32_t((byte[i] >> shift) & mask);
            if (code == kLowNoise || code == kHighNoise) all->insert(i);
        }
    });
    return all;
}

std::shared_ptr<const PointSet> pointsOutside(const PointCloud& cloud, const PointSet* within)
{
    std::shared_ptr<const PointSet> deleted = deletedPoints(cloud);
    if (within == nullptr) return deleted;
    auto out = std::make_shared<PointSet>(*within);
    out->invert();
    if (deleted) out->insert(*deleted);
    return out;
}

}  // namespace punctum
