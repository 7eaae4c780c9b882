// SPDX-License-Identifier: MIT
#pragma once

#include "core/Error.h"

#include <cstddef>
#include <string>
#include <string_view>

namespace punctum::expression
{

/// What is wrong with an expression, and where: "Column 16: there is no attribute ..." (a whole sentence).
class ExpressionError : public Error
{
public:
    /// `byte`: where in `text` the trouble begins.
    ExpressionError(std::string_view text, std::size_t byte, const std::string& sentence);

    /// From 1, in characters as people count them, not in bytes.
    std::size_t column() const noexcept { return m_column; }

private:
    std::size_t m_column;
};

}  // namespace punctum::expression
