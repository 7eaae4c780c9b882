// SPDX-License-Identifier: MIT
#include "tests/core/Faults.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <mutex>

namespace fs = std::filesystem;

namespace faults
{

std::vector<Step> stepsSeen;
std::string failingCall;
std::size_t failingCallSkips = 0;

namespace
{

std::atomic<bool> nowArmed{false};
std::mutex guard;
std::string watchedFolder;    ///< calls elsewhere are not counted
bool watchesReads = false;    ///< pread alone is counted; else all but it
std::size_t failingStep = 0;  ///< number of the step that fails, from 1; 0: none
Kind faultKind = Kind::Error;
int faultErrno = 0;

std::string pathOf(int descriptor)
{
    char path[4096];
    const ssize_t n = ::readlink(("/proc/self/fd/" + std::to_string(descriptor)).c_str(), path, sizeof path);
    return n > 0 ? std::string(path, std::size_t(n)) : std::string();
}

/// Counts a call; true when it is the one to fail. errno is kept.
bool fails(const char* call, const std::string& path)
{
    if (!nowArmed) return false;
    const int before = errno;
    bool now = false;
    {
        const std::lock_guard lock(guard);
        if (path.starts_with(watchedFolder) && watchesReads == (std::strcmp(call, "pread") == 0)) {
            stepsSeen.push_back({call, path.size() <= watchedFolder.size() + 1});
            now = stepsSeen.size() == failingStep;
            if (call == failingCall && failingCallSkips != 0)
                --failingCallSkips;
            else if (call == failingCall)
                now = true;
        }
    }
    if (now && faultKind == Kind::KillBefore) ::kill(::getpid(), SIGKILL);
    errno = before;
    return now;
}
int error()
{
    errno = faultErrno;
    return -1;
}

template <typename F>
F next(const char* name)
{
    return reinterpret_cast<F>(::dlsym(RTLD_NEXT, name));
}

using Write = ssize_t (*)(int, const void*, std::size_t, off_t);

ssize_t write(const char* name, int descriptor, const void* bytes, std::size_t size, off_t offset)
{
    static const auto real = next<Write>("pwrite");
    if (!fails(name, pathOf(descriptor))) return real(descriptor, bytes, size, offset);
    if (faultKind == Kind::Error) return error();
    if (faultKind == Kind::Nothing) return 0;
    if (faultKind == Kind::Wrong) {  // what a bad disk or memory does
        std::vector<char> wrong(static_cast<const char*>(bytes), static_cast<const char*>(bytes) + size);
        if (!wrong.empty()) wrong[wrong.size() / 2] ^= 1;
        return real(descriptor, wrong.data(), size, offset);
    }
    const ssize_t written = real(descriptor, bytes, (size + 1) / 2, offset);
    if (faultKind == Kind::KillInside) ::kill(::getpid(), SIGKILL);
    return written;
}

ssize_t read(int descriptor, void* bytes, std::size_t size, off_t offset)
{
    static const auto real = next<ssize_t (*)(int, void*, std::size_t, off_t)>("pread");
    if (!nowArmed || !watchesReads || !fails("pread", pathOf(descriptor)))
        return real(descriptor, bytes, size, offset);
    return faultKind == Kind::Error ? error() : real(descriptor, bytes, (size + 1) / 2, offset);
}

}  // namespace

Armed::Armed(const fs::path& folder, std::size_t step, Kind kind, int error, bool reads)
{
    watchedFolder = folder;
    watchesReads = reads;
    stepsSeen.clear();
    failingStep = step;
    failingCall.clear();
    failingCallSkips = 0;
    faultKind = kind;
    faultErrno = error;
    nowArmed = true;
}

Armed::~Armed()
{
    nowArmed = false;
}

}  // namespace faults

extern "C" {
ssize_t pwrite(int descriptor, const void* bytes, std::size_t size, off_t offset)
{
    return faults::write("pwrite", descriptor, bytes, size, offset);
}
ssize_t pwrite64(int descriptor, const void* bytes, std::size_t size, off_t offset)
{
    return faults::write("pwrite", descriptor, bytes, size, offset);
}
ssize_t pread(int descriptor, void* bytes, std::size_t size, off_t offset)
{
    return faults::read(descriptor, bytes, size, offset);
}
ssize_t pread64(int descriptor, void* bytes, std::size_t size, off_t offset)
{
    return faults::read(descriptor, bytes, size, offset);
}
ssize_t write(int descriptor, const void* bytes, std::size_t size)
{
    static const auto real = faults::next<ssize_t (*)(int, const void*, std::size_t)>("write");
    if (faults::nowArmed && faults::fails("write", faults::pathOf(descriptor))) return faults::error();
    return real(descriptor, bytes, size);
}
int fsync(int descriptor)
{
    static const auto real = faults::next<int (*)(int)>("fsync");
    return faults::fails("fsync", faults::pathOf(descriptor)) ? faults::error() : real(descriptor);
}
int fdatasync(int descriptor)
{
    static const auto real = faults::next<int (*)(int)>("fdatasync");
    return faults::fails("fsync", faults::pathOf(descriptor)) ? faults::error() : real(descriptor);
}
int ftruncate(int descriptor, off_t size) noexcept
{
    static const auto real = faults::next<int (*)(int, off_t)>("ftruncate");
    return faults::fails("ftruncate", faults::pathOf(descriptor)) ? faults::error() : real(descriptor, size);
}
int fchmod(int descriptor, mode_t mode) noexcept
{
    static const auto real = faults::next<int (*)(int, mode_t)>("fchmod");
    return faults::fails("fchmod", faults::pathOf(descriptor)) ? faults::error() : real(descriptor, mode);
}
int fchown(int descriptor, uid_t owner, gid_t group) noexcept
{
    static const auto real = faults::next<int (*)(int, uid_t, gid_t)>("fchown");
    return faults::fails("fchown", faults::pathOf(descriptor)) ? faults::error() : real(descriptor, owner, group);
}
int fsetxattr(int descriptor, const char* name, const void* value, std::size_t size, int flags) noexcept
{
    static const auto real = faults::next<int (*)(int, const char*, const void*, std::size_t, int)>("fsetxattr");
    return faults::fails("fsetxattr", faults::pathOf(descriptor)) ? faults::error()
                                                                  : real(descriptor, name, value, size, flags);
}
int rename(const char* from, const char* to) noexcept
{
    static const auto real = faults::next<int (*)(const char*, const char*)>("rename");
    return faults::fails("rename", from) ? faults::error() : real(from, to);
}
int unlink(const char* path) noexcept
{
    static const auto real = faults::next<int (*)(const char*)>("unlink");
    return faults::fails("unlink", path) ? faults::error() : real(path);
}
int close(int descriptor)
{
    static const auto real = faults::next<int (*)(int)>("close");
    if (!faults::nowArmed) return real(descriptor);
    const bool fails = faults::fails("close", faults::pathOf(descriptor));
    const int result = real(descriptor);  // Linux closes the file even then
    return fails ? faults::error() : result;
}
}
