// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Buffer.h"

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <thread>
#include <utility>

namespace punctum
{

/// Where large arrays lie, so that all of them together keep to memoryBudget().
///
/// Those that come first are memory for good. What comes when the share of their use is taken lies in a file
/// without a name, which is mapped: to whoever reads or writes it, from any thread, with a lock or without, it is
/// memory like any other. A thread of its own looks at how much of the files is resident, and lets go of pages, in
/// turn, those of columns before those of what is drawn, which each frame looks at, until it fits into what the
/// budget leaves (an eighth at least): the file keeps their values, and they come back when they are touched. So
/// nothing that works on columns has to know how large a cloud may be. Only whoever fills them from nothing, faster
/// than that thread can follow, does its work in between: keepUp().
///
/// The disk's room is taken when an array is made, so that a full disk is an Error then and not a crash later.
/// Any thread.
class Residency
{
public:
    static Residency& instance();
    ~Residency() = default;
    Residency(const Residency&) = delete;
    Residency& operator=(const Residency&) = delete;

    /// Zeros. `bytes`: whole pages. Throws Error where neither memory nor disk have room.
    BufferPlace take(std::size_t bytes, BufferUse use);
    void giveBack(const BufferPlace& place) noexcept;

    /// Lets go of the pages of these bytes, where they lie in a file: whoever filled them needs them no more. They
    /// come back when they are touched.
    void leave(const std::byte* at, std::size_t bytes) noexcept;

    /// Has been told of so many bytes that were put into arrays; now and then it lets go of pages before it
    /// returns, if too many are resident. Next to nothing where all arrays are memory for good.
    void keepUp(std::uint64_t bytes);

    std::uint64_t inMemory() const;  ///< bytes of all arrays that are counted and are memory for good
    std::uint64_t inFiles() const;   ///< bytes of those that lie in files
    /// Bytes of files that are resident at present, as the system counts them.
    std::uint64_t resident() const;
    /// Bytes of files that may stay resident.
    std::uint64_t residentMost() const;

    /// While one lives, arrays are filled, here and there: a page of a file that is touched brings none of its
    /// neighbors along, which would be zeroed, or read, for nothing.
    class Filling
    {
    public:
        Filling() { instance().fill(1); }
        ~Filling() { instance().fill(-1); }
        Filling(const Filling&) = delete;
        Filling& operator=(const Filling&) = delete;
    };

    /// Where the files are made: the user's cache folder (XDG_CACHE_HOME/punctum, ~/.cache/punctum), or /var/tmp
    /// where that is no disk but memory.
    static std::filesystem::path folder();

private:
    Residency() = default;
    bool fits(std::size_t bytes, BufferUse use) const;
    BufferPlace takeFile(std::size_t bytes, BufferUse use);
    std::uint64_t fileShare() const;  ///< residentMost(), with m_mutex held
    void keepTo(const std::stop_token& stop);
    void fill(int more);
    void letGo();

    struct Mapped {
        std::size_t bytes = 0;
        int file = -1;
        BufferUse use = BufferUse::Points;
    };
    bool letGoOf(BufferUse use, std::uint64_t goal);
    static void letGoOf(const std::pair<std::byte*, Mapped>& mapped, std::size_t offset, std::size_t bytes);

    mutable std::mutex m_mutex;  ///< guards what follows; pages are let go of while it is held
    std::condition_variable_any m_wake;
    std::uint64_t m_inMemory = 0, m_inFiles = 0;
    std::uint64_t m_others = 0;               ///< resident pages of files that are not ours: the program itself
    std::map<std::byte*, Mapped> m_mapped;    ///< by address
    int m_fillings = 0;                       ///< of Filling that live
    std::map<BufferUse, std::byte*> m_hands;  ///< where letting go of each goes on
    std::atomic<bool> m_files = false;        ///< there are some
    std::atomic<std::uint64_t> m_put = 0;     ///< bytes that keepUp() was told of since it last looked
    std::jthread m_keeper;                    ///< while there are files
};

}  // namespace punctum
