// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointSet.h"

#include <string>

namespace punctum
{

/// An attribute, and how many points have another value of it than before.
struct AttributeChange {
    std::string attribute;
    PointIndex points = 0;
    friend bool operator==(const AttributeChange&, const AttributeChange&) = default;
};

}  // namespace punctum
