// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace punctum
{

/// 1234567 as "1,234,567": how people are told numbers, in reports and messages.
std::string grouped(std::uint64_t number);

/// The last `digits` hexadecimal digits of a number, in small letters: how files name sums and keys.
std::string hexText(std::uint64_t number, int digits);

/// "1 point", "1,204 points".
std::string pointsText(std::uint64_t count);

/// "a.las, b.las and 3 more": the first `most` names, and how many others there are.
std::string listText(const std::vector<std::string>& names, std::size_t most = 5);

/// "a, b and c": what `nameOf` gives for each item.
template <typename Items, typename NameOf>
std::string enumerated(const Items& items, NameOf nameOf)
{
    std::string text;
    for (std::size_t i = 0; i < items.size(); ++i) {
        if (i != 0) text += i + 1 == items.size() ? " and " : ", ";
        text += nameOf(items[i]);
    }
    return text;
}

/// "603 bytes", "603 kB", "2.1 GB": what memory or a disk has to have, rounded up.
std::string sizeText(std::uint64_t bytes);

/// Bytes of the UTF-8 character that the text begins with; 0 when it does not begin with one.
std::size_t utf8Length(std::string_view text) noexcept;

/// What may go to a terminal, whatever a file holds: control characters, signs that turn the direction of writing,
/// and bytes that are no UTF-8 become '?'. With `lines` line ends stay.
std::string printable(std::string_view text, bool lines = false);

/// Likewise, with what `replacement` gives for such a character (0: a byte that is no UTF-8) in its place.
std::string withoutControls(std::string_view text, const std::function<std::string(char32_t)>& replacement);

/// Columns of a terminal that the text takes: none for accents that stand on the character before, two for Chinese,
/// Japanese and Korean characters and for emoji.
std::size_t displayWidth(std::string_view text) noexcept;

/// Cut to so many columns, three points included; `width` is at least 3.
std::string cutToWidth(std::string_view text, std::size_t width);

/// Rows of cells as lines, each column as wide as it needs and two blanks from the next; cells are made
/// printable().
struct TableStyle {
    std::vector<bool> right = {};               ///< columns that stand right; those beyond stand left
    std::size_t indent = 2;                     ///< blanks before each line
    std::size_t mostPadding = std::size_t(-1);  ///< no column makes others wait for more than this
};
std::string textTable(const std::vector<std::vector<std::string>>& rows, const TableStyle& style = {});

}  // namespace punctum
