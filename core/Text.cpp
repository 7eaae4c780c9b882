// SPDX-License-Identifier: MIT
#include "core/Text.h"

#include <algorithm>
#include <iterator>

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

std::string listText(const std::vector<std::string>& names, std::size_t most)
{
    std::string list;
    for (std::size_t k = 0; k < names.size() && k < most; ++k) list += (k == 0 ? "" : ", ") + names[k];
    return names.size() > most ? list + " and " + grouped(names.size() - most) + " more" : list;
}

std::string sizeText(std::uint64_t bytes)
{
    if (bytes < 1000) return bytes == 1 ? "1 byte" : std::to_string(bytes) + " bytes";
    constexpr const char* kUnits[] = {"kB", "MB", "GB", "TB", "PB", "EB"};
    std::size_t unit = 0;
    std::uint64_t size = 1000;  // bytes of the unit
    while (unit + 1 < std::size(kUnits) && bytes / 1000 >= size) {
        size *= 1000;
        ++unit;
    }
    const std::uint64_t tenths = bytes / (size / 10) + (bytes % (size / 10) != 0);
    const bool few = tenths < 100 && unit > 0;
    return (few ? std::to_string(tenths / 10) + "." + std::to_string(tenths % 10)
                : std::to_string((tenths + 9) / 10)) +
           " " + kUnits[unit];
}

namespace
{

/// The character of so many bytes (utf8Length()) that the text begins with.
char32_t character(std::string_view text, std::size_t length) noexcept
{
    const auto byte = [&](std::size_t k) { return char32_t(static_cast<unsigned char>(text[k])); };
    if (length == 1) return byte(0);
    char32_t c = byte(0) & (0x7Fu >> length);
    for (std::size_t k = 1; k < length; ++k) c = c << 6 | (byte(k) & 0x3Fu);
    return c;
}

struct Range {
    char32_t first, last;
};

template <std::size_t N>
bool in(const Range (&ranges)[N], char32_t c) noexcept
{
    return std::any_of(std::begin(ranges), std::end(ranges),
                       [c](const Range& r) { return c >= r.first && c <= r.last; });
}

/// Combining marks, joiners and selectors of variants.
constexpr Range kNoWidth[] = {{0x0300, 0x036F}, {0x0483, 0x0489}, {0x0591, 0x05BD}, {0x0610, 0x061A},
                              {0x064B, 0x065F}, {0x0E31, 0x0E31}, {0x0E34, 0x0E3A}, {0x0E47, 0x0E4E},
                              {0x1AB0, 0x1AFF}, {0x1DC0, 0x1DFF}, {0x200B, 0x200D}, {0x20D0, 0x20FF},
                              {0xFE00, 0xFE0F}, {0xFE20, 0xFE2F}, {0xFEFF, 0xFEFF}, {0xE0100, 0xE01EF}};
/// East Asian wide and fullwidth characters (Unicode Standard Annex 11), and emoji.
constexpr Range kDoubleWidth[] = {{0x1100, 0x115F},   {0x2E80, 0x303E},   {0x3041, 0x33FF},   {0x3400, 0x4DBF},
                                  {0x4E00, 0x9FFF},   {0xA000, 0xA4CF},   {0xA960, 0xA97F},   {0xAC00, 0xD7A3},
                                  {0xF900, 0xFAFF},   {0xFE30, 0xFE6F},   {0xFF00, 0xFF60},   {0xFFE0, 0xFFE6},
                                  {0x1F300, 0x1F64F}, {0x1F680, 0x1F6FF}, {0x1F900, 0x1FAFF}, {0x20000, 0x3FFFD}};
/// Controls beyond ASCII, and signs that turn the direction of writing.
constexpr Range kUnprintable[] = {{0x80, 0x9F}, {0x200E, 0x200F}, {0x2028, 0x202E}, {0x2066, 0x2069}};

}  // namespace

std::size_t utf8Length(std::string_view text) noexcept
{
    if (text.empty()) return 0;
    const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
    const auto continued = [&](std::size_t n) {
        if (text.size() < n) return false;
        return std::all_of(text.begin() + 1, text.begin() + std::ptrdiff_t(n),
                           [](char c) { return (static_cast<unsigned char>(c) & 0xC0u) == 0x80u; });
    };
    if (byte(0) < 0x80) return 1;
    if (byte(0) >= 0xC2 && byte(0) <= 0xDF) return continued(2) ? 2 : 0;
    if (byte(0) >= 0xE0 && byte(0) <= 0xEF) {
        if (!continued(3) || (byte(0) == 0xE0 && byte(1) < 0xA0) || (byte(0) == 0xED && byte(1) > 0x9F)) return 0;
        return 3;
    }
    if (byte(0) >= 0xF0 && byte(0) <= 0xF4) {
        if (!continued(4) || (byte(0) == 0xF0 && byte(1) < 0x90) || (byte(0) == 0xF4 && byte(1) > 0x8F)) return 0;
        return 4;
    }
    return 0;
}

std::string withoutControls(std::string_view text, const std::function<std::string(char32_t)>& replacement)
{
    std::string clean;
    clean.reserve(text.size());
    while (!text.empty()) {
        const std::size_t length = utf8Length(text);
        const char32_t c = length == 0 ? 0 : character(text, length);
        if (c < 0x20 || c == 0x7F || in(kUnprintable, c))
            clean += replacement(c);
        else
            clean += text.substr(0, length);
        text.remove_prefix(std::max<std::size_t>(1, length));
    }
    return clean;
}

std::string printable(std::string_view text, bool lines)
{
    return withoutControls(text, [lines](char32_t c) { return lines && c == '\n' ? "\n" : "?"; });
}

std::size_t displayWidth(std::string_view text) noexcept
{
    std::size_t width = 0;
    while (!text.empty()) {
        const std::size_t length = utf8Length(text);
        const char32_t c = length == 0 ? U'?' : character(text, length);
        width += in(kNoWidth, c) ? 0 : in(kDoubleWidth, c) ? 2 : 1;
        text.remove_prefix(std::max<std::size_t>(1, length));
    }
    return width;
}

std::string cutToWidth(std::string_view text, std::size_t width)
{
    if (displayWidth(text) <= width) return std::string(text);
    std::size_t end = 0;
    for (std::size_t used = 0; end < text.size();) {
        const std::size_t length = std::max<std::size_t>(1, utf8Length(text.substr(end)));
        used += displayWidth(text.substr(end, length));
        if (used + 3 > width) break;
        end += length;
    }
    return std::string(text.substr(0, end)) + "...";
}

std::string textTable(const std::vector<std::vector<std::string>>& rows, const TableStyle& style)
{
    std::vector<std::vector<std::string>> cells = rows;
    std::vector<std::size_t> widths;
    for (auto& row : cells)
        for (std::size_t c = 0; c < row.size(); ++c) {
            row[c] = printable(row[c]);
            if (c == widths.size()) widths.push_back(0);
            widths[c] = std::max(widths[c], std::min(displayWidth(row[c]), style.mostPadding));
        }
    std::string text;
    for (const auto& row : cells) {
        std::string line(style.indent, ' ');
        for (std::size_t c = 0; c < row.size(); ++c) {
            const std::size_t width = displayWidth(row[c]);
            const std::string padding(widths[c] > width ? widths[c] - width : 0, ' ');
            const bool right = c < style.right.size() && style.right[c];
            line += (c == 0 ? "" : "  ") + (right ? padding + row[c] : row[c] + padding);
        }
        line.erase(line.find_last_not_of(' ') + 1);
        text += line + '\n';
    }
    return text;
}

}  // namespace punctum
