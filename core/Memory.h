// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace punctum
{

/// Bytes of memory that this machine has; 0 where that is not known. Any thread.
std::uint64_t machineMemory() noexcept;

/// Bytes of memory that can be had at present without taking any from other programs; of all there is where the
/// system does not tell. Any thread.
std::uint64_t availableMemory();

/// Bytes that large arrays (points, and what is drawn of them) may keep in memory, all together: Residency keeps
/// to it. Four fifths of what the machine has, unless it was set. Any thread.
std::uint64_t memoryBudget() noexcept;
/// 0: the preset again. To be called before anything large is made; what is there stays where it is.
void setMemoryBudget(std::uint64_t bytes) noexcept;
/// Whether it was set, and not the preset.
bool memoryBudgetSet() noexcept;

}  // namespace punctum
