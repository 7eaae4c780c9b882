// SPDX-License-Identifier: MIT
#pragma once

#include "core/edit/Command.h"
#include "core/edit/Recipe.h"

#include <memory>

namespace punctum
{

class Progress;

/// Makes the command that a recipe tells of, or a literal of a journal (Literal.h), for this cloud; null when
/// nothing would change. The command keeps the recipe. Throws as Step::run() does.
std::unique_ptr<Command> makeCommand(const Recipe& recipe, const PointCloud& cloud, Progress& progress);

}  // namespace punctum
