// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Attribute.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace punctum
{

/// One of the values that an attribute has.
struct DistinctValue {
    std::uint32_t bits = 0;  ///< as Attribute::gatherBits() tells it, which colors go by
    Value value;             ///< of one of the points
    std::uint64_t points = 0;
};

/// The values that an attribute has, rising.
struct DistinctValues {
    std::vector<DistinctValue> values;
    bool tooMany = false;  ///< more than were asked for: there are none in the list then
};

/// The different values of a whole-number attribute of one component, if they are `most` at most; those of
/// `leftOut` (null: none) are not counted. In parallel. The caller holds the cloud's mutex() shared. Throws
/// Cancelled.
DistinctValues distinctValues(const Attribute& attribute, std::size_t most, Progress& progress,
                              const PointSet* leftOut = nullptr);

}  // namespace punctum
