// SPDX-License-Identifier: MIT
#include "core/las/AtomicFile.h"

#include "core/Error.h"
#include "core/las/Leftovers.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <system_error>

namespace punctum::las
{

namespace
{

constexpr std::size_t kMostAtOnce = std::size_t(64) << 20;  ///< bytes in one write; Linux takes up to 2 GiB

std::string reason(int error)
{
    return std::generic_category().message(error);
}

/// Keeps SIGXFSZ (a file beyond the size limit) from ending the program: the write then fails with EFBIG.
class FileSizeSignal
{
public:
    FileSizeSignal()
    {
        sigemptyset(&m_set);
        sigaddset(&m_set, SIGXFSZ);
        pthread_sigmask(SIG_BLOCK, &m_set, &m_before);
    }
    ~FileSizeSignal()
    {
        if (sigismember(&m_before, SIGXFSZ) == 0) {
            const timespec now{};
            while (sigtimedwait(&m_set, nullptr, &now) > 0) {
            }
        }
        pthread_sigmask(SIG_SETMASK, &m_before, nullptr);
    }
    FileSizeSignal(const FileSizeSignal&) = delete;
    FileSizeSignal& operator=(const FileSizeSignal&) = delete;

private:
    sigset_t m_set{};
    sigset_t m_before{};
};

}  // namespace

AtomicFile::AtomicFile(const std::filesystem::path& target, std::uint64_t expectedBytes)
    : m_shown(target), m_target(target)
{
    std::error_code ec;
    if (std::filesystem::is_symlink(target, ec)) {
        const auto real = std::filesystem::weakly_canonical(target, ec);
        if (!ec) m_target = real;
    }
    struct stat s {
    };
    if (::stat(m_target.c_str(), &s) == 0) {
        if (S_ISDIR(s.st_mode)) throw Error(m_shown, "This is a folder; choose a file name.");
        if (!S_ISREG(s.st_mode)) throw Error(m_shown, "This is not a regular file, so it cannot be replaced.");
        m_exists = true;
        m_otherNames = s.st_nlink > 1;
        m_mode = s.st_mode & 07777;
        m_owner = s.st_uid;
        m_group = s.st_gid;
    } else if (errno != ENOENT) {
        fail("The file cannot be written", errno);
    }

    const std::filesystem::path folder = m_target.has_parent_path() ? m_target.parent_path() : ".";
    struct statvfs room {
    };
    if (expectedBytes != 0 && ::statvfs(folder.c_str(), &room) == 0 && room.f_frsize != 0 &&
        expectedBytes / room.f_frsize > room.f_bavail)
        throw Error(m_shown, "There is not enough room on the disk: " + std::to_string(expectedBytes >> 20) +
                                 " MB are needed.");

    // A new file gets the mode that the user's umask gives; one that replaces another is private until it has its.
    for (int attempt = 0; attempt < 16 && m_descriptor < 0; ++attempt) {
        m_temporary = folder / temporaryName(m_target.filename().string());
        m_descriptor =
            ::open(m_temporary.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, mode_t(m_exists ? 0600 : 0666));
        if (m_descriptor < 0 && errno != EEXIST) break;
    }
    if (m_descriptor < 0) {
        const int error = errno;
        if (error == EACCES || error == EROFS || error == EPERM)
            throw Error(m_shown, "The folder is read-only; choose another place.");
        if (error == ENOENT) throw Error(m_shown, "The folder does not exist; choose another place.");
        fail("The file cannot be written", error);
    }
}

AtomicFile::~AtomicFile()
{
    if (m_descriptor >= 0) ::close(m_descriptor);
    if (!m_committed && !m_temporary.empty()) ::unlink(m_temporary.c_str());
}

void AtomicFile::fail(const std::string& what, int error) const
{
    if (error == ENOSPC || error == EDQUOT) throw Error(m_shown, "The disk is full; nothing was changed.");
    if (error == EFBIG) throw Error(m_shown, "The file would become too large for this disk; nothing was changed.");
    throw Error(m_shown, what + ": " + reason(error) + ".");
}

void AtomicFile::writeAt(std::uint64_t offset, std::span<const std::byte> bytes)
{
    const FileSizeSignal quiet;
    while (!bytes.empty()) {
        const ssize_t n = ::pwrite(m_descriptor, bytes.data(), std::min(bytes.size(), kMostAtOnce), off_t(offset));
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) fail("The file cannot be written", errno);
        if (n == 0) fail("The file cannot be written", ENOSPC);
        offset += std::uint64_t(n);
        bytes = bytes.subspan(std::size_t(n));
    }
}

void AtomicFile::resize(std::uint64_t bytes)
{
    const FileSizeSignal quiet;
    int result = 0;
    do {
        result = ::ftruncate(m_descriptor, off_t(bytes));
    } while (result != 0 && errno == EINTR);
    if (result != 0) fail("The file cannot be written", errno);
}

void AtomicFile::sync()
{
    if (::fsync(m_descriptor) != 0) fail("The file cannot be written to the disk", errno);
}

FileStamp AtomicFile::commit()
{
    if (m_exists) {
        // The owner first: changing it clears set-id bits. Not being allowed to is no failure, the mode is.
        const bool owned = ::fchown(m_descriptor, m_owner, m_group) == 0;
        if (::fchmod(m_descriptor, mode_t(owned ? m_mode : m_mode & 0777u)) != 0)
            fail("The file's permissions cannot be kept", errno);
    }
    struct stat s {
    };
    if (::fstat(m_descriptor, &s) != 0) fail("The file cannot be written", errno);
    const int closed = ::close(m_descriptor);
    m_descriptor = -1;
    if (closed != 0 && errno != EINTR) fail("The file cannot be written to the disk", errno);
    if (::rename(m_temporary.c_str(), m_target.c_str()) != 0) fail("The file cannot take its name", errno);
    m_committed = true;
    // The name itself must reach the disk too. The file is there by now, so that a failure is no error.
    const std::filesystem::path folder = m_target.has_parent_path() ? m_target.parent_path() : ".";
    if (const int d = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC); d >= 0) {
        (void)::fsync(d);
        ::close(d);
    }
    return FileStamp::of(s);
}

}  // namespace punctum::las
