// SPDX-License-Identifier: MIT
#include "core/process/MakeCommand.h"

#include "core/Error.h"
#include "core/edit/Literal.h"
#include "core/process/Step.h"

namespace punctum
{

std::unique_ptr<Command> makeCommand(const Recipe& recipe, const PointCloud& cloud, Progress& progress)
{
    const bool literal = recipe.step == kLiteralStep;
    const Step* const step = findStep(recipe.step);
    if (!literal && step == nullptr) throw Error("There is no step \"" + recipe.step + "\".");
    if (recipe.within && recipe.within->size() != cloud.size())
        throw Error("The points that are to change are those of another cloud.");
    auto command = literal         ? makeLiteral(recipe, cloud)
                   : recipe.within ? step->runWithin(cloud, recipe.values, *recipe.within, progress)
                                   : step->run(cloud, recipe.values, progress);
    if (command) command->setRecipe(recipe);
    return command;
}

}  // namespace punctum
