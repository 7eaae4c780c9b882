// SPDX-License-Identifier: MIT
#include "core/process/MakeCommand.h"

#include "core/Error.h"
#include "core/expression/Rule.h"
#include "core/process/Step.h"

namespace punctum
{

std::unique_ptr<Command> makeCommand(const Recipe& recipe, const PointCloud& cloud, Progress& progress)
{
    const Step* const step = findStep(recipe.step);
    if (step == nullptr) throw Error("There is no step \"" + recipe.step + "\".");
    if (recipe.within && recipe.within->size() != cloud.size())
        throw Error("The points that are to change are those of another cloud.");
    const StepValues values = completeValues(*step, recipe.values);
    std::unique_ptr<Command> command;
    if (!recipe.within)
        command = step->run(cloud, values, progress);
    else if (recipe.step == "set" && !values.contains("new"))
        command = expression::Rule(values.at("rule")).run(cloud, recipe.within.get(), progress);
    else
        throw Error("The step " + recipe.step + " changes all points, not some of them.");
    if (command) command->setRecipe(recipe);
    return command;
}

}  // namespace punctum
