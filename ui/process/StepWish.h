// SPDX-License-Identifier: MIT
#pragma once

#include "core/process/StepParameter.h"
#include "core/process/StepScope.h"

#include <string>

namespace punctum::ui
{

/// A step as the panel has it: what is to be done, with which values, to which points.
struct StepWish {
    std::string step;
    StepValues values;
    StepScope scope;
};

}  // namespace punctum::ui
