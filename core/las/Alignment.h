// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/KeptPoints.h"

#include <optional>

namespace punctum
{
class Progress;
}

namespace punctum::las
{

class Reader;

/// Of two files, the points of the longer one that the shorter one holds, in the same order: what is left after
/// some were deleted. Nothing when they have the same number, or the shorter one is no such part of the longer one.
///
/// Points are the same when their records are, else (as values were edited, too) when coordinates and GPS time are.
/// Reads both files, up to twice; memory: 8 bytes a point of each. Throws Error and Cancelled.
std::optional<KeptPoints> partOf(const Reader& longer, const Reader& shorter, Progress& progress);

}  // namespace punctum::las
