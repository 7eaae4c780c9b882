// SPDX-License-Identifier: MIT
#include "core/process/SetByRule.h"

#include "core/Error.h"
#include "core/expression/Rule.h"
#include "core/process/Values.h"

namespace punctum
{

namespace
{

std::vector<std::string> typeNames()
{
    std::vector<std::string> types;
    for (int type = 0; type <= int(ScalarType::F64); ++type) types.emplace_back(nameOf(ScalarType(type)));
    return types;
}

}  // namespace

const StepDescription& SetByRuleStep::description() const
{
    static const StepDescription about{
        .name = "set",
        .title = "Set by rule",
        .group = StepGroup::Classes,
        .help =
            "Sets an attribute where a condition over attributes holds, such as "
            "Classification = 2 if NormalZ > 0.9 and Z < 12.5.",
        .parameters = {
            {.key = "rule",
             .label = "Rule",
             .help = "Attribute = value if condition; the user guide tells the language.",
             .type = StepParameter::Type::Rule},
            {.key = "new",
             .label = "New attribute",
             .help = "Type of the attribute, when the rule is to add one: the points that no case names get 0.",
             .type = StepParameter::Type::Choice,
             .optional = true,
             .choices = typeNames()}}};
    return about;
}

std::unique_ptr<Command> SetByRuleStep::make(const PointCloud& cloud, const StepValues& values,
                                             const PointSet* within, Progress& progress) const
{
    const expression::Rule rule(values.at("rule"));
    const std::string type = textValue(values, "new");
    if (type.empty()) return rule.run(cloud, within, progress);
    if (within != nullptr) throw Error("The step set adds an attribute to all points, not to some of them.");
    int chosen = 0;
    while (nameOf(ScalarType(chosen)) != type) ++chosen;
    return rule.add(cloud, ScalarType(chosen), nullptr, progress);
}

}  // namespace punctum
