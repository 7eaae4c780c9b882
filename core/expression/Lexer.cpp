// SPDX-License-Identifier: MIT
#include "core/expression/Lexer.h"

#include "core/expression/ExpressionError.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>

namespace punctum::expression
{

namespace
{

constexpr std::size_t kMostTokens = 1000;

constexpr std::array<std::string_view, 7> kKeywords = {"and", "or", "not", "in", "between", "if", "else"};

// Longer signs first, so that <= is not read as < and =.
constexpr std::array<std::string_view, 19> kSigns = {"..", "**", "//", "==", "!=", "<=", ">=", "<", ">", "=",
                                                     "+",  "-",  "*",  "/",  "%",  "(",  ")",  ",", ";"};

/// What people write who think of another language, and what it is here.
constexpr std::array<std::array<std::string_view, 2>, 6> kForeignSigns = {
    {{"&&", "and"}, {"||", "or"}, {"<>", "!="}, {"!", "not"}, {"^", "**"}, {"\u2260", "!="}}};

bool isDigit(char c)
{
    return c >= '0' && c <= '9';
}

bool beginsName(char c)
{
    // bytes from 128 on: letters of other scripts, in UTF-8
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || static_cast<unsigned char>(c) >= 128;
}

std::size_t nameLength(std::string_view text)
{
    std::size_t n = 0;
    while (n < text.size() && (beginsName(text[n]) || (n > 0 && isDigit(text[n])))) ++n;
    return n;
}

/// The keyword that the word is, in small or in capital letters; empty when it is none.
std::string_view keywordOf(std::string_view word)
{
    const auto same = [&](std::string_view keyword) {
        const auto capital = [](char a, char b) { return a == char(b - 'a' + 'A'); };
        return word == keyword || std::equal(word.begin(), word.end(), keyword.begin(), keyword.end(), capital);
    };
    const auto it = std::find_if(kKeywords.begin(), kKeywords.end(), same);
    return it == kKeywords.end() ? std::string_view() : *it;
}

class Lexer
{
public:
    explicit Lexer(std::string_view text) : m_text(text) {}

    std::vector<Token> run()
    {
        std::vector<Token> tokens;
        for (;;) {
            while (m_at < m_text.size() && std::string_view(" \t\r\n").find(m_text[m_at]) != std::string_view::npos)
                ++m_at;
            tokens.push_back(next());
            if (tokens.back().kind == Token::Kind::End) return tokens;
            if (tokens.size() > kMostTokens) fail(m_at, "the expression is too long; split it into several.");
        }
    }

private:
    [[noreturn]] void fail(std::size_t byte, const std::string& sentence) const
    {
        throw ExpressionError(m_text, byte, sentence);
    }

    Token next()
    {
        Token token;
        token.byte = m_at;
        const std::string_view rest = m_text.substr(m_at);
        if (rest.empty()) return token;
        const char c = rest.front();
        if (isDigit(c) || (c == '.' && rest.size() > 1 && isDigit(rest[1]))) return number(token, rest);
        if (c == '"' || c == '\'') return quoted(token, rest);
        for (const auto& [foreign, ours] : kForeignSigns)
            if (rest.starts_with(foreign) && !rest.starts_with("!="))
                fail(m_at, "write \"" + std::string(ours) + "\" in place of \"" + std::string(foreign) + "\".");
        for (const std::string_view sign : kSigns)
            if (rest.starts_with(sign)) {
                token.kind = Token::Kind::Sign;
                token.text = sign;
                m_at += sign.size();
                return token;
            }
        const std::size_t length = nameLength(rest);
        if (length == 0) fail(m_at, "\"" + std::string(1, c) + "\" means nothing here.");
        const std::string_view word = rest.substr(0, length);
        const std::string_view keyword = keywordOf(word);
        token.kind = keyword.empty() ? Token::Kind::Name : Token::Kind::Keyword;
        token.text = keyword.empty() ? word : keyword;
        m_at += length;
        return token;
    }

    Token number(Token& token, std::string_view rest)
    {
        std::size_t n = 0;
        bool whole = true;
        while (n < rest.size() && isDigit(rest[n])) ++n;
        if (n < rest.size() && rest[n] == '.' && !rest.substr(n).starts_with("..")) {  // 2..5 is a range
            whole = false;
            do ++n;
            while (n < rest.size() && isDigit(rest[n]));
        }
        if (n < rest.size() && (rest[n] == 'e' || rest[n] == 'E')) {
            std::size_t k = n + 1;
            if (k < rest.size() && (rest[k] == '+' || rest[k] == '-')) ++k;
            if (k < rest.size() && isDigit(rest[k])) {
                whole = false;
                while (k < rest.size() && isDigit(rest[k])) ++k;
                n = k;
            }
        }
        if (n < rest.size() && beginsName(rest[n]))
            fail(m_at + n, "a number ends here and a name begins; is a sign missing between them?");
        token.kind = Token::Kind::Number;
        token.text = rest.substr(0, n);
        const char *const first = token.text.data(), *const last = first + n;
        std::int64_t i = 0;
        std::uint64_t u = 0;
        double d = 0;
        if (whole && std::from_chars(first, last, i).ec == std::errc())
            token.number = i;
        else if (whole && std::from_chars(first, last, u).ec == std::errc())
            token.number = u;
        else if (whole)
            fail(m_at, token.text + " is too large; whole numbers have 64 bits.");
        else if (std::from_chars(first, last, d).ec == std::errc())
            token.number = d;
        else
            fail(m_at, token.text + " is beyond what a number can be.");
        m_at += n;
        return token;
    }

    Token quoted(Token& token, std::string_view rest)
    {
        const std::size_t end = rest.find(rest.front(), 1);
        if (end == std::string_view::npos) fail(m_at, "the quotation mark is not closed.");
        token.kind = Token::Kind::QuotedName;
        token.text = rest.substr(1, end - 1);
        if (token.text.empty()) fail(m_at, "there is no name between the quotation marks.");
        m_at += end + 1;
        return token;
    }

    std::string_view m_text;
    std::size_t m_at = 0;
};

}  // namespace

std::vector<Token> tokenize(std::string_view text)
{
    return Lexer(text).run();
}

bool isPlainName(std::string_view word)
{
    return !word.empty() && nameLength(word) == word.size() && keywordOf(word).empty();
}

}  // namespace punctum::expression
