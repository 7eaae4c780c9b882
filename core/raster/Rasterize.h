// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"
#include "core/raster/Raster.h"

#include <optional>
#include <string>
#include <string_view>

namespace punctum
{

class Progress;

/// What is told of the values that fall into a cell.
struct Statistic {
    enum class Kind {
        Min,
        Max,
        Mean,
        StandardDeviation,  ///< of all values there are (not of a sample)
        Range,              ///< max - min
        Sum,
        Count,
        Majority,   ///< the most frequent value; of several the least
        Percentile  ///< `percent` of them are below, linear between two values; 50: the median
    };
    Kind kind = Kind::Max;
    double percent = 50.0;
    friend bool operator==(const Statistic&, const Statistic&) = default;
};

/// "max", "median", "p95"; nothing for other words.
std::optional<Statistic> parseStatistic(std::string_view word);
/// All words, but for the percentiles "p0" to "p100".
inline constexpr std::string_view kStatisticWords[] = {"min",   "max", "mean",  "median",  "stddev",
                                                       "range", "sum", "count", "majority"};

/// One number for each cell, of the values that an attribute's first component has at the points in it: in
/// parallel, the same on any number of threads and in whatever order the points come. Points without a value,
/// deleted ones and those not in `points` (null: all) are left out. Of Count, cells without points are 0, of all
/// else NaN.
///
/// Points are taken piece by piece of the map, some 100 MB at a time beyond the map itself. Holds cloud.mutex()
/// shared for some ms at a time. Throws Cancelled, Error.
Raster rasterize(const PointCloud& cloud, const Attribute& attribute, const Statistic& statistic,
                 const RasterFrame& frame, const PointSet* points, Progress& progress);

/// The box, in `world`, of the points that are there: not deleted, and in `points` (null: all). Empty when there
/// are none. Throws Cancelled.
WorldBounds boundsOfPoints(const PointCloud& cloud, const PointSet* points, Progress& progress);

}  // namespace punctum
