// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Attribute.h"

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace punctum::expression
{

/// A word, number or sign of an expression.
struct Token {
    enum class Kind { Number, Name, QuotedName, Keyword, Sign, End };
    Kind kind = Kind::End;
    std::size_t byte = 0;  ///< where in the text it begins
    std::string text;      ///< keywords in small letters; names without their quotation marks
    Value number = 0.0;

    bool is(Kind k, std::string_view t) const noexcept { return kind == k && text == t; }
    bool isSign(std::string_view t) const noexcept { return is(Kind::Sign, t); }
    bool isKeyword(std::string_view t) const noexcept { return is(Kind::Keyword, t); }
};

/// The text's tokens, an End last. Throws ExpressionError.
std::vector<Token> tokenize(std::string_view text);

/// Whether the word can be written as a name without quotation marks.
bool isPlainName(std::string_view word);

}  // namespace punctum::expression
