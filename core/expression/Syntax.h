// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Attribute.h"

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace punctum::expression
{

/// A node of the syntax tree: what was written, before anybody asks which attributes there are.
struct Syntax {
    enum class Kind {
        Number,       ///< `number`
        Name,         ///< an attribute, a class or a constant: `text`
        Call,         ///< function `text` of the children
        Negate,       ///< one child
        Arithmetic,   ///< two children, `text` is the sign: + - * / // % **
        Compare,      ///< two children, `text` is the sign: == != < <= > >=
        In,           ///< the first child in one of the ranges [child 1, child 2], [child 3, child 4], ...
        Not,          ///< one child
        And,          ///< two or more children
        Or,           ///< two or more children
        Conditional,  ///< child 0 if child 1 else child 2
    };
    Kind kind = Kind::Number;
    std::size_t byte = 0;  ///< where in the text it begins; of a sign: the sign
    std::string text{};
    Value number = 0.0;
    bool quoted = false;  ///< a name in quotation marks
    std::vector<Syntax> children{};
};

/// Target = value if condition else value if condition else value: the first condition that holds decides.
struct Assignment {
    struct Case {
        Syntax value;
        std::vector<Syntax> condition{};  ///< one, or none: all points that are left
        std::size_t conditionByte = 0;    ///< where in the text it begins
    };
    std::string target;
    std::size_t targetByte = 0;
    std::vector<Case> cases;
};

/// Texts come from people, files and other programs: both refuse what is nested or long beyond any use.
/// Throw ExpressionError. The grammar is told in docs/user.md, "Rules".
Syntax parseExpression(std::string_view text);
Assignment parseAssignment(std::string_view text);

/// The name as it has to be written in an expression: in quotation marks when it is not one plain word.
std::string quotedName(const std::string& name);

}  // namespace punctum::expression
