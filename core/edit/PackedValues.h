// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace punctum
{

/// Elements of so many bytes as runs of equal ones: for each a count of 4 bytes (little-endian), and the element.
/// Nothing where that is not shorter.
std::optional<std::vector<std::byte>> packedRuns(std::span<const std::byte> values, std::size_t elementBytes);
/// The elements again; nothing when there are not `count` of them.
std::optional<std::vector<std::byte>> unpackedRuns(std::span<const std::byte> packed, std::size_t elementBytes,
                                                   std::uint64_t count);

/// As printable text without blanks (base64, RFC 4648), and back; nothing when it is no such text.
std::string toBase64(std::span<const std::byte> bytes);
std::optional<std::vector<std::byte>> fromBase64(std::string_view text);

}  // namespace punctum
