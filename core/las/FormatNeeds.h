// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/Loss.h"
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

/// Newest LAS 1.x that is written.
constexpr std::uint8_t kNewestMinor = 5;
/// Oldest LAS 1.x that has the point format (LAS 1.4 R15, table 1), and the newest (LAS 1.5, 2.3).
std::uint8_t oldestMinor(std::uint8_t format) noexcept;
std::uint8_t newestMinor(std::uint8_t format) noexcept;
/// The point format nearest to this one that LAS 1.minor has (minor: 2 and more).
std::uint8_t formatIn(std::uint8_t format, std::uint8_t minor) noexcept;

/// What formats 0-5 write where a record of the formats 6-10 says more (las.md, "A way down").
constexpr std::uint8_t kHighestOldClass = 31, kUnclassified = 1, kMostOldReturns = 7;

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

/// What of these points is lost in format `to` of LAS 1.minor, by kinds. Throws Cancelled.
std::vector<Loss> findLosses(const PointCloud& cloud, const SourceFile& source, const std::vector<PointRange>& kept,
                             std::uint8_t to, Progress& progress);

}  // namespace punctum::las
