// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/FormatPlan.h"
#include "core/las/WritePlan.h"

#include <optional>
#include <string>

namespace punctum::las
{

struct WrittenChunks;

/// Decides whether what is written has the source's octree (WritePlan::copc), and brings the times in its first
/// record up to date, where they changed. Otherwise takes the records of COPC out, with a note that says why.
/// Throws Cancelled.
void planCopc(const PointCloud& cloud, const PlannedPoints& points, const FormatPlan& format,
              const WriteOptions& options, Progress& progress, WritePlan& plan);

/// What a node's entry says now (COPC 1.0, "hierarchy VLR"), and where the pages are, in the plan's prefix and
/// records; after the other records are as they will be written.
void setCopcPlaces(const WrittenChunks& written, WritePlan& plan);

/// The octree of what is written, with the points of each node; null where it has none.
std::shared_ptr<const CopcIndex> plannedCopc(const WritePlan& plan);

}  // namespace punctum::las
