// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace punctum
{

/// Bytes of memory that can be had at present without taking any from other programs; of all there is where the
/// system does not tell. Any thread.
std::uint64_t availableMemory();

}  // namespace punctum
