// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"
#include "core/las/ExtraBytes.h"

#include <vector>

namespace punctum
{
class Progress;
}

namespace punctum::las
{

struct SourceFile;

/// The ranges that the source's descriptors state (options bits 1 and 2), computed from the columns for the points
/// in `points`; NaN and the no-data value left out. Items whose columns are gone or of another type are left out;
/// nothing to do, and nothing done, for files that state none. Throws Cancelled.
std::vector<ExtraBytesRange> extraBytesRanges(const PointCloud& cloud, const SourceFile& source,
                                              const std::vector<PointRange>& points, Progress& progress);

/// Writes a range into the 192 bytes of a descriptor, as far as its options state one.
void setRange(std::byte* descriptor, const ExtraBytesRange& range);

}  // namespace punctum::las
