// SPDX-License-Identifier: MIT
#include "core/MachineMemory.h"

#include <unistd.h>

namespace punctum
{

std::uint64_t machineMemory() noexcept
{
    const long pages = ::sysconf(_SC_PHYS_PAGES), bytes = ::sysconf(_SC_PAGESIZE);
    return pages > 0 && bytes > 0 ? std::uint64_t(pages) * std::uint64_t(bytes) : 0;
}

}  // namespace punctum
