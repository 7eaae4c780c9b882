// SPDX-License-Identifier: MIT
#include "core/steps/MakeCommand.h"

#include "core/Error.h"
#include "core/edit/Literal.h"
#include "core/steps/Steps.h"

namespace punctum
{

std::unique_ptr<Command> makeCommand(const Recipe& recipe, const PointCloud& cloud, Progress& progress)
{
    const bool literal = recipe.step == kLiteralStep;
    const Step* const step = findStep(recipe.step);
    if (!literal && step == nullptr) throw Error("There is no step \"" + recipe.step + "\".");
    if (recipe.within && recipe.within->size() != cloud.size())
        throw Error("The points that are to change are those of another cloud.");
    auto command =
        literal ? makeLiteral(recipe, cloud) : step->run(cloud, recipe.values, progress, recipe.within.get());
    if (command) command->setRecipe(recipe);
    return command;
}

}  // namespace punctum
