// SPDX-License-Identifier: MIT
#include "core/expression/ExpressionError.h"

#include <algorithm>

namespace punctum::expression
{

namespace
{

/// Bytes of UTF-8 that go on with a character are none of their own.
std::size_t columnOf(std::string_view text, std::size_t byte)
{
    const auto begins = [](char c) { return (static_cast<unsigned char>(c) & 0xC0u) != 0x80u; };
    const std::string_view before = text.substr(0, std::min(byte, text.size()));
    return 1 + std::size_t(std::count_if(before.begin(), before.end(), begins));
}

}  // namespace

ExpressionError::ExpressionError(std::string_view text, std::size_t byte, const std::string& sentence)
    : Error("Column " + std::to_string(columnOf(text, byte)) + ": " + sentence), m_column(columnOf(text, byte))
{
}

}  // namespace punctum::expression
