// SPDX-License-Identifier: MIT
#pragma once

#include "core/process/Step.h"

#include <span>
#include <string_view>

namespace punctum
{

/// All steps there are, in the order they are listed to users: by group.
std::span<const Step* const> allSteps();
/// Null when there is none of that name.
const Step* findStep(std::string_view name);

/// "normals k=16" -> the step and its values. Throws Error on an unknown name or key, or a value out of bounds.
/// `narrowed`: the step will be told which points it may change; throws Error where it cannot be.
struct ParsedStep {
    const Step* step = nullptr;
    StepValues values;
};
ParsedStep parseStep(std::string_view text, bool narrowed = false);

}  // namespace punctum
