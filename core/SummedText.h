// SPDX-License-Identifier: MIT
#pragma once

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace punctum
{

// Text files that the program keeps for itself, and that it may find cut off, damaged or made by anybody: journals,
// lists of a save. A line is words with a blank between; its last word is a CRC-32 of the line without it, begun
// with the sum of the line before, so that a line that is changed, missing or in another place is found.

/// CRC-32 (IEEE 802.3), which finds every burst of up to 32 bits, of `bytes` behind those that `crc` is of.
std::uint32_t crc32(std::uint32_t crc, std::string_view bytes) noexcept;

/// A word without blanks: what is no plain letter is written as %41, an empty word as %.
std::string escapedWord(std::string_view text);
/// Nothing: it is none.
std::optional<std::string> unescapedWord(std::string_view word);
std::vector<std::string_view> wordsOf(std::string_view line);

/// The whole word as a number; false when it is none, or none of this type.
template <typename T>
bool parseWord(std::string_view word, T& out, int base = 10)
{
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), out, base);
    return error == std::errc() && end == word.data() + word.size();
}

/// The line with its sum and its end; `sum`: of the line before (0: there is none), becomes that of this one.
std::string summed(const std::string& line, std::uint32_t& sum);

/// Takes lines off the beginning of a text, as long as their sums are right.
class SummedLines
{
public:
    /// `text` must outlive this.
    explicit SummedLines(std::string_view text) : m_text(text) {}

    enum class Next { Line, End, CutOff, Damaged };
    Next next();
    std::string_view line() const noexcept { return m_line; }  ///< without its sum
    std::uint32_t sum() const noexcept { return m_sum; }       ///< of that line
    std::size_t end() const noexcept { return m_at; }          ///< bytes of the text up to its end

private:
    std::string_view m_text, m_line;
    std::uint32_t m_sum = 0;
    std::size_t m_at = 0;
};

}  // namespace punctum
