// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/PointFormat.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace punctum::las
{

/// Copies the fields of `count` records of layout.length bytes to columns: columns[k] is where field k of the first
/// of these points goes, or null to leave it out. Tight loops over pieces that stay in the first-level cache.
void deinterleave(const RecordLayout& layout, const std::byte* records, std::size_t count,
                  std::span<std::byte* const> columns);

/// The reverse: columns[k] is where field k of the first point is, or null for zeros.
void interleave(const RecordLayout& layout, std::span<const std::byte* const> columns, std::size_t count,
                std::byte* records);

/// 0 ... count-1 in an order that visits everywhere early: each run of the order is spread over the whole.
std::vector<std::uint32_t> spreadOrder(std::uint32_t count);

}  // namespace punctum::las
