// SPDX-License-Identifier: MIT
#include "core/las/HeaderPlan.h"

#include "core/Error.h"
#include "core/Text.h"
#include "core/cloud/LeastMost.h"
#include "core/las/ChunkCodec.h"
#include "core/las/Compatible.h"
#include "core/las/CrsPlan.h"
#include "core/las/GpsTime.h"
#include "core/las/Parallel.h"

#include <algorithm>
#include <utility>

namespace punctum::las
{

namespace
{

/// Extent and returns of the points that are written.
struct Summary {
    RawBounds bounds;
    std::array<std::uint64_t, 16> byReturn{};

    void include(const Summary& o)
    {
        bounds.include(o.bounds);
        for (std::size_t k = 0; k < 16; ++k) byReturn[k] += o.byReturn[k];
    }
};

/// Appends a value's bytes.
template <typename T>
void put(std::vector<std::byte>& bytes, const T& value)
{
    const auto* p = reinterpret_cast<const std::byte*>(&value);
    bytes.insert(bytes.end(), p, p + sizeof(T));
}

void resizeHeader(Header& header, std::uint8_t minor, const std::filesystem::path& target, WritePlan& plan)
{
    const std::uint8_t before = header.versionMinor();
    if (before == minor) return;
    std::vector<std::byte>& b = header.bytes;
    const std::size_t standard = header.standardEnd();
    std::vector<std::byte> user(b.begin() + std::ptrdiff_t(standard), b.end());
    if (minor >= 5 && !user.empty()) {  // "may not be extended by users": LAS 1.5, 2.3
        plan.userBytes = std::exchange(user, {});
        plan.note("The " + grouped(plan.userBytes.size()) +
                  " bytes after the header, which LAS 1.5 allows no longer, are kept before the points.");
    }
    b.resize(standard);
    b.resize(standardHeaderSize(minor));
    b.insert(b.end(), user.begin(), user.end());
    if (b.size() > UINT16_MAX)
        throw Error(target, "The header has too many user bytes for LAS 1." + std::to_string(minor) + ".");
    header.set(at::kHeaderSize, std::uint16_t(b.size()));
    header.set(at::kVersionMinor, minor);
    if (before < 2) header.set(at::kGlobalEncoding, 0);  // was a reserved field
}

Summary summarize(const PointCloud& cloud, const PlannedPoints& points, Progress& progress)
{
    const RecordLayout& from = points.source->layout;
    const auto returns =
        from.compatible ? findColumn(cloud, from.derived.front().column) : findColumn(cloud, "Returns");
    const std::uint8_t mask = isExtendedFormat(from.shownFormat()) ? 15 : 7;
    return reducePoints<Summary>(points.kept.ranges(), progress, [&](Summary& s, PointRange r) {
        const std::int32_t* axes[] = {cloud.rawX().data(), cloud.rawY().data(), cloud.rawZ().data()};
        std::int32_t low[3], high[3];
        for (int a = 0; a < 3; ++a) {
            const LeastMost part = leastAndMost(axes[a] + r.first, std::size_t(r.size()));
            low[a] = part.least;
            high[a] = part.most;
        }
        s.bounds.include(low[0], low[1], low[2]);
        s.bounds.include(high[0], high[1], high[2]);
        if (returns == nullptr) return;
        const auto* p = reinterpret_cast<const std::uint8_t*>(returns->data());
        for (PointIndex i = r.first; i < r.last; ++i) ++s.byReturn[p[i] & mask];
    });
}

bool headerCountIs(const Header& h, std::uint64_t points)
{
    const auto legacy = h.get(at::kLegacyCount);
    if (!h.extendedCounts()) return legacy == points;
    // a legacy count of 0 says nothing there
    return h.get(at::kPointCount) == points || (legacy == points && legacy != 0);
}

void setCounts(Header& header, std::uint8_t format, std::uint64_t points, const Summary& now)
{
    const bool legacy = !isExtendedFormat(format) && points <= UINT32_MAX;
    header.set(at::kLegacyCount, legacy ? std::uint32_t(points) : 0u);
    for (std::size_t k = 0; k < 5; ++k)
        header.set(at::kLegacyByReturn[k], legacy ? std::uint32_t(now.byReturn[k + 1]) : 0u);
    if (!header.extendedCounts()) return;
    header.set(at::kPointCount, points);
    for (std::size_t k = 0; k < 15; ++k) header.set(at::kByReturn[k], now.byReturn[k + 1]);
}

void setBounds(Header& header, const CoordinateScale& coordinates, const RawBounds& raw)
{
    const WorldBounds b = raw.empty() ? WorldBounds{glm::dvec3(0), glm::dvec3(0)} : coordinates.headerBox(raw);
    for (std::size_t k = 0; k < 3; ++k) {
        // The header's own scale may be unusable; then its box means nothing, and stays.
        if (header.get(at::kScale[k]) != coordinates.scale[int(k)]) continue;
        header.set(at::kMax[k], b.max[int(k)]);
        header.set(at::kMin[k], b.min[int(k)]);
    }
}

/// Figures of the points; whether any of them changed. `header`: of the format that is written.
bool setFigures(const PointCloud& cloud, const PlannedPoints& points, const FormatPlan& format, Header& header,
                Progress& progress, WritePlan& plan)
{
    const SourceFile& source = *points.source;
    const PointsAsRead& read = points.read;
    const PointIndex count = points.kept.count();
    const Summary now = summarize(cloud, points, progress);
    bool changed = points.made || !read.complete || count != source.pointCount || now.bounds != read.bounds ||
                   now.byReturn != read.byReturn || !headerCountIs(source.header, count);
    const std::uint8_t minor = format.minor, before = source.header.versionMinor();
    const bool moved = (minor >= 4) != (before >= 4) || (minor >= 5) != (before >= 5) ||
                       isExtendedFormat(format.format) != isExtendedFormat(source.layout.format);
    if (changed || moved) setCounts(header, format.format, count, now);
    if (const std::uint64_t beyond = now.byReturn[6] + now.byReturn[7]; moved && minor < 4 && beyond != 0)
        plan.note(pointsText(beyond) + " of the sixth and seventh return " + (beyond == 1 ? "is" : "are") +
                  " not in the header's counts by return, which end at the fifth.");
    if (changed && source.layout.compatible)
        for (auto* list : {&plan.vlrs, &plan.evlrs})
            for (Vlr& vlr : *list)
                if (vlr.is(kCompatibleUser, kCompatibleRecordId)) setCompatibleCounts(vlr, count, now.byReturn);
    if (changed) setBounds(header, source.coordinates, now.bounds);
    if (minor >= 5) {
        const GpsRange gps = gpsRange(cloud, points.kept.ranges(), progress);
        if (points.made || !read.complete || before < 5 || gps != read.gps) {
            header.set(at::kMaxGpsTime, gps.max);
            header.set(at::kMinGpsTime, gps.min);
            changed = true;
        }
    }
    const bool otherPoints = count != source.pointCount || now.bounds != read.bounds;
    if (!points.made && read.complete && otherPoints &&
        plan.dropRecords([](const Vlr& v) { return v.is("LAStools", 10) || v.is("LAStools", 20); }) != 0)
        plan.note("LAStools' records on the tile that the points were are left out: they are other points now.");
    return changed;
}

/// LAS 1.3 has nothing but the header's position for its one extended record: where that is not there, a
/// position kept would make the new file a damaged one as well.
void forgetLostWaveforms(Header& header, const SourceFile& source, std::uint8_t minor, WritePlan& plan)
{
    if (minor != 3 || !source.recovered || plan.waveformEvlr || header.get(at::kWaveformStart) == 0 ||
        !header.says(encoding::kInternalWaveform))
        return;
    header.set(at::kWaveformStart, std::uint64_t(0));
    plan.note("The waveforms, which could not be read, are left out.");
}

}  // namespace

void putVlr(std::vector<std::byte>& bytes, const Vlr& vlr)
{
    put(bytes, vlr.reserved);
    put(bytes, vlr.userId);
    put(bytes, vlr.recordId);
    if (vlr.extended)
        put(bytes, std::uint64_t(vlr.data.size()));
    else
        put(bytes, std::uint16_t(vlr.data.size()));
    put(bytes, vlr.description);
    bytes.insert(bytes.end(), vlr.data.begin(), vlr.data.end());
}

void planHeader(const PointCloud& cloud, const PlannedPoints& points, const FormatPlan& format,
                const FieldPlan& fields, const std::filesystem::path& target, Progress& progress, WritePlan& plan)
{
    const SourceFile& source = *points.source;
    Header header = source.header;
    resizeHeader(header, format.minor, target, plan);
    planCrs(plan, source, format.format, format.minor, header);
    if (hasWaveform(source.layout.format) && !hasWaveform(format.format))
        header.set(at::kGlobalEncoding, header.globalEncoding() & std::uint16_t(~(encoding::kInternalWaveform |
                                                                                  encoding::kExternalWaveform)));
    const bool figures = setFigures(cloud, points, format, header, progress, plan);
    if (figures || format.changed || !fields.extra.unchanged()) {  // the file is no longer its maker's
        header.setText(at::kSoftware, "Punctum");
        header.setCreation();
    }
    if (const auto announced = header.get(at::kVlrCount); !points.made && announced != source.vlrs.size())
        plan.note("The header announced " + grouped(announced) +
                  " variable length records; it says now how many there are.");
    header.set(at::kVlrCount, std::uint32_t(plan.vlrs.size()));
    header.set(at::kPointFormat, std::uint8_t(format.format | (plan.compressed ? 0x80 : 0)));
    header.set(at::kRecordLength, fields.layout.length);

    forgetLostWaveforms(header, source, format.minor, plan);
    std::uint64_t offset = header.bytes.size();
    for (const Vlr& vlr : plan.vlrs) offset += vlr.bytesInFile();
    offset += plan.userBytes.size() + source.gapBeforePoints.size();
    if (offset > UINT32_MAX)
        throw Error(target, "The records before the points are larger than the 4 GiB that a file can have.");
    header.set(at::kPointOffset, std::uint32_t(offset));

    std::vector<std::byte>& prefix = plan.prefix;
    prefix = header.bytes;
    for (const Vlr& vlr : plan.vlrs) {
        if (isLaszip(vlr)) plan.laszipAt = prefix.size() + Vlr::kHeaderSize;
        putVlr(prefix, vlr);
    }
    prefix.insert(prefix.end(), plan.userBytes.begin(), plan.userBytes.end());
    prefix.insert(prefix.end(), source.gapBeforePoints.begin(), source.gapBeforePoints.end());
}

}  // namespace punctum::las
