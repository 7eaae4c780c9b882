// SPDX-License-Identifier: MIT
#include "core/Text.h"

namespace punctum
{

std::string grouped(std::uint64_t number)
{
    std::string text = std::to_string(number);
    for (std::size_t at = text.size(); at > 3; at -= 3) text.insert(at - 3, 1, ',');
    return text;
}

std::string hexText(std::uint64_t number, int digits)
{
    std::string text(std::size_t(digits), '0');
    for (auto digit = text.rbegin(); digit != text.rend(); ++digit, number >>= 4)
        *digit = "0123456789abcdef"[number & 15u];
    return text;
}

std::string pointsText(std::uint64_t count)
{
    return count == 1 ? "1 point" : grouped(count) + " points";
}

}  // namespace punctum
