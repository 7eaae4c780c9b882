// SPDX-License-Identifier: MIT
#pragma once

#include "ui/process/StepWish.h"

#include <QByteArray>

#include <vector>

namespace punctum::ui
{

/// Steps one after another as a recipe in JSON: {"steps": [{"step": "ground", "values": {...}, "within": "..."}]}.
/// Both throw Error with one sentence: what a recipe cannot hold; what is no recipe.
QByteArray toRecipe(const std::vector<StepWish>& chain);
std::vector<StepWish> fromRecipe(const QByteArray& json);

}  // namespace punctum::ui
