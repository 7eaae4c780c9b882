// SPDX-License-Identifier: MIT
#include "core/expression/Functions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace punctum::expression
{

namespace
{

constexpr auto kFunctions = std::to_array<Function>({
    {"floor", 1, [](double a, double) { return std::floor(a); }, true},
    {"ceil", 1, [](double a, double) { return std::ceil(a); }, true},
    {"round", 1, [](double a, double) { return std::round(a); }, true},
    {"trunc", 1, [](double a, double) { return std::trunc(a); }, true},
    {"sign", 1, [](double a, double) { return a > 0   ? 1.0
                                              : a < 0 ? -1.0
                                                      : a; }, true},
    {"sqrt", 1, [](double a, double) { return std::sqrt(a); }},
    {"exp", 1, [](double a, double) { return std::exp(a); }},
    {"log", 1, [](double a, double) { return std::log(a); }},
    {"log10", 1, [](double a, double) { return std::log10(a); }},
    {"sin", 1, [](double a, double) { return std::sin(a); }},
    {"cos", 1, [](double a, double) { return std::cos(a); }},
    {"tan", 1, [](double a, double) { return std::tan(a); }},
    {"asin", 1, [](double a, double) { return std::asin(a); }},
    {"acos", 1, [](double a, double) { return std::acos(a); }},
    {"atan", 1, [](double a, double) { return std::atan(a); }},
    {"atan2", 2, [](double a, double b) { return std::atan2(a, b); }},
    {"hypot", 2, [](double a, double b) { return std::hypot(a, b); }},
    {"degrees", 1, [](double a, double) { return a * (180.0 / std::numbers::pi); }},
    {"radians", 1, [](double a, double) { return a * (std::numbers::pi / 180.0); }},
});

constexpr std::array<std::string_view, 5> kOtherFunctions = {"abs", "min", "max", "clamp", "exists"};

}  // namespace

const Function* findFunction(std::string_view name)
{
    const auto it = std::find_if(kFunctions.begin(), kFunctions.end(), [&](auto& f) { return f.name == name; });
    return it == kFunctions.end() ? nullptr : &*it;
}

std::vector<std::string> functionNames()
{
    std::vector<std::string> names(kOtherFunctions.begin(), kOtherFunctions.end());
    for (const Function& f : kFunctions) names.emplace_back(f.name);
    return names;
}

}  // namespace punctum::expression
