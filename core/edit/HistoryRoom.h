// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <filesystem>

namespace punctum
{

/// Where a history keeps what undo and redo need.
struct HistoryRoom {
    /// Bytes that the commands nearest to the present state may take; the others are packed, and are a little
    /// slower to undo.
    std::size_t loose = std::size_t(128) << 20;
    /// Bytes of memory for all of them together; what goes beyond, farthest from the present state, is moved to a
    /// file.
    std::size_t memory = defaultMemory();
    std::filesystem::path folder{};  ///< of that file; empty: all stays in memory
    bool undo = true;                ///< false: nothing is kept, since nobody will undo

    /// A sixteenth of memoryBudget(), and no less than 256 MiB.
    static std::size_t defaultMemory() noexcept;
};

}  // namespace punctum
