// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Column.h"

#include <cstdint>
#include <string_view>

namespace punctum::render {

/// Place of a point in drawing order. 32 bits: a view holds up to 2^32 - 2 slots.
using Slot = std::uint32_t;

struct SlotRange {
    Slot first = 0;
    Slot last = 0;
    constexpr std::uint32_t size() const noexcept { return last - first; }
};

enum class OrderKind {
    Prime,       ///< prime permutation of Schuetz et al. 2019, section 3.3
    Stratified,  ///< one random member of each group of K consecutive points in each of K windows
};

/// A bijection point index <-> slot such that runs of consecutive slots are random subsets of the cloud.
///
/// Runs are uniform when they cover whole windows: begin and end drawing at multiples of windowSize().
/// Immutable; all members may be called from any thread.
class SlotOrder {
public:
    SlotOrder() = default;
    SlotOrder(OrderKind kind, PointIndex points);

    OrderKind kind() const noexcept { return m_kind; }
    PointIndex points() const noexcept { return m_points; }
    /// Slots needed: points(), plus less than one window of padding. Padding slots stay empty.
    Slot slots() const noexcept { return m_slots; }
    /// Slots of the smallest run that is spread over the whole cloud.
    Slot windowSize() const noexcept { return m_window; }

    Slot slotOf(PointIndex index) const noexcept;
    /// points() or more for a padding slot.
    PointIndex indexOf(Slot slot) const noexcept;
    /// Slots of consecutive points into `out` (range.size() values).
    void slotsOf(PointRange range, Slot* out) const noexcept;

private:
    OrderKind m_kind = OrderKind::Stratified;
    PointIndex m_points = 0;
    Slot m_slots = 0;
    Slot m_window = 1;
    std::uint32_t m_prime = 0;       ///< Prime: largest prime <= points that is 3 mod 4
    std::uint32_t m_groupBits = 0;   ///< Stratified: log2 of K
};

}  // namespace punctum::render
