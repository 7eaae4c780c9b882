// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Attribute.h"
#include "core/process/StepParameter.h"

#include <bitset>
#include <cstdint>
#include <optional>
#include <string_view>

namespace punctum
{

/// Reads checked parameter values; private to the steps. The values must have passed completeValues(), so that
/// what is there can be read; asking for a key that is not there gives nothing.

std::optional<double> realValue(const StepValues& values, std::string_view key);
std::optional<std::int64_t> integerValue(const StepValues& values, std::string_view key);
std::string textValue(const StepValues& values, std::string_view key);
using ClassSet = std::bitset<256>;
ClassSet classesValue(const StepValues& values, std::string_view key);  ///< none where it is not there

/// A number as text -> the exact value: whole numbers never pass through a double. Nothing when it is not a number.
std::optional<Value> parseNumber(std::string_view text);
/// "2,8-9" -> the classes; "none": none. Nothing when it is no such list.
std::optional<ClassSet> parseClasses(std::string_view text);

}  // namespace punctum
