// SPDX-License-Identifier: MIT
#include "core/expression/ExpressionError.h"
#include "core/expression/Lexer.h"
#include "core/expression/Syntax.h"

#include <array>
#include <span>
#include <utility>

namespace punctum::expression
{

namespace
{

using Kind = Syntax::Kind;

/// Nested brackets, signs and functions: each takes some of the stack, here and when it is evaluated.
constexpr int kMostNested = 60;

constexpr std::array<std::string_view, 6> kComparisonSigns = {"==", "!=", "<=", ">=", "<", ">"};
constexpr std::array<std::string_view, 2> kSums = {"+", "-"};
constexpr std::array<std::string_view, 4> kProducts = {"*", "/", "//", "%"};

/// Recursive descent, one function a level of binding, loosest first.
class Parser
{
public:
    explicit Parser(std::string_view text) : m_text(text), m_tokens(tokenize(text)) {}

    Syntax expression()
    {
        if (peek().kind == Token::Kind::End) fail("an expression is missing.");
        Syntax all = conditional();
        end();
        return all;
    }

    Assignment assignment()
    {
        Assignment rule;
        const Token& name = peek();
        if (name.kind != Token::Kind::Name && name.kind != Token::Kind::QuotedName)
            fail("a rule begins with the name of the attribute it sets, such as Classification = 2.");
        rule.target = name.text;
        rule.targetByte = name.byte;
        ++m_at;
        if (peek().isSign("==")) fail("a rule sets with a single \"=\".");
        if (!takeSign("=")) fail("\"=\" is missing behind the name of the attribute that is to be set.");
        for (;;) {
            auto& one = rule.cases.emplace_back();
            one.value = disjunction();
            if (!takeKeyword("if")) break;
            one.conditionByte = peek().byte;
            one.condition.push_back(disjunction());
            if (!takeKeyword("else")) break;
        }
        end();
        return rule;
    }

private:
    /// Counts how deep the parser is in itself.
    class Nested
    {
    public:
        explicit Nested(Parser& parser) : m_parser(parser)
        {
            if (++m_parser.m_nested > kMostNested) m_parser.fail("the expression is nested too deeply.");
        }
        ~Nested() { --m_parser.m_nested; }

    private:
        Parser& m_parser;
    };

    const Token& peek() const { return m_tokens[m_at]; }
    [[noreturn]] void fail(const std::string& sentence) const
    {
        throw ExpressionError(m_text, peek().byte, sentence);
    }
    bool takeSign(std::string_view sign)
    {
        if (!peek().isSign(sign)) return false;
        ++m_at;
        return true;
    }
    bool takeKeyword(std::string_view keyword)
    {
        if (!peek().isKeyword(keyword)) return false;
        ++m_at;
        return true;
    }
    /// "\")\"", "\"and\"", or that the end has come.
    std::string found() const
    {
        return peek().kind == Token::Kind::End ? "the expression ends here" : "found \"" + peek().text + "\"";
    }
    void end()
    {
        if (peek().kind == Token::Kind::End) return;
        if (peek().isSign("=")) fail("write \"==\" to compare.");
        if (peek().isSign(")")) fail("there is no bracket that this one closes.");
        if (peek().isKeyword("if")) fail("\"if\" has no place here.");
        fail("a sign such as + or \"and\" is missing before \"" + peek().text + "\".");
    }

    static Syntax make(Kind kind, std::size_t byte, std::vector<Syntax> children, std::string text = {})
    {
        Syntax s;
        s.kind = kind;
        s.byte = byte;
        s.text = std::move(text);
        s.children = std::move(children);
        return s;
    }
    template <typename... Children>
    static std::vector<Syntax> list(Children&&... children)
    {
        std::vector<Syntax> all;
        all.reserve(sizeof...(children));
        (all.push_back(std::move(children)), ...);
        return all;
    }

    Syntax conditional()
    {
        const Nested nested(*this);
        Syntax value = disjunction();
        const std::size_t byte = peek().byte;
        if (!takeKeyword("if")) return value;
        Syntax condition = disjunction();
        if (!takeKeyword("else")) fail("\"else\" is missing: " + found() + ".");
        Syntax other = conditional();
        return make(Kind::Conditional, byte, list(std::move(value), std::move(condition), std::move(other)));
    }

    template <typename Next>
    Syntax joined(Kind kind, std::string_view keyword, Next next)
    {
        Syntax first = next();
        if (!peek().isKeyword(keyword)) return first;
        Syntax all = make(kind, peek().byte, list(std::move(first)));
        while (takeKeyword(keyword)) all.children.push_back(next());
        return all;
    }
    Syntax disjunction()
    {
        return joined(Kind::Or, "or", [this] { return conjunction(); });
    }
    Syntax conjunction()
    {
        return joined(Kind::And, "and", [this] { return negation(); });
    }
    Syntax negation()
    {
        const std::size_t byte = peek().byte;
        if (!takeKeyword("not")) return comparison();
        const Nested nested(*this);
        return make(Kind::Not, byte, list(negation()));
    }

