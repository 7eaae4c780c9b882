// SPDX-License-Identifier: MIT
#pragma once

#include "core/raster/MapLines.h"

#include <vector>

namespace punctum
{

class Progress;

/// Simplifies lines that do not cross, each by `tolerance` (simplified()), so that they still do not: those of
/// which two segments would cross or touch get all their points back. `cell`: a length that most segments are of.
/// In parallel, the same on any number of threads. Throws Cancelled.
void simplifyApart(std::vector<ContourLine>& lines, double tolerance, double cell, Progress& progress);

/// For each line whether one of its segments crosses or touches one of another line, or one of its own that is not
/// the next.
std::vector<bool> crossingLines(const std::vector<ContourLine>& lines, double cell, Progress& progress);

}  // namespace punctum
