// SPDX-License-Identifier: MIT
#include "core/las/File.h"

#include "core/Error.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

namespace punctum::las
{

FileStamp FileStamp::of(const struct stat& s) noexcept
{
    return {std::uint64_t(s.st_dev), std::uint64_t(s.st_ino), std::uint64_t(s.st_size),
            std::int64_t(s.st_mtim.tv_sec) * 1'000'000'000 + s.st_mtim.tv_nsec};
}

std::optional<FileStamp> FileStamp::of(const std::filesystem::path& path) noexcept
{
    struct stat s {
    };
    if (::stat(path.c_str(), &s) != 0) return {};
    return of(s);
}

File::File(const std::filesystem::path& path) : m_path(path)
{
    // Not blocking: opening a pipe must not wait for its other end.
    m_descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (m_descriptor < 0) {
        if (errno == ENOENT) throw Error(path, "There is no such file.");
        throw Error(path, "The file cannot be opened: " + systemReason(errno) + ".");
    }
    struct stat s {
    };
    const bool known = ::fstat(m_descriptor, &s) == 0;
    if (!known || !S_ISREG(s.st_mode)) {
        ::close(m_descriptor);
        throw Error(path, known && S_ISDIR(s.st_mode) ? "This is a folder, not a file."
                                                      : "This is not a regular file, so it cannot be opened.");
    }
    m_stamp = FileStamp::of(s);
}

File::~File()
{
    close();
}

void File::close() noexcept
{
    if (m_descriptor >= 0) ::close(std::exchange(m_descriptor, -1));
}

void File::reopen()
{
    if (m_descriptor >= 0) return;
    File again(m_path);
    if (again.m_stamp != m_stamp)
        throw Error(m_path, "The file was changed by another program while it was being opened.");
    m_descriptor = std::exchange(again.m_descriptor, -1);
}

File::File(File&& other) noexcept
    : m_path(std::move(other.m_path)), m_descriptor(std::exchange(other.m_descriptor, -1)), m_stamp(other.m_stamp)
{
}

void File::readAt(std::uint64_t offset, std::span<std::byte> out) const
{
    while (!out.empty()) {
        const ssize_t n = ::pread(m_descriptor, out.data(), out.size(), off_t(offset));
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) throw Error(m_path, "The file cannot be read: " + systemReason(errno) + ".", offset);
        if (n == 0)
            throw Error(m_path, "The file ended while it was being read; was it changed meanwhile?", offset);
        offset += std::uint64_t(n);
        out = out.subspan(std::size_t(n));
    }
}

void File::checkUnchanged() const
{
    struct stat s {
    };
    if (::fstat(m_descriptor, &s) != 0 || FileStamp::of(s) != m_stamp)
        throw Error(m_path, "The file was changed by another program while it was being read; open it again.");
}

}  // namespace punctum::las
