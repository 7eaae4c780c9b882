// SPDX-License-Identifier: MIT
#include "core/edit/SpillFile.h"

#include "core/Error.h"
#include "core/NamelessFile.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <iterator>
#include <new>
#include <string>
#include <utility>

namespace punctum
{

namespace
{

[[noreturn]] void failWriting(int error)
{
    throw Error(std::string("What undo needs cannot be moved to the disk, and stays in memory: ") +
                std::strerror(error) + ".");
}

}  // namespace

SpillFile::Piece& SpillFile::Piece::operator=(Piece&& other) noexcept
{
    std::swap(m_file, other.m_file);
    std::swap(m_at, other.m_at);
    std::swap(m_size, other.m_size);
    return *this;
}

SpillFile::Piece::~Piece()
{
    if (m_file) m_file->giveBack(m_at, m_size);
}

void SpillFile::Piece::read(std::span<std::byte> out) const
{
    for (std::size_t done = 0; done < m_size;) {
        const ssize_t n = ::pread(m_file->m_file, out.data() + done, m_size - done, off_t(m_at + done));
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0)
            throw Error(std::string("What this edit needs cannot be read back from the disk (") +
                        (n < 0 ? std::strerror(errno) : "the file is too short") +
                        "); the points stay as they are.");
        done += std::size_t(n);
    }
}

void SpillFile::Piece::mapOver(std::byte* pages) const
{
    if (::mmap(pages, m_size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_FIXED, m_file->m_file, off_t(m_at)) ==
        MAP_FAILED)
        failWriting(errno);
}

std::shared_ptr<SpillFile> SpillFile::create(const std::filesystem::path& folder)
{
    const int file = openNameless(folder, "undo");
    if (file < 0) failWriting(errno);
    return std::shared_ptr<SpillFile>(new SpillFile(file));
}

SpillFile::~SpillFile()
{
    ::close(m_file);
}

SpillFile::Piece SpillFile::write(std::span<const std::byte> bytes, std::size_t alignment)
{
    Piece piece(shared_from_this(), take(bytes.size(), alignment), bytes.size());
    for (std::size_t done = 0; done < bytes.size();) {
        const ssize_t n = ::pwrite(m_file, bytes.data() + done, bytes.size() - done, off_t(piece.m_at + done));
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) failWriting(n < 0 ? errno : ENOSPC);
        done += std::size_t(n);
    }
    return piece;
}

std::uint64_t SpillFile::length() const
{
    const std::lock_guard lock(m_mutex);
    return m_length;
}

/// In the first gap that is large enough, or more of the file.
std::uint64_t SpillFile::take(std::size_t bytes, std::size_t alignment)
{
    const auto aligned = [&](std::uint64_t at) { return (at + alignment - 1) & ~std::uint64_t(alignment - 1); };
    const std::lock_guard lock(m_mutex);
    for (auto gap = m_free.begin(); gap != m_free.end(); ++gap) {
        const auto [first, last] = *gap;
        const std::uint64_t at = aligned(first);
        if (at > last || last - at < bytes) continue;
        if (at + bytes != last) m_free.emplace(at + bytes, last);
        if (at != first)
            gap->second = at;
        else
            m_free.erase(gap);
        return at;
    }
    const std::uint64_t at = aligned(m_length);
    if (at != m_length) m_free.emplace(m_length, at);
    m_length = at + bytes;
    return at;
}

void SpillFile::giveBack(std::uint64_t at, std::size_t bytes) noexcept
{
    if (bytes == 0) return;
    const std::lock_guard lock(m_mutex);
    std::uint64_t end = at + bytes;
    auto next = m_free.lower_bound(at);
    if (next != m_free.end() && next->first == end) {
        end = next->second;
        next = m_free.erase(next);
    }
    if (next != m_free.begin() && std::prev(next)->second == at) {
        at = std::prev(next)->first;
        m_free.erase(std::prev(next));
    }
    if (end == m_length) {
        m_length = at;
        (void)!::ftruncate(m_file, off_t(at));  // else it is longer than it need be
        return;
    }
    try {
        m_free.emplace(at, end);
    } catch (const std::bad_alloc&) {
        // then this room is not used again
    }
}

std::vector<std::byte> StowedBytes::copy() const
{
    if (!m_piece) return m_bytes;
    std::vector<std::byte> bytes(m_piece->size());
    m_piece->read(bytes);
    return bytes;
}

void StowedBytes::spill(SpillFile& file)
{
    if (m_piece || m_bytes.empty()) return;
    m_piece = file.write(m_bytes);
    m_bytes = {};
}

void StowedBytes::fetch()
{
    if (!m_piece) return;
    m_bytes = copy();
    m_piece.reset();
}

}  // namespace punctum
