// SPDX-License-Identifier: MIT
#include "core/Memory.h"

#include <unistd.h>

#include <fstream>
#include <limits>
#include <string>

namespace punctum
{

std::uint64_t availableMemory()
{
    std::ifstream file("/proc/meminfo");
    for (std::string name; file >> name; file.ignore(std::numeric_limits<std::streamsize>::max(), '\n')) {
        std::uint64_t kibibytes = 0;
        if (name == "MemAvailable:" && file >> kibibytes) return kibibytes * 1024;
    }
    const long pages = ::sysconf(_SC_PHYS_PAGES), bytes = ::sysconf(_SC_PAGESIZE);
    return pages > 0 && bytes > 0 ? std::uint64_t(pages) * std::uint64_t(bytes) : 0;
}

}  // namespace punctum
