// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace punctum
{
class Progress;
}

namespace punctum::las
{

struct LazInfo;

/// The bytes of one pointwise chunk (formats 0 to 5) with these records, of which there is at least one: those that
/// LASzip writes, sooner. Throws Cancelled.
std::vector<std::byte> encodePointwise(const LazInfo& info, std::span<const std::byte> records,
                                       const Progress& progress);

}  // namespace punctum::las