    /// The sign when the next token is one of these.
    const Token* takeOneOf(std::span<const std::string_view> signs)
    {
        for (const std::string_view sign : signs)
            if (peek().isSign(sign)) return &m_tokens[m_at++];
        return nullptr;
    }

    Syntax comparison()
    {
        Syntax left = sum();
        const std::size_t byte = peek().byte;
        const bool negated = peek().isKeyword("not");
        if (negated) {
            ++m_at;
            if (!peek().isKeyword("in") && !peek().isKeyword("between"))
                fail("\"in\" or \"between\" is missing behind \"not\".");
        }
        if (takeKeyword("in") || peek().isKeyword("between")) {
            Syntax all = make(Kind::In, byte, list(std::move(left)));
            if (takeKeyword("between")) {
                all.children.push_back(sum());
                if (!takeKeyword("and")) fail("\"and\" is missing behind \"between\": " + found() + ".");
                all.children.push_back(sum());
            } else if (takeSign("(")) {
                do range(all);
                while (takeSign(","));
                if (!takeSign(")")) fail("\",\" or \")\" is missing: " + found() + ".");
            } else {
                range(all);
            }
            return negated ? make(Kind::Not, byte, list(std::move(all))) : all;
        }
        // 0.2 < Z < 5 means 0.2 < Z and Z < 5
        Syntax chain = make(Kind::And, byte, {});
        while (const Token* sign = takeOneOf(kComparisonSigns)) {
            Syntax right = sum();
            chain.children.push_back(
                make(Kind::Compare, sign->byte, list(std::move(left), Syntax(right)), sign->text));
            left = std::move(right);
        }
        if (peek().isSign("=")) fail("write \"==\" to compare.");
        if (chain.children.empty()) return left;
        if (chain.children.size() > 1) return chain;
        Syntax only = std::move(chain.children.front());
        return only;
    }

    /// A value or lowest..highest.
    void range(Syntax& in)
    {
        in.children.push_back(sum());
        in.children.push_back(takeSign("..") ? sum() : Syntax(in.children.back()));
    }

    template <typename Next>
    Syntax chained(std::span<const std::string_view> signs, Next next)
    {
        Syntax left = next();
        while (const Token* sign = takeOneOf(signs)) {
            Syntax right = next();
            left = make(Kind::Arithmetic, sign->byte, list(std::move(left), std::move(right)), sign->text);
        }
        return left;
    }
    Syntax sum()
    {
        return chained(kSums, [this] { return product(); });
    }
    Syntax product()
    {
        return chained(kProducts, [this] { return negative(); });
    }
    Syntax negative()
    {
        const Nested nested(*this);
        const std::size_t byte = peek().byte;
        if (takeSign("-")) return make(Kind::Negate, byte, list(negative()));
        if (takeSign("+")) return negative();
        return power();
    }
    Syntax power()
    {
        Syntax base = primary();
        const std::size_t byte = peek().byte;
        if (!takeSign("**")) return base;
        return make(Kind::Arithmetic, byte, list(std::move(base), negative()), "**");  // 2 ** -1, 2 ** 3 ** 2
    }

    Syntax primary()
    {
        const Token& token = peek();
        if (takeSign("(")) {
            Syntax inner = conditional();
            if (peek().isSign(",")) fail("a list of values has its place behind \"in\" only.");
            if (!takeSign(")")) fail("\")\" is missing: " + found() + ".");
            return inner;
        }
        Syntax leaf;
        leaf.byte = token.byte;
        leaf.text = token.text;
        switch (token.kind) {
            case Token::Kind::Number:
                ++m_at;
                leaf.number = token.number;
                return leaf;
            case Token::Kind::QuotedName:
                leaf.quoted = true;
                [[fallthrough]];
            case Token::Kind::Name:
                ++m_at;
                leaf.kind = Kind::Name;
                if (!leaf.quoted && takeSign("(")) arguments(leaf);
                return leaf;
            default:
                fail("a value is missing: " + found() + ".");
        }
    }

    void arguments(Syntax& call)
    {
        call.kind = Kind::Call;
        if (takeSign(")")) return;
        do call.children.push_back(conditional());
        while (takeSign(","));
        if (!takeSign(")")) fail("\",\" or \")\" is missing: " + found() + ".");
    }

    std::string_view m_text;
    std::vector<Token> m_tokens;
    std::size_t m_at = 0;
    int m_nested = 0;
};

}  // namespace

Syntax parseExpression(std::string_view text)
{
    return Parser(text).expression();
}

Assignment parseAssignment(std::string_view text)
{
    return Parser(text).assignment();
}

std::string quotedName(const std::string& name)
{
    if (isPlainName(name)) return name;
    const char mark = name.find('"') == std::string::npos ? '"' : '\'';
    return mark + name + mark;
}

}  // namespace punctum::expression
