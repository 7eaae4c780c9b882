// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"

#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace punctum
{
class Progress;
}

namespace punctum::las
{

struct Header;

/// What the numbers of GPS times are (LAS 1.5, table 4; before 1.5 there is no Offset).
enum class GpsClock {
    Week,      ///< seconds since the beginning of the week
    Adjusted,  ///< seconds since January 6, 1980, less 1e9
    Offset,    ///< seconds since January 6, 1980, less the header's time offset times 1e6
};

GpsClock gpsClock(const Header& header) noexcept;
/// In words: "seconds of the week", "GPS seconds - 1,000,000,000", "GPS seconds - 1,355,000,000 (offset 1355)".
std::string gpsClockText(const Header& header);

/// Lowest and highest GPS time that is not 0 (LAS 1.5, 2.3: 0 says that there is none); both 0 when there is none.
struct GpsRange {
    double min = 0.0;
    double max = 0.0;

    bool empty() const noexcept { return min == 0.0 && max == 0.0; }
    void include(double time) noexcept;  ///< 0 and NaN do not count
    void include(const GpsRange& other) noexcept;
    friend bool operator==(const GpsRange&, const GpsRange&) = default;
};

/// Lowest and highest GPS time, 0 among them ("Minimum of GPSTime", COPC 1.0, "info VLR").
struct TimeExtent {
    double min = std::numeric_limits<double>::infinity();
    double max = -std::numeric_limits<double>::infinity();

    bool empty() const noexcept { return min > max; }
    void include(std::span<const double> times) noexcept;  ///< NaN does not count
    void include(const TimeExtent& other) noexcept;
    friend bool operator==(const TimeExtent&, const TimeExtent&) = default;
};

/// Of the points in `points`. Throws Cancelled.
TimeExtent timeExtent(const PointCloud& cloud, const std::vector<PointRange>& points, Progress& progress);

/// Of the points in `points`; empty for clouds without GPS times. Throws Cancelled.
GpsRange gpsRange(const PointCloud& cloud, const std::vector<PointRange>& points, Progress& progress);

/// GPS times of all points plus so many seconds; 0, which says that there is none, stays. `rounded`: how many of
/// those in `points` are no longer exact. Throws Cancelled.
std::shared_ptr<const Column> shiftedTimes(const Column& times, double seconds,
                                           const std::vector<PointRange>& points, std::uint64_t& rounded,
                                           Progress& progress);

}  // namespace punctum::las
