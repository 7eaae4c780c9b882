// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/PointFormat.h"

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace punctum
{
class Progress;
}

namespace punctum::las
{

struct SourceFile;

/// Oldest LAS 1.x that has the point format (LAS 1.4 R15, table 1).
std::uint8_t oldestMinor(std::uint8_t format) noexcept;

/// The columns that hold what formats 0-5 and 6-10 pack in different ways; null where the cloud has none.
struct PackedColumns {
    std::shared_ptr<const Column> returns;
    std::shared_ptr<const Column> flags;    ///< "Flags", in formats 0-5 "Classes"
    std::shared_ptr<const Column> classes;  ///< "Classification"; in formats 0-5 only where an edit widened it
    std::shared_ptr<const Column> angle;
    bool extended = false;  ///< packed as in formats 6-10
};

/// Those of a cloud whose record is of this source's format.
PackedColumns packedColumns(const PointCloud& cloud, const SourceFile& source);
std::shared_ptr<const Column> findColumn(const PointCloud& cloud, std::string_view name);

/// What the points hold that their format has no place for.
struct FormatNeeds {
    bool extended = false;  ///< a class above 31
    bool gps = false;       ///< fields of the standard that were added as columns of their types
    bool color = false;
    bool nir = false;
    std::vector<std::string> reasons;  ///< "12 points have a class above 31"

    /// The format nearest to `format` that holds all of it and loses nothing else.
    std::uint8_t formatFor(std::uint8_t format) const noexcept;
};

/// Looks at the columns that came after loading, and at widened classes of the points in `kept`. Throws Cancelled.
FormatNeeds findNeeds(const PointCloud& cloud, const SourceFile& source, const std::vector<PointRange>& kept,
                      Progress& progress);

/// What of these points is lost in format `to`: "Point format 3 cannot hold these points: 34 points have a class
/// above 31." Empty when nothing is. Throws Cancelled.
std::string findLosses(const PointCloud& cloud, const SourceFile& source, const std::vector<PointRange>& kept,
                       std::uint8_t to, Progress& progress);

}  // namespace punctum::las
