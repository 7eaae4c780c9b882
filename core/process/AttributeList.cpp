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

std::string RenameStep::help() const
{
    return "Gives an attribute another name: extra bytes of the file, or what a step has computed.";
}

std::vector<StepParameter> RenameStep::parameters() const
{
    return {attributeParameter("The attribute that gets another name."),
            {.key = "to", .label = "New name", .help = "Up to 32 bytes.", .type = StepParameter::Type::Text}};
}

std::unique_ptr<Command> RenameStep::run(const PointCloud& cloud, const StepValues& values, Progress&) const
{
    const StepValues complete = completeValues(*this, values);
    const std::string& to = complete.at("to");
    const std::shared_lock lock(cloud.mutex());
    const Attribute& attribute = ownAttribute(cloud, complete.at("attribute"));
    if (attribute.kind == AttributeKind::Opaque)
        throw Error(attribute.name + " holds bytes that the file does not describe; they have no name to change.");
    if (attribute.components != 1) throw Error(attribute.name + " shows other attributes together; rename these.");
    if (to == attribute.name) return nullptr;
    checkNewName(cloud, to);
    return ListCommand::rename(attribute, to);
}

std::string RemoveStep::help() const
{
    return "Takes an attribute out, with its values: extra bytes of the file, or what a step has computed.";
}

std::vector<StepParameter> RemoveStep::parameters() const
{
    return {attributeParameter("The attribute that goes.")};
}

std::unique_ptr<Command> RemoveStep::run(const PointCloud& cloud, const StepValues& values, Progress&) const
{
    const StepValues complete = completeValues(*this, values);
    const std::shared_lock lock(cloud.mutex());
    return ListCommand::remove(ownAttribute(cloud, complete.at("attribute")));
}

}  // namespace punctum
