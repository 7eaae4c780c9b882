// SPDX-License-Identifier: MIT
#pragma once

#include "core/process/Step.h"

namespace punctum
{

/// reclassify attribute=NAME min=A max=B class=C: the class of all points whose value lies from A to B.
///
/// A rule (expression::Rule) with a form of its own. The range includes its ends; no-data and NaN are never in it.
/// Whole numbers are compared exactly; bounds of scaled integers (Z, scan angle) are taken to the nearest step when
/// they are within a millionth of it, so that max=410.5 includes what the file stores as 41050.
class ReclassifyStep final : public Step
{
public:
    const StepDescription& description() const override;

private:
    std::unique_ptr<Command> make(const PointCloud& cloud, const StepValues& values, const PointSet* within,
                                  Progress& progress) const override;
};

}  // namespace punctum
