// SPDX-License-Identifier: MIT
#pragma once

#include "core/neighbors/Neighbors.h"
#include "core/process/Values.h"

#include <string>
#include <vector>

namespace punctum
{

/// Steps that look at the k nearest points or, where `radius` is given, at all points within it, have these two
/// parameters first.
inline std::vector<StepParameter> kOrRadiusParameters(std::string helpOfK, std::string helpOfRadius,
                                                      std::vector<StepParameter> others)
{
    std::vector<StepParameter> all{{.key = "k",
                                    .label = "Neighbors",
                                    .help = std::move(helpOfK),
                                    .type = StepParameter::Type::Integer,
                                    .preset = "16",
                                    .min = 3,
                                    .max = 1000},
                                   {.key = "radius",
                                    .label = "Radius",
                                    .help = std::move(helpOfRadius),
                                    .min = 1e-9,
                                    .max = 1e9,
                                    .optional = true,
                                    .unit = StepParameter::Unit::Length}};
    all.insert(all.end(), others.begin(), others.end());
    return all;
}

/// forEachNearest() or forEachWithin(), as their values say.
inline void forEachByKOrRadius(const KdOrder& order, const StepValues& values, const std::string& stage,
                               Progress& progress, const NeighborVisitor& visit, const PointSet* within)
{
    if (const auto radius = realValue(values, "radius"))
        forEachWithin(order, *radius, stage, progress, visit, within);
    else
        forEachNearest(order, std::size_t(*integerValue(values, "k")), stage, progress, visit, within);
}

}  // namespace punctum
