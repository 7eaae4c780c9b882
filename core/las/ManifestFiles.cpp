// SPDX-License-Identifier: MIT
#include "core/las/ManifestFiles.h"

#include "core/Error.h"
#include "core/las/AtomicFile.h"
#include "core/las/Leftovers.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <system_error>
#include <thread>
#include <utility>

namespace punctum::las
{

namespace
{

namespace fs = std::filesystem;

constexpr int kNamesTried = 16;
constexpr std::chrono::milliseconds kBetweenLooks{10};

bool writeAll(int descriptor, const std::string& text)
{
    for (std::size_t at = 0; at < text.size();) {
        const ssize_t n = ::pwrite(descriptor, text.data() + at, text.size() - at, off_t(at));
        if (n < 0 && errno == EINTR) continue;
        if (n == 0) errno = ENOSPC;
        if (n <= 0) return false;
        at += std::size_t(n);
    }
    return true;
}

std::string readAll(int descriptor, std::size_t size)
{
    std::string text(size, '\0');
    std::size_t at = 0;
    while (at < size) {
        const ssize_t n = ::pread(descriptor, text.data() + at, size - at, off_t(at));
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) break;
        at += std::size_t(n);
    }
    text.resize(at);
    return text;
}

/// Whether the path still leads to the open file.
bool leadsTo(const fs::path& path, int descriptor)
{
    struct stat named {
    }, open{};
    return ::lstat(path.c_str(), &named) == 0 && ::fstat(descriptor, &open) == 0 && named.st_dev == open.st_dev &&
           named.st_ino == open.st_ino;
}

}  // namespace

ManifestFiles::ManifestFiles(fs::path shown, const std::map<fs::path, std::vector<ManifestEntry>>& folders)
    : m_shown(std::move(shown))
{
    const auto first = folders.begin();
    SaveManifest decider;
    for (const auto& [folder, files] : folders) decider.total += files.size();
    decider.files = first->second;
    createDecider(first->first);
    try {
        for (auto it = std::next(first); it != folders.end(); ++it) {
            const std::string text = manifestText({first->first, {}, it->second, decider.total});
            AtomicFile file(it->first / m_decider.filename());
            m_others.push_back(file.target());
            file.writeAt(0, std::as_bytes(std::span(text)));
            file.sync();
            file.commit();
            decider.others.push_back(it->first);
        }
        for (const auto& [folder, files] : folders)
            if (const int error = syncFolder(folder); error != 0) throw Error(systemReason(error) + ".");
        decide(manifestText(decider));
    } catch (const Error& e) {
        removeUndone();
        throw Error(m_shown,
                    std::string("Nothing was changed, since the save cannot be noted down beside it: ") + e.what());
    } catch (...) {
        removeUndone();
        throw;
    }
}

ManifestFiles::~ManifestFiles()
{
    if (m_descriptor >= 0) ::close(m_descriptor);
}

/// The one that decides is there and locked before any other, and says nothing yet.
void ManifestFiles::createDecider(const fs::path& folder)
{
    for (int attempt = 0; attempt < kNamesTried; ++attempt) {
        m_decider = folder / manifestName();
        m_descriptor = ::open(m_decider.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (m_descriptor < 0 && errno == EEXIST) continue;
        if (m_descriptor < 0) break;
        // Somebody who looks for manifests may have it locked, or have removed it, as it is empty. Where there are
        // no locks, the process in its name tells that it is in use.
        const bool locked = ::flock(m_descriptor, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK;
        if (locked && leadsTo(m_decider, m_descriptor)) return;
        ::close(std::exchange(m_descriptor, -1));
        errno = EBUSY;
    }
    throw Error(m_shown,
                "Nothing was changed, since the save cannot be noted down beside it: " + systemReason(errno) + ".");
}

void ManifestFiles::decide(const std::string& text)
{
    if (writeAll(m_descriptor, text) && ::fsync(m_descriptor) == 0) return;
    throw Error(errno == ENOSPC || errno == EDQUOT ? "The disk is full." : systemReason(errno) + ".");
}

void ManifestFiles::removeDone() noexcept
{
    if (removeManifests(m_others)) ::unlink(m_decider.c_str());
}

void ManifestFiles::removeUndone() noexcept
{
    (void)::ftruncate(m_descriptor, 0);  // whether it can be removed or not
    ::unlink(m_decider.c_str());
    (void)syncFolder(m_decider.parent_path());
    (void)removeManifests(m_others);
}

bool removeManifests(const std::vector<fs::path>& manifests) noexcept
{
    bool all = true;
    for (const fs::path& manifest : manifests) {
        all = (::unlink(manifest.c_str()) == 0 || errno == ENOENT) && all;
        all = syncFolder(manifest.parent_path()) == 0 && all;
    }
    return all;
}

FoundManifest::FoundManifest(const fs::path& path, Clock::time_point waitUntil) : m_access(lock(path, waitUntil))
{
    if (m_access != Access::Locked) close();
}

FoundManifest::~FoundManifest()
{
    close();
}

void FoundManifest::close() noexcept
{
    if (m_descriptor >= 0) ::close(std::exchange(m_descriptor, -1));
}

FoundManifest::Access FoundManifest::lock(const fs::path& path, Clock::time_point waitUntil)
{
    const long process = processOfManifest(path.filename().string());
    for (;; std::this_thread::sleep_for(kBetweenLooks)) {
        close();
        for (const int flags : {O_RDWR, O_RDONLY})  // network file systems lock what may be written
            if (m_descriptor < 0) m_descriptor = ::open(path.c_str(), flags | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
        if (m_descriptor < 0) return errno == ENOENT ? Access::Gone : Access::Refused;
        struct stat s {
        }, folder{};
        if (::fstat(m_descriptor, &s) != 0 || !S_ISREG(s.st_mode) || std::uint64_t(s.st_size) > kLargestManifest)
            return Access::Refused;
        // Where all may write, but replace their own files alone (/tmp), nobody gets more rights by a manifest.
        if (::stat(folderOf(path).c_str(), &folder) != 0 ||
            ((folder.st_mode & S_ISVTX) != 0 && s.st_uid != ::geteuid()))
            return Access::Refused;
        const bool busy = ::flock(m_descriptor, LOCK_EX | LOCK_NB) != 0 &&
                          (errno == EWOULDBLOCK || (process != ::getpid() && isRunning(process)));
        if (!busy && leadsTo(path, m_descriptor)) {
            if (::fstat(m_descriptor, &s) != 0 || std::uint64_t(s.st_size) > kLargestManifest)
                return Access::Refused;
            m_text = readAll(m_descriptor, std::size_t(s.st_size));
            return Access::Locked;
        }
        if (Clock::now() >= waitUntil) return Access::InUse;
    }
}

}  // namespace punctum::las
