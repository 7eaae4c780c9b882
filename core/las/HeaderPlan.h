// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/FieldPlan.h"
#include "core/las/WritePlan.h"

namespace punctum::las
{

/// Makes the plan's prefix: header, records and gap, as the file begins. Figures of the points are computed, and
/// written where they differ from those read; the signature where anything of the record or the points changed.
/// Throws Error when the records do not fit before the points; Cancelled.
void planHeader(const PointCloud& cloud, const PlannedPoints& points, const FormatPlan& format,
                const FieldPlan& fields, const std::filesystem::path& target, Progress& progress, WritePlan& plan);

/// Appends a record as it is in a file.
void putVlr(std::vector<std::byte>& bytes, const Vlr& vlr);

}  // namespace punctum::las
