// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointSet.h"

#include <functional>
#include <map>
#include <memory>
#include <string>

namespace punctum
{

/// What a command was made from, and can be made from again on the same points: a processing step (core/steps),
/// its values, and the points that it may change. What a journal keeps.
struct Recipe {
    std::string step;  ///< "set", "normals", ...
    std::map<std::string, std::string, std::less<>> values;
    std::shared_ptr<const PointSet> within;  ///< null: all points; not every step can do with some
};

}  // namespace punctum
