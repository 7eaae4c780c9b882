// SPDX-License-Identifier: MIT
#include "core/process/SetByRule.h"

#include "core/expression/Rule.h"
#include "core/process/Values.h"

namespace punctum
{

std::string SetByRuleStep::help() const
{
    return "Sets an attribute where a condition over attributes holds, such as "
           "Classification = 2 if NormalZ > 0.9 and Z < 12.5.";
}

std::vector<StepParameter> SetByRuleStep::parameters() const
{
    std::vector<std::string> types;
    for (int type = 0; type <= int(ScalarType::F64); ++type) types.emplace_back(nameOf(ScalarType(type)));
    return {{.key = "rule",
             .label = "Rule",
             .help = "Attribute = value if condition; the user guide tells the language.",
             .type = StepParameter::Type::Rule},
            {.key = "new",
             .label = "New attribute",
             .help = "Type of the attribute, when the rule is to add one: the points that no case names get 0.",
             .type = StepParameter::Type::Choice,
             .optional = true,
             .choices = std::move(types)}};
}

std::unique_ptr<Command> SetByRuleStep::run(const PointCloud& cloud, const StepValues& values,
                                            Progress& progress) const
{
    const StepValues complete = completeValues(*this, values);
    const expression::Rule rule(complete.at("rule"));
    const std::string type = textValue(complete, "new");
    if (type.empty()) return rule.run(cloud, nullptr, progress);
    int chosen = 0;
    while (nameOf(ScalarType(chosen)) != type) ++chosen;
    return rule.add(cloud, ScalarType(chosen), nullptr, progress);
}

std::unique_ptr<Command> SetByRuleStep::runWithin(const PointCloud& cloud, const StepValues& values,
                                                  const PointSet& within, Progress& progress) const
{
    const StepValues complete = completeValues(*this, values);
    if (!textValue(complete, "new").empty()) return Step::runWithin(cloud, complete, within, progress);
    return expression::Rule(complete.at("rule")).run(cloud, &within, progress);
}

}  // namespace punctum
