// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Buffer.h"
#include "core/cloud/PointCloud.h"
#include "render/order/SlotOrder.h"
#include "render/store/AttributeEncoder.h"
#include "render/store/LocalFrame.h"

namespace punctum::render
{

/// What is drawn of points, by slots.
struct SlotArrays {
    Buffer positions;  ///< LocalPosition
    Buffer words;      ///< std::uint32_t, see AttributeEncoder
    Buffer classes;    ///< std::uint8_t

    SlotArrays() = default;
    /// All empty. Throws Error (memory).
    explicit SlotArrays(Slot count)
        : positions(std::size_t(count) * sizeof(LocalPosition), BufferUse::Drawing),
          words(std::size_t(count) * sizeof(std::uint32_t), BufferUse::Drawing),
          classes(count, BufferUse::Drawing)
    {
    }
};

/// What came to light meanwhile.
struct Dealt {
    std::size_t colorsCut = 0;  ///< points whose color is brighter than the encoder holds
    bool inside = true;         ///< all points are inside the frame; those outside got empty slots
};

/// Takes the points at some places of an order from the cloud's columns, and puts them into their slots: words,
/// classes (where `classes` has a column), and positions, unless `frame` is null. Of a stratified order into the
/// first `windows` alone. Any thread, several at a time for
/// different places. What was written is there for others once this has returned.
Dealt dealOut(const PointCloud& cloud, PointRange places, const AttributeEncoder& encoder, const Attribute& classes,
              SlotArrays& arrays, const SlotOrder& order, const LocalFrame* frame,
              std::uint32_t windows = UINT32_MAX);

}  // namespace punctum::render
