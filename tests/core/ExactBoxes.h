// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/BlockBoxes.h"

namespace punctum
{

/// Whether each stretch's box is that of the coordinates in the columns.
inline bool boxesAreExact(const PointCloud& cloud)
{
    const auto boxes = cloud.boxes();
    if (boxes->size() != (cloud.size() + BlockBoxes::kPoints - 1) / BlockBoxes::kPoints) return false;
    RawBounds all;
    for (std::size_t k = 0; k < boxes->size(); ++k) {
        RawBounds expected;
        const PointRange range = boxes->points(k);
        for (PointIndex i = range.first; i < range.last; ++i)
            expected.include(cloud.rawX()[i], cloud.rawY()[i], cloud.rawZ()[i]);
        if ((*boxes)[k] != expected) return false;
        all.include(expected);
    }
    return boxes->bounds() == all && cloud.computeBounds() == all;
}

}  // namespace punctum
