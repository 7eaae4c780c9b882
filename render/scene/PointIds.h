// SPDX-License-Identifier: MIT
#pragma once

#include "render/order/SlotOrder.h"
#include "render/scene/PointId.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace punctum::render
{

/// The table of the numbers that a view's points have: whose slot each stands for, or that it is nobody's.
///
/// Numbers are dealt out by blocks of 65,536 (PointStore::kBlockSlots), to each layer in a row as many as its slots
/// need, so that one look into the table finds the layer. The last block, in which kNoPoint is, is dealt to nobody.
/// So nothing wraps round: a layer for which no blocks are left is refused, and what was not dealt out, the rest of
/// a layer's last block too, is found to be nobody's.
class PointIds
{
public:
    static constexpr int kBlockBits = 16;
    static constexpr std::size_t kBlocks = kNoPoint >> kBlockBits;

    /// The first number of the next layer, of `count` in a row. Throws Error when there are not so many left; the
    /// others stay as they are then.
    PointId take(Slot count);

    std::size_t layers() const noexcept { return m_layers.size(); }
    void clear() noexcept;

    struct Place {
        std::size_t layer;
        Slot slot;
    };
    /// What a number stands for; none for kNoPoint and all others that nobody has.
    std::optional<Place> find(PointId id) const noexcept
    {
        const std::size_t block = id >> kBlockBits;
        if (block >= m_owners.size()) return std::nullopt;
        const Taken& owner = m_layers[m_owners[block]];
        const Slot slot = id - owner.first;
        if (slot >= owner.count) return std::nullopt;
        return Place{m_owners[block], slot};
    }

private:
    struct Taken {
        PointId first;
        Slot count;
    };
    std::vector<Taken> m_layers;
    std::vector<std::uint32_t> m_owners;  ///< layer of each block
};

}  // namespace punctum::render
