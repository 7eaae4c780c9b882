// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointSet.h"
#include "core/process/FilledAttribute.h"

#include <cstddef>
#include <cstdint>

namespace punctum
{

class Progress;

/// The number of the first of `objects` that a step found and numbers in a row: 1; where it changes points of
/// `within` alone, one more than the highest number that the others keep, so that no two objects have the same.
/// `ids`: before the step set any. Throws Cancelled, and Error where the attribute cannot hold the last number.
std::uint32_t firstNumber(const FilledAttribute& ids, std::size_t objects, const PointSet* within,
                          Progress& progress);

}  // namespace punctum
