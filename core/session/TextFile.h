// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string_view>

namespace punctum
{

/// Writes a text as a file that appears whole or not at all, as las::AtomicFile does. Any thread. Throws Error; an
/// existing file is untouched then.
void writeText(const std::filesystem::path& target, std::string_view text);

}  // namespace punctum
