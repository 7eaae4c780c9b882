// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointSet.h"
#include "core/cloud/Visibility.h"

#include <bitset>
#include <memory>
#include <string>

namespace punctum
{

class PointCloud;
class Progress;

/// Which points a step may change, as a person says it; points of locked classes are left out in any case.
struct StepScope {
    enum class Kind { All, Selection, Classes, Condition, Shown };
    Kind kind = Kind::All;
    std::shared_ptr<const PointSet> selection{};  ///< null: none is selected
    std::bitset<256> classes{};
    std::string condition{};
    Visibility visibility{};  ///< of what is shown
    std::bitset<256> locked{};
};

/// Those points, without deleted ones; null: all there are. Parallel; takes cloud.mutex() shared for some 20 ms at
/// a time. Throws Error (a condition that does not fit, classes that the cloud lacks), and Cancelled.
std::shared_ptr<const PointSet> pointsOf(const StepScope& scope, const PointCloud& cloud, Progress& progress);

/// The condition that says the same of any cloud, without locked classes; empty: all. Throws Error where none does.
std::string conditionOf(const StepScope& scope);

}  // namespace punctum
