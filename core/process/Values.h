// SPDX-License-Identifier: MIT
#pragma once

#include "core/process/Step.h"

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

/// A number as text -> the exact value: whole numbers never pass through a double. Nothing when it is not a number.
std::optional<Value> parseNumber(std::string_view text);

}  // namespace punctum
