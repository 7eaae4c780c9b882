// SPDX-License-Identifier: MIT
#pragma once

#include <unistd.h>

#include <filesystem>
#include <string>

namespace punctum
{

/// Cuts off what a history has spilled to this folder: the file has no name, but this program has it open. Returns
/// how many files that were.
inline int cutSpillFiles(const std::string& folder)
{
    int cut = 0;
    for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
        std::error_code ignored;
        const std::string target = std::filesystem::read_symlink(entry.path(), ignored).string();
        if (target.starts_with(folder) && ::truncate(entry.path().c_str(), 1) == 0) ++cut;
    }
    return cut;
}

}  // namespace punctum
