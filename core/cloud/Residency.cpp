// SPDX-License-Identifier: MIT
#include "core/cloud/Residency.h"

#include "core/Error.h"
#include "core/Memory.h"
#include "core/NamelessFile.h"
#include "core/Text.h"

#include <fcntl.h>
#include <linux/magic.h>
#include <sys/mman.h>
#include <sys/statfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>

namespace punctum
{

namespace
{

constexpr std::size_t kHugePage = std::size_t(2) << 20;
constexpr std::size_t kSmall = std::size_t(1) << 20;        ///< less than this is not worth a file
constexpr std::size_t kStride = std::size_t(8) << 20;       ///< let go of at once
constexpr std::size_t kLookAgain = std::size_t(64) << 20;   ///< of strides between two looks at what is resident
constexpr std::uint64_t kMostPut = std::uint64_t(8) << 20;  ///< bytes between two looks of those who fill
constexpr auto kPause = std::chrono::milliseconds(10);      ///< a fast machine touches some 50 MB meanwhile

std::uint64_t share(std::uint64_t budget, BufferUse use)
{
    return use == BufferUse::Points ? budget / 2 : budget / 8 * 7;
}

/// Resident pages of files that the process has mapped, in bytes; 0 where the system does not tell.
std::uint64_t residentOfFiles()
{
    std::ifstream statm("/proc/self/statm");
    std::uint64_t total = 0, resident = 0, shared = 0;
    if (!(statm >> total >> resident >> shared)) return 0;
    return shared * std::uint64_t(::sysconf(_SC_PAGESIZE));
}

bool isMemory(const std::filesystem::path& folder)
{
    struct statfs about {
    };
    if (::statfs(folder.c_str(), &about) != 0) return false;
    return about.f_type == TMPFS_MAGIC || about.f_type == RAMFS_MAGIC;
}

/// Room on the disk for the whole file, now, if a twentieth of the disk stays free for others: a file that tells of
/// more points than it has may ask for anything. False, and errno, where there is none.
bool takeRoom(int file, std::size_t bytes)
{
    struct statfs about {
    };
    if (::fstatfs(file, &about) != 0) return false;
    const auto block = std::uint64_t(about.f_bsize);
    const std::uint64_t free = std::uint64_t(about.f_bavail) * block,
                        spared = std::uint64_t(about.f_blocks) * block / 20;
    if (free < spared || free - spared < bytes) {
        errno = ENOSPC;
        return false;
    }
    if (::fallocate(file, 0, 0, off_t(bytes)) == 0) return true;
    // A file system that cannot promise has the room at least.
    return errno == EOPNOTSUPP && ::ftruncate(file, off_t(bytes)) == 0;
}

BufferPlace takeMemory(std::size_t bytes, BufferUse use)
{
    void* const at =
        ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (at == MAP_FAILED) throw Error("There is not enough memory: " + sizeText(bytes) + " more are needed.");
    // Fewer page faults and TLB misses: measured on filling columns, not needed for correctness.
    if (bytes >= kHugePage) (void)::madvise(at, bytes, MADV_HUGEPAGE);
    return {static_cast<std::byte*>(at), bytes, use, false};
}

}  // namespace

Residency& Residency::instance()
{
    static Residency* const only =
        new Residency;  // never destroyed: arrays may be given back after main() has ended
    return *only;
}

std::filesystem::path Residency::folder()
{
    const auto given = [](const char* name) {
        const char* const value = std::getenv(name);
        return std::filesystem::path(value != nullptr && *value == '/' ? value : "");
    };
    std::filesystem::path cache = given("XDG_CACHE_HOME");
    if (cache.empty() && !given("HOME").empty()) cache = given("HOME") / ".cache";
    if (cache.empty() || isMemory(cache)) return "/var/tmp";
    return cache / "punctum";
}

bool Residency::fits(std::size_t bytes, BufferUse use) const
{
    const std::uint64_t most = share(memoryBudget(), use);
    return m_inMemory <= most && bytes <= most - m_inMemory;
}

BufferPlace Residency::take(std::size_t bytes, BufferUse use)
{
    if (use == BufferUse::Working || bytes < kSmall) return takeMemory(bytes, BufferUse::Working);
    const std::lock_guard lock(m_mutex);
    if (!fits(bytes, use)) {
        try {
            return takeFile(bytes, use);
        } catch (const Error&) {
            // Nobody asked for a bound: what there is of memory is tried first, as other programs do.
            if (memoryBudgetSet()) throw;
        }
    }
    const BufferPlace place = takeMemory(bytes, use);
    m_inMemory += bytes;
    return place;
}

BufferPlace Residency::takeFile(std::size_t bytes, BufferUse use)
{
    const std::filesystem::path where = folder();
    const int file = openNameless(where, "points");
    void* at = MAP_FAILED;
    if (file >= 0 && takeRoom(file, bytes))
        at = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_NORESERVE, file, 0);
    if (at == MAP_FAILED) {
        const std::string why = std::strerror(errno);
        if (file >= 0) ::close(file);
        throw Error("There is no room for this: " + sizeText(bytes) + " more go beyond the memory budget of " +
                    sizeText(memoryBudget()) + ", and " + where.string() + " cannot take them (" + why + ").");
    }
    if (m_mapped.empty()) m_others = residentOfFiles();
    if (m_fillings > 0) (void)::madvise(at, bytes, MADV_RANDOM);
    m_mapped[static_cast<std::byte*>(at)] = {bytes, file, use};
    m_inFiles += bytes;
    m_files = true;
    if (!m_keeper.joinable()) m_keeper = std::jthread([this](const std::stop_token& stop) { keepTo(stop); });
    return {static_cast<std::byte*>(at), bytes, use, true};
}

