// SPDX-License-Identifier: MIT
#include "core/expression/Words.h"

#include "core/expression/Syntax.h"

#include <algorithm>
#include <cctype>
#include <cstddef>

namespace punctum::expression
{

char smallLetter(char c)
{
    return char(std::tolower(static_cast<unsigned char>(c)));
}

bool sameWord(std::string_view a, std::string_view b)
{
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](char x, char y) { return smallLetter(x) == smallLetter(y); });
}

namespace
{

/// How many letters have to be put in, left out or exchanged to make one word of the other (Levenshtein), letters
/// small or large.
std::size_t distance(std::string_view a, std::string_view b)
{
    std::vector<std::size_t> row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i + 1;
        for (std::size_t j = 0; j < b.size(); ++j) {
            const std::size_t exchanged = diagonal + (smallLetter(a[i]) != smallLetter(b[j]) ? 1 : 0);
            diagonal = row[j + 1];
            row[j + 1] = std::min({row[j] + 1, row[j + 1] + 1, exchanged});
        }
    }
    return row.back();
}

}  // namespace

std::string suggestion(std::string_view word, const std::vector<std::string>& names)
{
    constexpr std::size_t kLongest = 64;  // of a word that somebody may have mistyped
    if (word.size() > kLongest) return ".";
    std::string best;
    std::size_t least = std::max<std::size_t>(1, word.size() / 3) + 1;
    for (const auto& name : names) {
        if (name.size() > kLongest) continue;
        if (const std::size_t d = distance(word, name); d < least) {
            least = d;
            best = name;
        }
    }
    return best.empty() ? std::string(".") : "; did you mean " + quotedName(best) + "?";
}

}  // namespace punctum::expression
