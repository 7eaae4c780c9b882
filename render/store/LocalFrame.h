// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"

#include <cstdint>

namespace punctum::render
{

/// Position of a slot: raw LAS integers minus the frame's origin, so that nothing is rounded at any extent.
/// x == 0 marks an empty slot.
struct LocalPosition {
    std::int32_t x = 0, y = 0, z = 0;
};
static_assert(sizeof(LocalPosition) == 12);

/// Smallest box of positions, both ends included.
struct LocalBox {
    glm::ivec3 low{INT32_MAX};
    glm::ivec3 high{INT32_MIN};
    bool empty() const noexcept { return low.x > high.x; }
};

/// `local` integer frame of a store: local = (raw - origin) >> shift, always > 0 for points inside the frame.
/// The origin comes from the data, not from the header's offset. shift is 0 unless the raw extent is above 2^30.
struct LocalFrame {
    glm::i64vec3 origin{0};
    int shift = 0;

    static LocalFrame around(const RawBounds& bounds) noexcept;
    bool holds(const RawBounds& bounds) const noexcept;
    /// Of points inside the frame, each face at the local coordinate of one of them.
    LocalBox toLocal(const RawBounds& bounds) const noexcept;
    glm::dvec3 toRaw(const glm::dvec3& local) const noexcept
    {
        return local * double(1 << shift) + glm::dvec3(origin);
    }
    glm::dvec3 toLocal(const glm::dvec3& raw) const noexcept
    {
        return (raw - glm::dvec3(origin)) / double(1 << shift);
    }
};

}  // namespace punctum::render