void Residency::giveBack(const BufferPlace& place) noexcept
{
    if (place.at == nullptr) return;
    std::jthread ended;  // joined when the lock is free
    if (place.use != BufferUse::Working) {
        const std::lock_guard lock(m_mutex);
        if (place.inFile) {
            const auto mapped = m_mapped.find(place.at);
            ::close(mapped->second.file);
            m_mapped.erase(mapped);
            m_inFiles -= place.bytes;
            m_files = !m_mapped.empty();
            if (m_mapped.empty()) ended = std::move(m_keeper);
        } else {
            m_inMemory -= place.bytes;
        }
    }
    ::munmap(place.at, place.bytes);
}

std::uint64_t Residency::inMemory() const
{
    const std::lock_guard lock(m_mutex);
    return m_inMemory;
}

std::uint64_t Residency::inFiles() const
{
    const std::lock_guard lock(m_mutex);
    return m_inFiles;
}

std::uint64_t Residency::resident() const
{
    const std::lock_guard lock(m_mutex);
    const std::uint64_t all = residentOfFiles();
    return m_mapped.empty() || all < m_others ? 0 : all - m_others;
}

std::uint64_t Residency::residentMost() const
{
    const std::lock_guard lock(m_mutex);
    return fileShare();
}

std::uint64_t Residency::fileShare() const
{
    const std::uint64_t budget = memoryBudget();
    return std::max(budget / 8, budget - std::min(budget, m_inMemory));
}

void Residency::fill(int more)
{
    const std::lock_guard lock(m_mutex);
    const bool before = m_fillings > 0;
    m_fillings += more;
    if (before == (m_fillings > 0)) return;
    for (const auto& [at, mapped] : m_mapped)
        (void)::madvise(at, mapped.bytes, m_fillings > 0 ? MADV_RANDOM : MADV_NORMAL);
}

void Residency::leave(const std::byte* at, std::size_t bytes) noexcept
{
    if (!m_files || bytes == 0) return;
    std::pair<std::byte*, Mapped> of;
    {
        const std::lock_guard lock(m_mutex);
        const auto after = m_mapped.upper_bound(const_cast<std::byte*>(at));
        if (after == m_mapped.begin()) return;
        of = *std::prev(after);
    }
    const auto offset = std::size_t(at - of.first);
    if (offset >= of.second.bytes) return;
    // Pages at both ends that others fill come back to them.
    const auto page = std::size_t(::sysconf(_SC_PAGESIZE));
    const std::size_t first = offset / page * page;
    const std::size_t last = std::min((offset + bytes + page - 1) / page * page, of.second.bytes);
    letGoOf(of, first, last - first);  // which may wait for the disk: the array is the caller's, and stays
}

void Residency::letGoOf(const std::pair<std::byte*, Mapped>& mapped, std::size_t offset, std::size_t bytes)
{
    (void)::madvise(mapped.first + offset, bytes, MADV_DONTNEED);
    // Columns go on their way to the disk, so that the system has few pages that it cannot drop. Those of what is
    // drawn are written here and there for as long as points arrive, and waiting for a busy disk would let them
    // pile up: the system knows when to begin.
    if (mapped.second.use == BufferUse::Points)
        (void)::sync_file_range(mapped.second.file, off_t(offset), off_t(bytes), SYNC_FILE_RANGE_WRITE);
}

void Residency::keepUp(std::uint64_t bytes)
{
    if (!m_files || m_put.fetch_add(bytes) + bytes < kMostPut) return;
    m_put = 0;
    const std::lock_guard lock(m_mutex);
    if (m_files) letGo();
}

void Residency::keepTo(const std::stop_token& stop)
{
    std::unique_lock lock(m_mutex);
    while (!stop.stop_requested()) {
        m_wake.wait_for(lock, stop, kPause, [] { return false; });
        if (!stop.stop_requested()) letGo();
    }
}

void Residency::letGo()
{
    const std::uint64_t own = fileShare(), most = m_others + own;
    if (residentOfFiles() <= most) return;
    const std::uint64_t goal = most - own / 8;  // so that there is something to do in few pauses
    if (!letGoOf(BufferUse::Points, goal)) letGoOf(BufferUse::Drawing, goal);
}

/// Once round at most; whether the goal was reached.
bool Residency::letGoOf(BufferUse use, std::uint64_t goal)
{
    if (m_mapped.empty()) return true;
    std::byte*& hand = m_hands[use];
    std::uint64_t looked = 0;
    auto at = m_mapped.upper_bound(hand);
    if (at != m_mapped.begin() && hand < std::prev(at)->first + std::prev(at)->second.bytes) --at;
    for (std::size_t turn = 0; turn <= m_mapped.size(); ++turn, ++at) {
        if (at == m_mapped.end()) at = m_mapped.begin();
        auto& [first, mapped] = *at;
        if (mapped.use != use) continue;
        const bool inside = turn == 0 && hand >= first && hand < first + mapped.bytes;
        for (std::size_t offset = inside ? std::size_t(hand - first) : 0; offset < mapped.bytes;
             offset += kStride) {
            const std::size_t bytes = std::min(kStride, mapped.bytes - offset);
            letGoOf(*at, offset, bytes);
            hand = first + offset + bytes;
            looked += bytes;
            if (looked < kLookAgain) continue;
            looked = 0;
            if (residentOfFiles() <= goal) return true;
        }
    }
    return residentOfFiles() <= goal;
}

}  // namespace punctum
