// SPDX-License-Identifier: MIT
#include "core/Error.h"

#include "core/Text.h"

#include <system_error>

namespace punctum
{

std::string shownName(const std::filesystem::path& file)
{
    return printable(file.filename().string());
}

std::string systemReason(int error)
{
    return std::generic_category().message(error);
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

Error::Error(const std::string& sentence) : std::runtime_error(printable(sentence)) {}

Error::Error(const std::filesystem::path& file, const std::string& sentence)
    : std::runtime_error(shownName(file) + ": " + printable(sentence)), m_file(file)
{
}

Error::Error(const std::filesystem::path& file, const std::string& sentence, std::uint64_t byteOffset)
    : std::runtime_error(shownName(file) + ": " +
                         withPlace(printable(sentence), "at byte " + std::to_string(byteOffset))),
      m_file(file),
      m_byteOffset(byteOffset)
{
}

}  // namespace punctum
