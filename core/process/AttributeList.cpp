// SPDX-License-Identifier: MIT
#include "core/process/AttributeList.h"

#include "core/Error.h"
#include "core/edit/AttributeName.h"
#include "core/edit/ListCommand.h"
#include "core/process/Values.h"

#include <shared_mutex>

namespace punctum
{

namespace
{

StepParameter attributeParameter(const std::string& help)
{
    return {.key = "attribute",
            .label = "Attribute",
            .help = help,
            .type = StepParameter::Type::AttributeName,
            .ownOnly = true};
}

/// Hold cloud.mutex() shared. Throws Error.
const Attribute& ownAttribute(const PointCloud& cloud, const std::string& name)
{
    const Attribute* const found = cloud.findAttribute(name);
    if (found == nullptr) throw Error("This cloud has no attribute \"" + name + "\".");
    checkOwn(*found);
    return *found;
}

}  // namespace

const StepDescription& RenameStep::description() const
{
    static const StepDescription about{
        .name = "rename",
        .title = "Rename attribute",
        .group = StepGroup::Attributes,
        .help = "Gives an attribute another name: extra bytes of the file, or what a step has computed.",
        .parameters =
            {attributeParameter("The attribute that gets another name."),
             {.key = "to", .label = "New name", .help = "Up to 32 bytes.", .type = StepParameter::Type::Text}},
        .narrows = false};
    return about;
}

std::unique_ptr<Command> RenameStep::make(const PointCloud& cloud, const StepValues& values, const PointSet*,
                                          Progress&) const
{
    const std::string& to = values.at("to");
    const std::shared_lock lock(cloud.mutex());
    const Attribute& attribute = ownAttribute(cloud, values.at("attribute"));
    if (attribute.kind == AttributeKind::Opaque)
        throw Error(attribute.name + " holds bytes that the file does not describe; they have no name to change.");
    if (attribute.components != 1) throw Error(attribute.name + " shows other attributes together; rename these.");
    if (to == attribute.name) return nullptr;
    checkNewName(cloud, to);
    return ListCommand::rename(attribute, to);
}

const StepDescription& RemoveStep::description() const
{
    static const StepDescription about{
        .name = "remove",
        .title = "Remove attribute",
        .group = StepGroup::Attributes,
        .help = "Takes an attribute out, with its values: extra bytes of the file, or what a step has computed.",
        .parameters = {attributeParameter("The attribute that goes.")},
        .narrows = false};
    return about;
}

std::unique_ptr<Command> RemoveStep::make(const PointCloud& cloud, const StepValues& values, const PointSet*,
                                          Progress&) const
{
    const std::shared_lock lock(cloud.mutex());
    return ListCommand::remove(ownAttribute(cloud, values.at("attribute")));
}

}  // namespace punctum
