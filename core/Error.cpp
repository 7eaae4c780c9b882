// SPDX-License-Identifier: MIT
#include "core/Error.h"

#include <algorithm>

namespace punctum
{

std::string shownName(const std::filesystem::path& file)
{
    std::string name = file.filename().string();
    std::replace_if(
        name.begin(), name.end(), [](unsigned char c) { return c < 0x20 || c == 0x7F; }, '?');
    return name;
}

namespace
{

/// "It ends early (at byte 77)."
std::string withPlace(std::string sentence, const std::string& place)
{
    if (sentence.ends_with('.')) sentence.pop_back();
    return sentence + " (" + place + ").";
}

}  // namespace

Error::Error(const std::string& sentence) : std::runtime_error(sentence) {}

Error::Error(const std::filesystem::path& file, const std::string& sentence)
    : std::runtime_error(shownName(file) + ": " + sentence), m_file(file)
{
}

Error::Error(const std::filesystem::path& file, const std::string& sentence, std::uint64_t byteOffset)
    : std::runtime_error(shownName(file) + ": " + withPlace(sentence, "at byte " + std::to_string(byteOffset))),
      m_file(file),
      m_byteOffset(byteOffset)
{
}

}  // namespace punctum
