// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Column.h"
#include "render/order/RunOrder.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>

namespace punctum::render
{

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

/// "prime", "stratified": names on the command line.
std::string_view nameOf(OrderKind kind) noexcept;
std::optional<OrderKind> orderFromName(std::string_view name) noexcept;

/// How one group of K members is dealt to the K windows: window = member * factor + shift, modulo K.
struct GroupShuffle {
    std::uint32_t factor;   ///< odd
    std::uint32_t inverse;  ///< of factor, modulo 2^32
    std::uint32_t shift;

    /// `mask` is K - 1.
    std::uint32_t window(std::uint32_t member, std::uint32_t mask) const noexcept
    {
        return (member * factor + shift) & mask;
    }
    std::uint32_t member(std::uint32_t window, std::uint32_t mask) const noexcept
    {
        return ((window - shift) * inverse) & mask;
    }
};
GroupShuffle groupShuffle(std::uint32_t group) noexcept;

/// A bijection point index <-> slot such that runs of consecutive slots are random subsets of the cloud.
///
/// Runs are uniform when they cover whole windows: begin and end drawing at multiples of windowSize(). Groups are
/// of points at consecutive places, which are those of the file or of a RunOrder. Immutable; all members may be
/// called from any thread.
class SlotOrder
{
public:
    SlotOrder() = default;
    SlotOrder(OrderKind kind, PointIndex points);

    OrderKind kind() const noexcept { return m_kind; }
    PointIndex points() const noexcept { return m_points; }
    /// Slots needed: points(), and padding that stays empty (less than 2 % of large clouds).
    Slot slotCount() const noexcept { return m_slots; }
    /// Slots of the smallest run that is spread over the whole cloud.
    Slot windowSize() const noexcept { return m_window; }

    /// Stratified: K - 1, where K is the number of windows and of members in a group.
    std::uint32_t memberMask() const noexcept { return (1u << m_groupBits) - 1; }
    std::uint32_t groupBits() const noexcept { return m_groupBits; }

    /// The order of points that is dealt out: their places. Null: the file's, a point's place is its index.
    const RunOrder* runs() const noexcept { return m_runs.get(); }
    /// Stratified alone. Slots are as many as before, but stand for other points.
    void setRuns(std::shared_ptr<const RunOrder> runs) noexcept { m_runs = std::move(runs); }

    Slot slotOf(PointIndex index) const noexcept { return slotOfPlace(placeOf(index)); }
    /// points() or more for a padding slot. Prime: a few hundred nanoseconds (modular roots); Stratified: a few.
    PointIndex indexOf(Slot slot) const noexcept { return indexAt(placeAt(slot)); }
    /// Slots of consecutive points into `out` (range.size() values).
    void slotsOf(PointRange range, Slot* out) const noexcept;

    PointIndex placeOf(PointIndex index) const noexcept { return m_runs ? m_runs->placeOf(index) : index; }
    PointIndex indexAt(PointIndex place) const noexcept
    {
        return m_runs && place < m_points ? m_runs->indexAt(place) : place;
    }
    Slot slotOfPlace(PointIndex place) const noexcept;
    /// points() or more for a padding slot.
    PointIndex placeAt(Slot slot) const noexcept;

private:
    void slotsOfPlaces(PointRange places, Slot* out) const noexcept;

    std::shared_ptr<const RunOrder> m_runs;
    OrderKind m_kind = OrderKind::Stratified;
    PointIndex m_points = 0;
    Slot m_slots = 0;
    Slot m_window = 1;
    std::uint32_t m_prime = 0;      ///< Prime: largest prime <= points that is 3 mod 4
    std::uint32_t m_groupBits = 0;  ///< Stratified: log2 of K
};

}  // namespace punctum::render
