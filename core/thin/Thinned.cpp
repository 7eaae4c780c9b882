// SPDX-License-Identifier: MIT
#include "core/thin/Thinned.h"

#include "core/Text.h"
#include "core/cloud/ValueText.h"
#include "core/measure/Spacing.h"
#include "core/process/FilledAttribute.h"
#include "core/process/Marking.h"
#include "core/process/Values.h"
#include "core/task/Progress.h"

#include <cmath>
#include <cstdio>

namespace punctum
{

namespace
{

constexpr std::size_t kSpacingPoints = 1024;  ///< looked at to tell the spacing of what is kept: a few milliseconds

/// "Kept 12,345 of 1,204,567 points; spacing 0.51 m."
std::string keptText(const PointCloud& cloud, const PointSet& kept, PointIndex of)
{
    const PointIndex count = kept.count();
    std::string text = "Kept " + grouped(count) + " of " + pointsText(of);
    const TrueLengths lengths = trueLengths(cloud);
    std::vector<glm::vec3> sample;
    glm::dvec3 origin{};
    PointIndex at = 0;
    // One of each run of kept points, now the earlier one and now the later one: scan lines must not beat with
    // them.
    const PointIndex step = std::max<PointIndex>(1, count / kSpacingPoints);
    kept.forEach([&](PointIndex i) {
        const PointIndex number = at++;
        if (number % step != (number / step * 7919) % step || sample.size() >= kSpacingPoints) return;
        if (sample.empty()) origin = cloud.world(i);
        sample.emplace_back((cloud.world(i) - origin) * lengths.stretch);
    });
    const double spacing = pointSpacing(sample, count);
    if (spacing > 0) {
        char digits[32];
        std::snprintf(digits, sizeof digits, "%.2g", spacing);
        text += "; spacing " + std::string(digits) + (lengths.unit.empty() ? " units" : " " + lengths.unit);
    }
    return text + ".";
}

}  // namespace

std::vector<StepParameter> thinnedParameters()
{
    return {
        doParameter(
            {"delete", "withheld", "class", "attribute"}, "delete",
            "What is not kept is deleted, gets the flag Withheld or a class, or is told by the attribute Kept."),
        doClassParameter("", "The class of points that are not kept.")};
}

std::unique_ptr<Command> thinTo(const std::string& name, const PointCloud& cloud, const PointSet& kept,
                                const PointSet* leftOut, const StepValues& values, Progress& progress)
{
    auto dropped = std::make_shared<PointSet>(kept);
    dropped->invert();
    if (leftOut != nullptr) dropped->remove(*leftOut);
    const PointIndex gone = dropped->count(), looked = kept.count() + gone;
    if (looked == 0) return nullptr;
    const std::string finding = keptText(cloud, kept, looked);
    std::unique_ptr<Command> command;
    if (textValue(values, "do") == "attribute") {
        FilledAttribute attribute(cloud, {.name = "Kept",
                                          .description = "1 kept, 0 not, when thinned",
                                          .type = ScalarType::U8,
                                          .kind = AttributeKind::Category,
                                          .unset = 1});
        progress.begin("Marking points", looked);
        kept.forEach([&](PointIndex i) { attribute.set(i, 1); });
        progress.check();
        dropped->forEach([&](PointIndex i) { attribute.set(i, 0); });
        command =
            std::make_unique<AttributesCommand>(name + ": attribute Kept", std::vector{attribute.attribute()});
    } else {
        command = markPoints(name, cloud, std::move(dropped), values, progress);
    }
    if (command) command->setFinding(finding);
    return command;
}

}  // namespace punctum
