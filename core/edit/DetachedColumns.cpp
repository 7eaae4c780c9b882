// SPDX-License-Identifier: MIT
#include "core/edit/DetachedColumns.h"

#include "core/Error.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

namespace punctum
{

namespace
{

std::size_t bytesOf(const Column& column)
{
    return std::size_t(column.size()) * column.elementBytes();
}

/// Those of its pages that hold nothing else: what remains of the last one stays in memory.
std::size_t wholePages(const Column& column)
{
    static const auto page = std::size_t(::sysconf(_SC_PAGESIZE));
    return bytesOf(column) / page * page;
}

/// New pages of memory; given back unless they are put into the place of others.
class Pages
{
public:
    explicit Pages(std::size_t bytes)
        : m_bytes(bytes),
          m_at(::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0))
    {
        if (m_at == MAP_FAILED) throw Error("There is not enough memory to undo this.");
    }
    ~Pages()
    {
        if (m_at != MAP_FAILED) ::munmap(m_at, m_bytes);
    }
    Pages(const Pages&) = delete;
    Pages& operator=(const Pages&) = delete;

    std::span<std::byte> bytes() noexcept { return {static_cast<std::byte*>(m_at), m_bytes}; }
    void putOver(std::byte* place)
    {
        if (::mremap(m_at, m_bytes, m_bytes, MREMAP_MAYMOVE | MREMAP_FIXED, place) == MAP_FAILED)
            throw Error("There is not enough memory to undo this.");
        m_at = MAP_FAILED;
    }

private:
    std::size_t m_bytes;
    void* m_at;
};

}  // namespace

void DetachedColumns::clear() noexcept
{
    for (Detached& one : m_all) {
        if (!one.piece || one.column.use_count() == 1) continue;
        try {
            fetch(one);  // somebody else has it, and the room of the piece is about to be used for other things
        } catch (const std::exception&) {
            // Nobody will see these values any more, but they must be there to be read.
            [[maybe_unused]] void* const zeros =
                ::mmap(one.column->data(), one.piece->size(), PROT_READ | PROT_WRITE,
                       MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE | MAP_FIXED, -1, 0);
        }
    }
    for (Detached& one : m_all) one.column.reset();  // before its piece
    m_all.clear();
}

void DetachedColumns::add(std::shared_ptr<Column> column)
{
    const auto is = [&](const Detached& one) { return one.column == column; };
    if (std::none_of(m_all.begin(), m_all.end(), is)) m_all.push_back({std::move(column), std::nullopt});
}

void DetachedColumns::spill(SpillFile& file)
{
    for (Detached& one : m_all) {
        const std::size_t bytes = wholePages(*one.column);
        if (one.piece || bytes == 0 || one.column->inFile()) continue;
        SpillFile::Piece piece = file.write({one.column->data(), bytes}, std::size_t(::sysconf(_SC_PAGESIZE)));
        piece.mapOver(one.column->data());
        one.piece = std::move(piece);
    }
}

void DetachedColumns::fetch(Detached& one)
{
    Pages pages(one.piece->size());
    one.piece->read(pages.bytes());
    pages.putOver(one.column->data());
    one.piece.reset();
}

void DetachedColumns::fetch()
{
    for (Detached& one : m_all)
        if (one.piece) fetch(one);
}

std::size_t DetachedColumns::memory() const noexcept
{
    std::size_t bytes = 0;
    for (const Detached& one : m_all)
        if (!one.column->inFile()) bytes += bytesOf(*one.column) - (one.piece ? one.piece->size() : 0);
    return bytes;
}

std::size_t DetachedColumns::spilled() const noexcept
{
    std::size_t bytes = 0;
    for (const Detached& one : m_all) bytes += one.piece ? one.piece->size() : 0;
    return bytes;
}

}  // namespace punctum
