// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Attribute.h"
#include "core/cloud/PointSet.h"

#include <memory>
#include <string>
#include <vector>

namespace punctum
{

/// How a cloud would look after a change that has not been made, and may never be: nothing of it is in the cloud.
/// Immutable once it is shared.
struct Preview {
    std::shared_ptr<const PointSet> points;  ///< that would change; not empty
    /// Those that would change, the one that is meant first, then those that show them together with others (RGB
    /// where Red would), with a column of their own that holds the values of all points after the change. None
    /// where points are deleted.
    std::vector<Attribute> attributes;
    /// Which of them is to be seen where a view shows none of them, such as one that is new; empty: classes, or
    /// else the points are marked.
    std::string shows{};
};

}  // namespace punctum
