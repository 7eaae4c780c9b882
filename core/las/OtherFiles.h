// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace punctum::las
{

/// How many bytes from a file's beginning tell most.
constexpr std::size_t kTellingBytes = 512;

/// What a file is that is no LAS file, by its first bytes (`head`, kTellingBytes of them or the whole file): a
/// sentence that says so and what to do. Empty when it is nothing that people are likely to meet in its place.
std::string whatInstead(std::span<const std::byte> head);

}  // namespace punctum::las
