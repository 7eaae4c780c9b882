// SPDX-License-Identifier: MIT
#include "core/process/Reclassify.h"

#include "core/Error.h"
#include "core/edit/ClassCommand.h"
#include "core/expression/Rule.h"
#include "core/process/Values.h"

#include <cstdint>
#include <shared_mutex>

namespace punctum
{

namespace
{

/// Throws Error unless its values can be compared.
void checkScalar(const PointCloud& cloud, const std::string& name)
{
    const std::shared_lock lock(cloud.mutex());
    const Attribute* const found = cloud.findAttribute(name);
    if (found == nullptr) throw Error("reclassify: this cloud has no attribute \"" + name + "\".");
    if (found->components != 1)
        throw Error("reclassify: " + name + " has three components; choose one of them, such as " +
                    found->columns[0]->name() + ".");
    if (found->kind == AttributeKind::Opaque || found->columns[0]->components() != 1)
        throw Error("reclassify: " + name +
                    " holds bytes that the file does not describe; choose another attribute.");
}

}  // namespace

const StepDescription& ReclassifyStep::description() const
{
    using Type = StepParameter::Type;
    static const StepDescription about{
        .name = "reclassify",
        .title = "Reclassify",
        .group = StepGroup::Classes,
        .help = "Gives a class to all points whose value of an attribute lies in a range, ends included.",
        .parameters =
            {{.key = "attribute",
              .label = "Attribute",
              .help = "The attribute whose values decide.",
              .type = Type::AttributeName},
             {.key = "min", .label = "From", .help = "Lowest value of the range."},
             {.key = "max", .label = "To", .help = "Highest value of the range."},
             {.key = "class", .label = "Class", .help = "The class these points get.", .type = Type::ClassCode}},
        .shows = "Classification"};
    return about;
}

std::unique_ptr<Command> ReclassifyStep::make(const PointCloud& cloud, const StepValues& values,
                                              const PointSet* within, Progress& progress) const
{
    const Value min = *parseNumber(values.at("min")), max = *parseNumber(values.at("max"));
    if (toDouble(min) > toDouble(max))
        throw Error("reclassify: min is " + values.at("min") + ", which is above max, " + values.at("max") + ".");
    const auto code = std::uint32_t(*integerValue(values, "class"));
    checkScalar(cloud, values.at("attribute"));
    return expression::Rule::inRange("Reclassify to " + classLabel(code), classAttribute(cloud, code).name,
                                     std::int64_t(code), values.at("attribute"), min, max)
        .run(cloud, within, progress);
}

}  // namespace punctum
