// SPDX-License-Identifier: MIT
#include "core/edit/PackedValues.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

namespace punctum
{

namespace
{

constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
constexpr int kNoDigit = -1;

constexpr std::array<signed char, 256> digitValues()
{
    std::array<signed char, 256> values{};
    values.fill(kNoDigit);
    for (std::size_t k = 0; k < kDigits.size(); ++k) values[static_cast<unsigned char>(kDigits[k])] = char(k);
    return values;
}

}  // namespace

std::optional<std::vector<std::byte>> packedRuns(std::span<const std::byte> values, std::size_t elementBytes)
{
    std::vector<std::byte> packed;
    const std::size_t longest = elementBytes * std::numeric_limits<std::uint32_t>::max();
    for (std::size_t at = 0; at < values.size();) {
        const std::size_t most = std::min(values.size(), at + longest);
        std::size_t end = at + elementBytes;
        while (end < most && std::memcmp(values.data() + at, values.data() + end, elementBytes) == 0)
            end += elementBytes;
        const auto count = std::uint32_t((end - at) / elementBytes);
        const auto* const first = reinterpret_cast<const std::byte*>(&count);
        packed.insert(packed.end(), first, first + sizeof count);
        packed.insert(packed.end(), values.begin() + std::ptrdiff_t(at),
                      values.begin() + std::ptrdiff_t(at + elementBytes));
        if (packed.size() >= values.size()) return {};
        at = end;
    }
    packed.shrink_to_fit();
    return packed;
}

std::optional<std::vector<std::byte>> unpackedRuns(std::span<const std::byte> packed, std::size_t elementBytes,
                                                   std::uint64_t count)
{
    const std::size_t runBytes = sizeof(std::uint32_t) + elementBytes;
    if (packed.size() % runBytes != 0) return {};
    const auto countAt = [&](std::size_t at) {
        std::uint32_t n = 0;
        std::memcpy(&n, packed.data() + at, sizeof n);
        return n;
    };
    std::uint64_t sum = 0;  // of less than 2^32 counts of less than 2^32
    for (std::size_t at = 0; at < packed.size(); at += runBytes) sum += countAt(at);
    if (sum != count) return {};
    std::vector<std::byte> values;
    values.reserve(std::size_t(count) * elementBytes);
    for (std::size_t at = 0; at < packed.size(); at += runBytes) {
        const std::byte* const element = packed.data() + at + sizeof(std::uint32_t);
        for (std::uint32_t k = countAt(at); k > 0; --k)
            values.insert(values.end(), element, element + elementBytes);
    }
    return values;
}

std::string toBase64(std::span<const std::byte> bytes)
{
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t k = 0; k < bytes.size(); k += 3) {
        const std::size_t n = std::min<std::size_t>(3, bytes.size() - k);
        std::uint32_t bits = 0;
        for (std::size_t b = 0; b < 3; ++b)
            bits = bits << 8 | (b < n ? std::to_integer<std::uint32_t>(bytes[k + b]) : 0u);
        for (std::size_t d = 0; d < 4; ++d) text += d <= n ? kDigits[bits >> (18 - 6 * d) & 63u] : '=';
    }
    return text;
}

std::optional<std::vector<std::byte>> fromBase64(std::string_view text)
{
    static constexpr std::array<signed char, 256> kValues = digitValues();
    if (text.size() % 4 != 0) return {};
    std::vector<std::byte> bytes;
    bytes.reserve(text.size() / 4 * 3);
    for (std::size_t k = 0; k < text.size(); k += 4) {
        std::uint32_t bits = 0;
        std::size_t filled = 0;
        for (std::size_t d = 0; d < 4; ++d) {
            const int digit = kValues[static_cast<unsigned char>(text[k + d])];
            const bool pad = text[k + d] == '=' && k + 4 == text.size() && d >= 2;
            if ((digit == kNoDigit && !pad) || (!pad && filled != d)) return {};
            bits = bits << 6 | std::uint32_t(pad ? 0 : digit);
            if (!pad) ++filled;
        }
        for (std::size_t b = 0; b + 1 < filled; ++b) bytes.push_back(std::byte(bits >> (16 - 8 * b) & 255u));
    }
    return bytes;
}

}  // namespace punctum
