// SPDX-License-Identifier: MIT
#pragma once

#include "app/Console.h"

#include <string>

namespace punctum::app
{

/// What the steps say of themselves (StepDescription), for `punctum process --list-steps`: groups in order, and
/// their steps.
std::string textOfSteps();
Json jsonOfSteps();
/// The page docs/steps.md.
std::string markdownOfSteps();

}  // namespace punctum::app
