// SPDX-License-Identifier: MIT
#include "core/las/GpsTime.h"

#include "core/Text.h"
#include "core/las/FormatNeeds.h"
#include "core/las/Header.h"
#include "core/las/Parallel.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace punctum::las
{

namespace
{

const double* timesOf(const Column& column)
{
    return reinterpret_cast<const double*>(column.data());
}

struct Rounded {
    std::uint64_t count = 0;
    void include(const Rounded& other) noexcept { count += other.count; }
};

}  // namespace

GpsClock gpsClock(const Header& header) noexcept
{
    if (!header.says(encoding::kAdjustedGpsTime)) return GpsClock::Week;
    const bool offset = header.versionMinor() >= 5 && header.says(encoding::kTimeOffset);
    return offset ? GpsClock::Offset : GpsClock::Adjusted;
}

std::string gpsClockText(const Header& header)
{
    switch (gpsClock(header)) {
        case GpsClock::Week:
            return "seconds of the week";
        case GpsClock::Adjusted:
            return "GPS seconds - 1,000,000,000";
        case GpsClock::Offset:
            break;
    }
    const std::uint64_t offset = header.get(at::kTimeOffset);
    return "GPS seconds - " + grouped(offset * 1'000'000) + " (offset " + std::to_string(offset) + ")";
}

void GpsRange::include(double time) noexcept
{
    if (time == 0.0 || std::isnan(time)) return;
    if (empty()) {
        min = max = time;
    } else {
        min = std::min(min, time);
        max = std::max(max, time);
    }
}

void GpsRange::include(const GpsRange& other) noexcept
{
    include(other.min);
    include(other.max);
}

void TimeExtent::include(std::span<const double> times) noexcept
{
    for (const double t : times) {
        if (t < min) min = t;
        if (t > max) max = t;
    }
}

void TimeExtent::include(const TimeExtent& other) noexcept
{
    min = std::min(min, other.min);
    max = std::max(max, other.max);
}

TimeExtent timeExtent(const PointCloud& cloud, const std::vector<PointRange>& points, Progress& progress)
{
    const auto times = findColumn(cloud, "GpsTime");
    if (times == nullptr || times->type() != ScalarType::F64 || times->components() != 1) return {};
    return reducePoints<TimeExtent>(points, progress, [&](TimeExtent& all, PointRange r) {
        all.include({timesOf(*times) + r.first, std::size_t(r.size())});
    });
}

GpsRange gpsRange(const PointCloud& cloud, const std::vector<PointRange>& points, Progress& progress)
{
    const auto times = findColumn(cloud, "GpsTime");
    if (times == nullptr || times->type() != ScalarType::F64 || times->components() != 1) return {};
    return reducePoints<GpsRange>(points, progress, [&](GpsRange& all, PointRange r) {
        const double* const t = timesOf(*times);
        for (PointIndex i = r.first; i < r.last; ++i) all.include(t[i]);
    });
}

std::shared_ptr<const Column> shiftedTimes(const Column& times, double seconds,
                                           const std::vector<PointRange>& points, std::uint64_t& rounded,
                                           Progress& progress)
{
    auto shifted = std::make_shared<Column>(times.name(), times.type(), times.size());
    auto* const out = reinterpret_cast<double*>(shifted->data());
    const double* const in = timesOf(times);
    rounded = reducePoints<Rounded>(points, progress, [&](Rounded& all, PointRange r) {
                  for (PointIndex i = r.first; i < r.last; ++i) {
                      out[i] = in[i] == 0.0 || std::isnan(in[i]) ? in[i] : in[i] + seconds;
                      all.count += out[i] != in[i] && out[i] - seconds != in[i] ? 1 : 0;
                  }
              }).count;
    return shifted;
}

}  // namespace punctum::las
