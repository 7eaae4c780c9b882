// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"
#include "core/process/StepParameter.h"
#include "core/process/Values.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace punctum
{

/// count= and percent=: how many points are to be kept.
inline void addWantedNumber(std::vector<StepParameter>& parameters)
{
    parameters.push_back({.key = "count",
                          .label = "Number",
                          .help = "How many points are kept, exactly; instead of a share of them.",
                          .type = StepParameter::Type::Integer,
                          .min = 0,
                          .max = 4294967295.0,
                          .optional = true});
    parameters.push_back({.key = "percent",
                          .label = "Share",
                          .help = "How many of the points are kept, where no number is given.",
                          .preset = "10",
                          .min = 0,
                          .max = 100,
                          .unit = StepParameter::Unit::PerCent});
}

/// Of the points that are not left out; no more than there are.
inline PointIndex wantedNumber(const StepValues& values, const PointCloud& cloud, const PointSet* leftOut)
{
    const PointIndex all = cloud.size() - (leftOut == nullptr ? 0 : leftOut->count());
    if (const auto count = integerValue(values, "count")) return std::min(all, PointIndex(*count));
    return std::min(all, PointIndex(std::llround(double(all) * *realValue(values, "percent") / 100)));
}

}  // namespace punctum
