// SPDX-License-Identifier: MIT
#pragma once

#include "render/order/SlotOrder.h"

#include <cstdint>
#include <span>
#include <vector>

namespace punctum::render
{

struct Layer;
struct TargetSize;

/// Which stretches of a layer (PointStore::stretches()) a view can see: those whose box meets the picture and what
/// the clip leaves. Points of the others need not be looked at. The box is compared with each edge of the picture
/// (frustum culling, as of the batches in Schuetz, Kerbl, Wimmer 2022, section 3), with some room for rounding: no
/// point that would be drawn is left out.
///
/// Immutable; any thread.
class VisibleStretches
{
public:
    /// All boxes of the store must be known.
    VisibleStretches(const Layer& layer, const TargetSize& size);

    bool all() const noexcept { return m_all; }
    /// Share of the slots that are in sight, 0 to 1.
    double share() const noexcept { return m_share; }
    /// Those in sight, rising.
    std::span<const std::uint32_t> list() const noexcept { return m_list; }
    /// Appends what of a run of slots is in sight, in rising order, in pieces of at most `most` slots.
    void pieces(SlotRange slots, Slot most, std::vector<SlotRange>& out) const;

private:
    Slot m_window = 1;                ///< slots of a window of the order
    std::vector<SlotRange> m_places;  ///< in sight, within each window; rising and apart
    std::vector<std::uint32_t> m_list;
    double m_share = 1.0;
    bool m_all = true;
};

}  // namespace punctum::render
