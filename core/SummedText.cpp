// SPDX-License-Identifier: MIT
#include "core/SummedText.h"

#include "core/Text.h"

#include <algorithm>
#include <array>

namespace punctum
{

namespace
{

constexpr std::size_t kSumDigits = 8;

}  // namespace

std::uint32_t crc32(std::uint32_t crc, std::string_view bytes) noexcept
{
    static const auto table = [] {
        std::array<std::uint32_t, 256> t{};
        for (std::uint32_t n = 0; n < 256; ++n) {
            std::uint32_t c = n;
            for (int k = 0; k < 8; ++k) c = (c & 1u) != 0 ? 0xEDB88320u ^ (c >> 1) : c >> 1;
            t[n] = c;
        }
        return t;
    }();
    crc = ~crc;
    for (const char c : bytes) crc = table[(crc ^ static_cast<unsigned char>(c)) & 255u] ^ (crc >> 8);
    return ~crc;
}

std::string escapedWord(std::string_view text)
{
    std::string word;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        const bool plain = (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
                           std::string_view("._-/:+*()<>,").find(c) != std::string_view::npos;
        if (plain)
            word += c;
        else
            word += '%' + hexText(byte, 2);
    }
    return word.empty() ? std::string("%") : word;
}

std::optional<std::string> unescapedWord(std::string_view word)
{
    if (word == "%") return std::string();
    std::string text;
    for (std::size_t k = 0; k < word.size(); ++k) {
        if (word[k] != '%') {
            text += word[k];
            continue;
        }
        unsigned byte = 0;
        if (k + 2 >= word.size() || !parseWord(word.substr(k + 1, 2), byte, 16)) return {};
        text += char(byte);
        k += 2;
    }
    return text;
}

std::vector<std::string_view> wordsOf(std::string_view line)
{
    std::vector<std::string_view> all;
    while (!line.empty()) {
        const std::size_t end = std::min(line.find(' '), line.size());
        all.push_back(line.substr(0, end));
        line.remove_prefix(std::min(end + 1, line.size()));
    }
    return all;
}

std::string summed(const std::string& line, std::uint32_t& sum)
{
    sum = crc32(sum, line);
    return line + " " + hexText(sum, int(kSumDigits)) + "\n";
}

SummedLines::Next SummedLines::next()
{
    if (m_at == m_text.size()) return Next::End;
    const std::size_t end = m_text.find('\n', m_at);
    if (end == std::string_view::npos) return Next::CutOff;
    const std::string_view whole = m_text.substr(m_at, end - m_at);
    if (whole.size() <= kSumDigits + 1 || whole[whole.size() - kSumDigits - 1] != ' ') return Next::Damaged;
    const std::string_view line = whole.substr(0, whole.size() - kSumDigits - 1);
    std::uint32_t sum = 0;
    if (!parseWord(whole.substr(whole.size() - kSumDigits), sum, 16) || crc32(m_sum, line) != sum)
        return Next::Damaged;
    m_line = line;
    m_sum = sum;
    m_at = end + 1;
    return Next::Line;
}

}  // namespace punctum
