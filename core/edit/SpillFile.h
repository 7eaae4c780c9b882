// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

namespace punctum
{

/// A file that takes what is to be kept, but not in memory. It loses its name as soon as it is made, so that
/// nothing of it is left however the program ends. Room that is given back is used again, and cut off at the file's
/// end. Any thread.
class SpillFile final : public std::enable_shared_from_this<SpillFile>
{
public:
    /// Bytes in the file. Gives their room back when destroyed.
    class Piece
    {
    public:
        Piece(Piece&&) noexcept = default;
        Piece& operator=(Piece&& other) noexcept;
        ~Piece();

        std::size_t size() const noexcept { return m_size; }
        /// `out`: size() bytes. Throws Error.
        void read(std::span<std::byte> out) const;
        /// Puts it into the place of these pages of private memory, which hold the same; both are whole pages.
        /// Writing there does not change the file. Throws Error.
        void mapOver(std::byte* pages) const;

    private:
        friend class SpillFile;
        Piece(std::shared_ptr<SpillFile> file, std::uint64_t at, std::size_t size)
            : m_file(std::move(file)), m_at(at), m_size(size)
        {
        }

        std::shared_ptr<SpillFile> m_file;  ///< null: moved from
        std::uint64_t m_at;
        std::size_t m_size;
    };

    /// In this folder, which is made where it is missing. Throws Error.
    static std::shared_ptr<SpillFile> create(const std::filesystem::path& folder);
    ~SpillFile();
    SpillFile(const SpillFile&) = delete;
    SpillFile& operator=(const SpillFile&) = delete;

    /// `alignment`: of its place in the file, a power of two. Throws Error when the disk has no room.
    Piece write(std::span<const std::byte> bytes, std::size_t alignment = 1);
    std::uint64_t length() const;  ///< bytes up to the end of the last piece

private:
    explicit SpillFile(int file) : m_file(file) {}
    std::uint64_t take(std::size_t bytes, std::size_t alignment);
    void giveBack(std::uint64_t at, std::size_t bytes) noexcept;

    int m_file;
    mutable std::mutex m_mutex;  ///< guards what follows
    std::uint64_t m_length = 0;
    std::map<std::uint64_t, std::uint64_t> m_free;  ///< from -> to; no two touch, none touches m_length
};

/// Bytes that are needed later: in memory, or in a file once they are spilled.
class StowedBytes
{
public:
    explicit StowedBytes(std::vector<std::byte> bytes) : m_bytes(std::move(bytes)) {}

    /// Only while they are not spilled.
    std::vector<std::byte>& operator*() noexcept { return m_bytes; }
    std::vector<std::byte>* operator->() noexcept { return &m_bytes; }
    /// A copy, from wherever they are. Throws Error.
    std::vector<std::byte> copy() const;
    /// Both throw Error, and change nothing then.
    void spill(SpillFile& file);
    void fetch();

    std::size_t memory() const noexcept { return m_bytes.size(); }
    std::size_t spilled() const noexcept { return m_piece ? m_piece->size() : 0; }

private:
    std::vector<std::byte> m_bytes;
    std::optional<SpillFile::Piece> m_piece;
};

}  // namespace punctum
