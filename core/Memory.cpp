// SPDX-License-Identifier: MIT
#include "core/Memory.h"

#include <unistd.h>

#include <atomic>
#include <fstream>
#include <limits>
#include <string>

namespace punctum
{

namespace
{

std::atomic<std::uint64_t> givenBudget{0};  // 0: the preset

}  // namespace

std::uint64_t machineMemory() noexcept
{
    const long pages = ::sysconf(_SC_PHYS_PAGES), bytes = ::sysconf(_SC_PAGESIZE);
    return pages > 0 && bytes > 0 ? std::uint64_t(pages) * std::uint64_t(bytes) : 0;
}

std::uint64_t availableMemory()
{
    std::ifstream file("/proc/meminfo");
    for (std::string name; file >> name; file.ignore(std::numeric_limits<std::streamsize>::max(), '\n')) {
        std::uint64_t kibibytes = 0;
        if (name == "MemAvailable:" && file >> kibibytes) return kibibytes * 1024;
    }
    return machineMemory();
}

std::uint64_t memoryBudget() noexcept
{
    const std::uint64_t set = givenBudget.load(std::memory_order_relaxed);
    return set != 0 ? set : machineMemory() / 5 * 4;
}

void setMemoryBudget(std::uint64_t bytes) noexcept
{
    givenBudget.store(bytes, std::memory_order_relaxed);
}

bool memoryBudgetSet() noexcept
{
    return givenBudget.load(std::memory_order_relaxed) != 0;
}

}  // namespace punctum
