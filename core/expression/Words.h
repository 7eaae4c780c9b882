// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace punctum::expression
{

/// Words as people write them, whose letters may be small or large (ASCII; others stay as they are).
char smallLetter(char c);
bool sameWord(std::string_view a, std::string_view b);
/// "; did you mean NormalZ?", or "." when no name is similar.
std::string suggestion(std::string_view word, const std::vector<std::string>& names);

}  // namespace punctum::expression
