// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

namespace punctum::las
{

/// A regular file opened for reading, read at positions (pread), so that a file that shrinks is an Error and not
/// a signal. Move-only; readAt may be called from several threads at once.
class File
{
public:
    /// Throws Error when it does not exist, may not be read, or is no regular file (folder, pipe, device).
    explicit File(const std::filesystem::path& path);
    ~File();
    File(File&& other) noexcept;
    File(const File&) = delete;
    File& operator=(const File&) = delete;
    File& operator=(File&&) = delete;

    const std::filesystem::path& path() const noexcept { return m_path; }
    /// Bytes when it was opened.
    std::uint64_t size() const noexcept { return m_size; }
    /// Fills `out` from `offset`; throws Error when the file ends before or the disk fails.
    void readAt(std::uint64_t offset, std::span<std::byte> out) const;
    /// Throws Error when somebody changed the file's size or its time since it was opened.
    void checkUnchanged() const;

private:
    std::filesystem::path m_path;
    int m_descriptor = -1;
    std::uint64_t m_size = 0;
    std::int64_t m_modified = 0;  ///< ns
};

}  // namespace punctum::las
