// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Attribute.h"
#include "core/cloud/PointSet.h"

#include <memory>
#include <vector>

namespace punctum
{

/// How a cloud would look after a change that has not been made, and may never be: nothing of it is in the cloud.
/// Immutable once it is shared.
struct Preview {
    std::shared_ptr<const PointSet> points;  ///< that would change; not empty
    /// The one that would change, then those that show it together with others (RGB where Red would), with a column
    /// of their own that holds the values of all points after the change.
    std::vector<Attribute> attributes;
};

}  // namespace punctum
