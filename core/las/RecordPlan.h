// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/FieldPlan.h"
#include "core/las/WritePlan.h"

namespace punctum::las
{

/// Puts the records beside the points into the plan, which has the source's: descriptors of extra bytes where
/// attributes came or went, ranges where edits changed them, what is said of compression, and what the version has
/// no place for. Chunks, too. Throws Error when a record does not fit; Cancelled.
void planRecords(const PointCloud& cloud, const PlannedPoints& points, const FormatPlan& format, FieldPlan& fields,
                 const WriteOptions& options, const std::filesystem::path& target, Progress& progress,
                 WritePlan& plan);

inline constexpr const char* kLaxLeftOut =
    "The LAX spatial index is left out: it belongs to the old compressed file.";
/// LAStools' spatial index in a record.
bool isLax(const Vlr& vlr);

}  // namespace punctum::las
