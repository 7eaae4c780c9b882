// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>

namespace punctum
{

/// 1234567 as "1,234,567": how people are told numbers, in reports and messages.
std::string grouped(std::uint64_t number);

/// The last `digits` hexadecimal digits of a number, in small letters: how files name sums and keys.
std::string hexText(std::uint64_t number, int digits);

/// "1 point", "1,204 points".
std::string pointsText(std::uint64_t count);

}  // namespace punctum
