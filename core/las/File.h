// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>

struct stat;

namespace punctum::las
{

/// What tells whether a path still leads to the same file with the same contents.
struct FileStamp {
    std::uint64_t device = 0;
    std::uint64_t inode = 0;
    std::uint64_t size = 0;
    std::int64_t modified = 0;  ///< ns
    friend bool operator==(const FileStamp&, const FileStamp&) = default;

    static FileStamp of(const struct stat& s) noexcept;
    /// Of what the path leads to now; nothing when there is no file, or none that can be looked at.
    static std::optional<FileStamp> of(const std::filesystem::path& path) noexcept;
};

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
    std::uint64_t size() const noexcept { return m_stamp.size; }
    /// As it was when it was opened.
    const FileStamp& stamp() const noexcept { return m_stamp; }
    /// Fills `out` from `offset`; throws Error when the file ends before or the disk fails.
    void readAt(std::uint64_t offset, std::span<std::byte> out) const;
    /// Throws Error when somebody changed the file's size or its time since it was opened.
    void checkUnchanged() const;

    /// Gives the system's handle back, of which there are few; nothing can be read until reopen(). One thread.
    void close() noexcept;
    /// Opens the file again, if it is closed. Throws Error when it is not there, or not the same any more.
    void reopen();

private:
    std::filesystem::path m_path;
    int m_descriptor = -1;
    FileStamp m_stamp;
};

}  // namespace punctum::las
