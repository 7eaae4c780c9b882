// SPDX-License-Identifier: MIT
#pragma once

#include "app/Console.h"
#include "core/cloud/PointCloud.h"
#include "core/las/Doctor.h"
#include "core/las/Reader.h"

#include <memory>
#include <string>
#include <vector>

namespace punctum::app
{

/// A file and the figures of its points: what `punctum info` tells.
struct FileInfo {
    std::string file;
    std::shared_ptr<PointCloud> cloud;
    las::ReadResult result;
    las::Examination examination;
    WorldBounds bounds;
    std::vector<std::vector<AttributeStatistics>> statistics;  ///< by attribute, then component; opaque: none

    const las::SourceFile& source() const { return *cloud->source(); }
    const PointFigures& figures() const { return examination.figures; }
};

/// Reads the file and computes all of it. Throws Error, Cancelled.
FileInfo inspect(const std::string& file, Progress& progress);

/// The keys are told in docs/user.md.
Json jsonOf(const FileInfo& info);
std::string textOf(const FileInfo& info);

/// A list of what the doctor found: {"fault", "mend", "repairable"}.
Json findingsJson(const std::vector<las::Finding>& findings);
/// Two lines each, indented.
std::string findingsText(const std::vector<las::Finding>& findings);

}  // namespace punctum::app
