// SPDX-License-Identifier: MIT
#include "core/las/AtomicFile.h"

#include "core/Error.h"
#include "core/Text.h"
#include "core/las/Leftovers.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <sys/xattr.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <system_error>

namespace punctum::las
{

namespace
{

constexpr const char* kAccessList = "system.posix_acl_access";
constexpr int kMostLinks = 40;                              ///< as Linux follows
constexpr std::size_t kMostAtOnce = std::size_t(64) << 20;  ///< bytes in one write; Linux takes up to 2 GiB

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

/// What a path leads to when links are followed, whether or not there is a file at their end.
std::filesystem::path linksFollowed(const std::filesystem::path& path)
{
    std::filesystem::path at = path;
    std::error_code ec;
    for (int k = 0; k < kMostLinks && std::filesystem::is_symlink(std::filesystem::symlink_status(at, ec)); ++k) {
        const auto to = std::filesystem::read_symlink(at, ec);
        if (ec) return path;
        at = at.parent_path() / to;  // which is `to` where that is absolute
    }
    return at;
}

}  // namespace

bool writeProtected(const std::filesystem::path& path)
{
    struct stat s {
    };
    if (::stat(path.c_str(), &s) != 0 || !S_ISREG(s.st_mode)) return false;
    // The first is for root, to whom everything is allowed.
    return (s.st_mode & 0222) == 0 ||
           (::faccessat(AT_FDCWD, path.c_str(), W_OK, AT_EACCESS) != 0 && errno == EACCES);
}

AtomicFile::AtomicFile(const std::filesystem::path& target, std::uint64_t expectedBytes, Protected whenProtected)
    : m_shown(target), m_target(linksFollowed(target)), m_whenProtected(whenProtected)
{
    struct stat s {
    };
    if (::stat(m_target.c_str(), &s) == 0) {
        if (S_ISDIR(s.st_mode)) throw Error(m_shown, "This is a folder; choose a file name.");
        if (!S_ISREG(s.st_mode)) throw Error(m_shown, "This is not a regular file, so it cannot be replaced.");
        if (whenProtected == Protected::Refuse && writeProtected(m_target))
            throw Error(m_shown, "The file is write-protected; allow writing to it, or choose another name.");
        m_before = FileStamp::of(s);
        if (s.st_nlink > 1)
            m_notes.emplace_back("The file had other names (hard links); they keep the old contents.");
        m_mode = s.st_mode & 07777;
        m_owner = s.st_uid;
        m_group = s.st_gid;
    } else if (errno != ENOENT) {
        fail("The file cannot be written", errno);
    }

    const std::filesystem::path folder = folderOf(m_target);
    struct statvfs room {
    };
    if (expectedBytes != 0 && ::statvfs(folder.c_str(), &room) == 0 && room.f_frsize != 0 &&
        expectedBytes / room.f_frsize > room.f_bavail)
        throw Error(m_shown, "There is not enough room on the disk: " + sizeText(expectedBytes) +
                                 (expectedBytes == 1 ? " is needed." : " are needed."));

    // A new file gets the mode that the user's umask gives; one that replaces another is private until it has its.
    for (int attempt = 0; attempt < 16 && m_descriptor < 0; ++attempt) {
        m_temporary = folder / temporaryName(m_target.filename().string());
        m_descriptor =
            ::open(m_temporary.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, mode_t(m_before ? 0600 : 0666));
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
    if (!m_left && !m_temporary.empty()) ::unlink(m_temporary.c_str());
}

void AtomicFile::fail(const std::string& what, int error) const
{
    if (error == ENOSPC || error == EDQUOT) throw Error(m_shown, "The disk is full; nothing was changed.");
    if (error == EFBIG) throw Error(m_shown, "The file would become too large for this disk; nothing was changed.");
    throw Error(m_shown, what + ": " + systemReason(error) + ".");
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

/// Extended attributes with their values, and the access list, which is one that need not be listed. What the file
/// system or the system's policy sets by itself, and does not let us set, is no loss.
void AtomicFile::takeOverAttributes(bool& accessKept)
{
    const auto valueOf = [&](const std::string& name) -> std::optional<std::vector<char>> {
        const ssize_t size = ::getxattr(m_target.c_str(), name.c_str(), nullptr, 0);
        if (size < 0) return {};
        std::vector<char> value(static_cast<std::size_t>(size));
        const ssize_t got = ::getxattr(m_target.c_str(), name.c_str(), value.data(), value.size());
        if (got < 0) return {};
        value.resize(static_cast<std::size_t>(got));
        return value;
    };
    std::vector<char> list;
    if (const ssize_t size = ::listxattr(m_target.c_str(), nullptr, 0); size > 0) {
        list.resize(static_cast<std::size_t>(size));
        const ssize_t got = ::listxattr(m_target.c_str(), list.data(), list.size());
        list.resize(static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
    }
    list.push_back('\0');
    std::string lost;
    for (std::size_t at = 0; list[at] != '\0';) {
        const std::string name(list.data() + at);
        at += name.size() + 1;
        if (name == kAccessList) continue;
        const auto value = valueOf(name);
        if (value && ::fsetxattr(m_descriptor, name.c_str(), value->data(), value->size(), 0) != 0 &&
            name.starts_with("user."))
            lost += (lost.empty() ? "" : ", ") + name;
    }
    if (!lost.empty()) m_notes.push_back("Extended attributes of the file could not be kept: " + lost + ".");

    // Without a list of its own the target must not get the one that its folder gives to new files.
    if (const auto value = valueOf(kAccessList))
        accessKept = ::fsetxattr(m_descriptor, kAccessList, value->data(), value->size(), 0) == 0;
    else
        (void)::fremovexattr(m_descriptor, kAccessList);
}

/// Owner, group, attributes and mode of the target. Not being allowed to set all of them is no failure, but then
/// nobody may get rights that they did not have.
void AtomicFile::takeOver()
{
    // The owner first: changing it clears set-id bits, and only the owner may set the rest.
    const bool owned = ::fchown(m_descriptor, m_owner, m_group) == 0;
    const bool grouped = owned || ::fchown(m_descriptor, uid_t(-1), m_group) == 0;
    if (!owned) m_notes.emplace_back("The file now belongs to you: its former owner could not be kept.");
    bool accessKept = true;
    takeOverAttributes(accessKept);
    unsigned mode = owned ? m_mode : m_mode & 0777u;
    if (!grouped || !accessKept) {
        mode &= ~0070u;  // the group is another one, or its bits were the mask of the list
        m_notes.emplace_back("Not all access rights of the file could be kept; its group has none now.");
    }
    if (::fchmod(m_descriptor, mode_t(mode)) != 0) fail("The file's permissions cannot be kept", errno);
}

void AtomicFile::seal()
{
    if (m_descriptor < 0) return;
    if (m_before) takeOver();
    struct stat s {
    };
    if (::fstat(m_descriptor, &s) != 0) fail("The file cannot be written", errno);
    m_stamp = FileStamp::of(s);
    const int closed = ::close(m_descriptor);
    m_descriptor = -1;
    if (closed != 0 && errno != EINTR) fail("The file cannot be written to the disk", errno);
}

void AtomicFile::checkTarget() const
{
    if (FileStamp::of(m_target) != m_before)
        throw Error(m_shown,
                    "The file was changed by another program while it was being saved; nothing was changed. "
                    "Save it again, or under another name.");
}

int AtomicFile::takeName() noexcept
{
    if (::rename(m_temporary.c_str(), m_target.c_str()) != 0) return errno;
    m_left = true;
    return 0;
}

FileStamp AtomicFile::commit()
{
    seal();
    checkTarget();
    if (const int error = takeName(); error != 0) fail("The file cannot take its name", error);
    // The name itself must reach the disk too. The file is there by now, so that a failure is no error.
    (void)syncFolder(folderOf(m_target));
    return m_stamp;
}

std::filesystem::path folderOf(const std::filesystem::path& path)
{
    return path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
}

int syncFolder(const std::filesystem::path& folder) noexcept
{
    const int d = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (d < 0) return errno == EACCES ? 0 : errno;  // folders that may be written to, but not be listed
    const int error = ::fsync(d) == 0 ? 0 : errno;
    ::close(d);
    return error == EINVAL || error == ENOSYS || error == EOPNOTSUPP ? 0 : error;
}

}  // namespace punctum::las
