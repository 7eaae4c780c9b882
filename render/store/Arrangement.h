// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/BlockBoxes.h"
#include "render/order/RunOrder.h"
#include "render/store/DealOut.h"

#include <cstdint>
#include <memory>

namespace punctum::render
{

/// Slots of a store in another order, made while the store is drawn: PointStore::arrangement() and arrange().
struct Arrangement {
    std::shared_ptr<const RunOrder> runs;
    std::shared_ptr<const BlockBoxes> boxes;  ///< of stretches of places
    RawBounds bounds;
    LocalFrame frame;
    SlotArrays arrays;
    std::uint64_t wordChanges = 0;  ///< the store's when words and classes were begun
};

/// Share of a cloud's points, 0 to 1, in stretches whose box a cube of a tenth of each side meets, on average of
/// all places within the bounds.
double shareOfTenth(const BlockBoxes& boxes, const RawBounds& bounds) noexcept;

}  // namespace punctum::render
