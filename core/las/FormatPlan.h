// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/KeptPoints.h"
#include "core/las/SourceFile.h"
#include "core/las/Writer.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace punctum
{
class Progress;
}

namespace punctum::las
{

/// The points that a save writes, and the file that they came from.
struct PlannedPoints {
    std::shared_ptr<const SourceFile> source;  ///< the cloud's, or one that holds the fields of a cloud made here
    PointsAsRead read;
    bool made = false;  ///< the cloud was made here
    KeptPoints kept;
};

/// Leaves out what could not be read and what was deleted, with notes. Throws Error where that would be lost.
PlannedPoints planPoints(const PointCloud& cloud, const std::filesystem::path& target,
                         std::vector<std::string>& notes);

/// The point format and version that are written.
struct FormatPlan {
    std::uint8_t format = 0, minor = 0;
    bool changed = false;   ///< from the source's
    bool upgraded = false;  ///< without being asked for, since the source's cannot hold what is there
};

/// Throws Error when there is no such format or version; WriteQuestion when the source's cannot hold the points
/// and the options do not say that it may change; Cancelled.
FormatPlan planFormat(const PointCloud& cloud, const PlannedPoints& points, const std::filesystem::path& target,
                      const WriteOptions& options, Progress& progress, std::vector<std::string>& notes);

}  // namespace punctum::las
