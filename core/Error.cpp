// SPDX-License-Identifier: MIT
#include "core/Error.h"

#include <algorithm>

namespace punctum
{

namespace
{

/// The file's name in one line, whatever it is.
std::string nameOf(const std::filesystem::path& file)
{
    std::string name = file.filename().string();
    std::replace_if(
        name.begin(), name.end(), [](unsigned char c) { return c < 0x20 || c == 0x7F; }, '?');
    return name;
}

}  // namespace

Error::Error(const std::string& sentence) : std::runtime_error(sentence) {}

Error::Error(const std::filesystem::path& file, const std::string& sentence)
    : std::runtime_error(nameOf(file) + ": " + sentence), m_file(file)
{
}

Error::Error(const std::filesystem::path& file, const std::string& sentence, std::uint64_t byteOffset)
    : std::runtime_error(nameOf(file) + ": " + sentence + " (at byte " + std::to_string(byteOffset) + ")"),
      m_file(file),
      m_byteOffset(byteOffset)
{
}

}  // namespace punctum
