// SPDX-License-Identifier: MIT
#include "core/Error.h"

namespace punctum
{

Error::Error(const std::string& sentence) : std::runtime_error(sentence) {}

Error::Error(const std::filesystem::path& file, const std::string& sentence)
    : std::runtime_error(file.filename().string() + ": " + sentence), m_file(file)
{
}

Error::Error(const std::filesystem::path& file, const std::string& sentence, std::uint64_t byteOffset)
    : std::runtime_error(file.filename().string() + ": " + sentence + " (at byte " + std::to_string(byteOffset) +
                         ")"),
      m_file(file),
      m_byteOffset(byteOffset)
{
}

}  // namespace punctum
