// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace punctum
{

/// Bytes of memory that this machine has; 0 where that is not known.
std::uint64_t machineMemory() noexcept;

}  // namespace punctum
