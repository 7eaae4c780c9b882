// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/Difference.h"

namespace punctum::las
{

struct SourceFile;

/// Compares what two files hold besides their points, into the header, records, bytes and container parts of
/// `difference`.
///
/// Positions in the file (of points, EVLRs, the waveform record), the laszip record and the bit for compression
/// follow from how the points are stored and count as container, as long as they mean the same place.
void compareSources(const SourceFile& a, const SourceFile& b, Difference& difference);

}  // namespace punctum::las
