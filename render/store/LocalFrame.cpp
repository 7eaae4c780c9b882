// SPDX-License-Identifier: MIT
#include "render/store/LocalFrame.h"

#include <glm/vector_relational.hpp>

#include <algorithm>

namespace punctum::render
{

LocalFrame LocalFrame::around(const RawBounds& bounds) noexcept
{
    LocalFrame frame;
    if (bounds.empty()) {
        frame.origin = glm::i64vec3(-(std::int64_t(1) << 30));
        return frame;
    }
    const glm::i64vec3 size = bounds.max - bounds.min;
    const std::int64_t largest = std::max({size.x, size.y, size.z});
    while ((largest >> frame.shift) > (std::int64_t(1) << 30)) ++frame.shift;
    // Half of the free room below the data: what firstBounds missed mostly still fits.
    frame.origin = bounds.min - (std::int64_t(1) << (29 + frame.shift));
    return frame;
}

bool LocalFrame::holds(const RawBounds& bounds) const noexcept
{
    if (bounds.empty()) return true;
    const glm::i64vec3 low = bounds.min - origin, high = bounds.max - origin;
    const std::int64_t top = std::int64_t(INT32_MAX) << shift;
    return glm::all(glm::greaterThanEqual(low, glm::i64vec3(std::int64_t(1) << shift))) &&
           glm::all(glm::lessThan(high, glm::i64vec3(top)));
}

LocalBox LocalFrame::toLocal(const RawBounds& bounds) const noexcept
{
    LocalBox box;
    if (bounds.empty()) return box;
    for (int axis = 0; axis < 3; ++axis) {
        const auto local = [&](std::int64_t v) {
            return std::int32_t(std::clamp<std::int64_t>((v - origin[axis]) >> shift, INT32_MIN, INT32_MAX));
        };
        box.low[axis] = local(bounds.min[axis]);
        box.high[axis] = local(bounds.max[axis]);
    }
    return box;
}

}  // namespace punctum::render
