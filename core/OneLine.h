// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace punctum
{

/// In one line whatever it is: control characters become '?'. For names and texts from outside in a sentence.
std::string oneLine(std::string text);

}  // namespace punctum
