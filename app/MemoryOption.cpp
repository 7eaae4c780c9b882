// SPDX-License-Identifier: MIT
#include "app/MemoryOption.h"

#include "core/Memory.h"

#include <cctype>
#include <cmath>
#include <cstdint>
#include <regex>

namespace punctum::app
{

std::string takeMemoryBudget(const std::string& text)
{
    static const std::regex form("\\s*(\\d{1,9}(?:\\.\\d{1,6})?)\\s*([KMGT])(i?)B?\\s*", std::regex::icase);
    constexpr double kLeast = 16e6, kMost = 1e15;
    std::smatch part;
    double bytes = 0;
    if (std::regex_match(text, part, form)) {
        const auto power = std::string("KMGT").find(char(std::toupper(part.str(2)[0]))) + 1;
        bytes = std::stod(part.str(1)) * std::pow(part.length(3) != 0 ? 1024.0 : 1000.0, double(power));
    }
    if (!(bytes >= kLeast && bytes <= kMost))
        return "--memory must be a size from 16M to 1000T, such as 2G, not \"" + text + "\".";
    setMemoryBudget(std::uint64_t(bytes));
    return {};
}

}  // namespace punctum::app
