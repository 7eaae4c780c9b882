// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>

namespace punctum
{

/// The file's name without its folder, printable() whatever it is.
std::string shownName(const std::filesystem::path& file);

/// What the system calls an error number (errno): "No space left on device".
std::string systemReason(int error);

/// The one error type of Punctum: a sentence a user can act on.
///
/// Thrown by everything in core and render that can fail because of its input or its surroundings
/// (files, memory, drivers). A broken promise of the code itself is an assertion, not an Error.
/// `what()` is the whole sentence, with the file's name in front when there is one; names and texts from outside in
/// it are made printable() (core/Text.h), so that it is one line.
class Error : public std::runtime_error
{
public:
    explicit Error(const std::string& sentence);
    Error(const std::filesystem::path& file, const std::string& sentence);
    /// `byteOffset`: where in the file the trouble was found; becomes part of the sentence.
    Error(const std::filesystem::path& file, const std::string& sentence, std::uint64_t byteOffset);

    /// The file concerned; empty when there is none.
    const std::filesystem::path& file() const noexcept { return m_file; }
    std::optional<std::uint64_t> byteOffset() const noexcept { return m_byteOffset; }

private:
    std::filesystem::path m_file;
    std::optional<std::uint64_t> m_byteOffset;
};

}  // namespace punctum
