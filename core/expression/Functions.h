// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace punctum::expression
{

/// A function of one or two numbers.
struct Function {
    std::string_view name;
    std::size_t arguments;
    double (*call)(double, double);
    bool integral = false;  ///< gives whole numbers
};

/// Null when there is none of that name, which has small letters only. min, max, abs, clamp and exists, which know
/// wide integers, are not among them.
const Function* findFunction(std::string_view name);
/// Of all functions, those that findFunction() does not know among them.
std::vector<std::string> functionNames();

}  // namespace punctum::expression
