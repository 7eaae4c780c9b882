// SPDX-License-Identifier: MIT
#include "core/Error.h"

#include "core/OneLine.h"

#include <algorithm>

namespace punctum
{

std::string oneLine(std::string text)
{
    std::replace_if(
        text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7F; }, '?');
    return text;
}

std::string shownName(const std::filesystem::path& file)
{
    return oneLine(file.filename().string());
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

Error::Error(const std::string& sentence) : std::runtime_error(oneLine(sentence)) {}

Error::Error(const std::filesystem::path& file, const std::string& sentence)
    : std::runtime_error(shownName(file) + ": " + oneLine(sentence)), m_file(file)
{
}

Error::Error(const std::filesystem::path& file, const std::string& sentence, std::uint64_t byteOffset)
    : std::runtime_error(shownName(file) + ": " +
                         withPlace(oneLine(sentence), "at byte " + std::to_string(byteOffset))),
      m_file(file),
      m_byteOffset(byteOffset)
{
}

}  // namespace punctum
