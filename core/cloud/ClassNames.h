// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace punctum
{

/// Noise, below and above what is there (LAS 1.4 R15, table 17).
inline constexpr std::uint32_t kLowNoise = 7, kHighNoise = 18;

/// The standard's name of a class (LAS 1.4 R15, table 17): "Building"; empty where it has none.
std::string_view classNameOf(std::uint32_t code) noexcept;

/// "6 Building"; the code alone where it has no name.
std::string classLabel(std::uint32_t code);

/// The code of a class by its name, in small or capital letters.
std::optional<std::uint32_t> classOfName(std::string_view name) noexcept;

}  // namespace punctum
