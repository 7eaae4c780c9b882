// SPDX-License-Identifier: MIT
#include "core/las/WritePlan.h"

#include "core/las/Compatible.h"
#include "core/las/FieldPlan.h"
#include "core/las/FormatNeeds.h"
#include "core/las/FormatPlan.h"
#include "core/las/HeaderPlan.h"
#include "core/las/RecordPlan.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace punctum::las
{

namespace
{

constexpr std::size_t kSpecialCountAt = 16, kSpecialStartAt = 24;  ///< in the laszip record

/// "34 points have a class above 31, which becomes class 1."
std::string sentence(const Loss& loss)
{
    std::string s = loss.text() + (loss.points == 0 ? " " : ", which ") + loss.becomes + ".";
    if (s[0] >= 'a' && s[0] <= 'z') s[0] = char(s[0] - 'a' + 'A');
    return s;
}

/// What the format cannot hold is refused, or told where the options allow it.
void tellLosses(const PointCloud& cloud, const PlannedPoints& points, const FormatPlan& format,
                const std::filesystem::path& target, const WriteOptions& options, Progress& progress,
                WritePlan& plan)
{
    const std::uint8_t from = points.source->layout.format;
    std::vector<Loss>& losses = plan.losses;
    for (Loss& loss : findLosses(cloud, *points.source, points.kept.ranges(), format.format, progress))
        losses.push_back(std::move(loss));
    const std::string what =
        "point format " + std::to_string(format.format) + " of LAS 1." + std::to_string(format.minor);
    if (!losses.empty() && !options.lossy) {
        std::string list;
        for (const Loss& loss : losses) list += (list.empty() ? "" : ", ") + loss.text();
        throw WriteQuestion(WriteQuestion::Kind::Lossy, target,
                            "P" + what.substr(1) + " cannot hold all that is there: " + list + ".", what);
    }
    for (const Loss& loss : losses) plan.note(sentence(loss));
    if (format.format == from) return;
    if (isExtendedFormat(format.format) && !hasGpsTime(from) && findColumn(cloud, "GpsTime") == nullptr)
        plan.note("Point format " + std::to_string(format.format) + " has a GPS time, which is 0 for all points.");
    if (hasNir(format.format) && !hasNir(from) && findColumn(cloud, "NIR") == nullptr)
        plan.note("Point format " + std::to_string(format.format) +
                  " has near infrared, which is 0 for all points.");
}

/// The point format asked for, by itself or by a version that has no form of LASzip's compatibility mode.
std::optional<std::uint8_t> formatAsked(const PointCloud& cloud, const WriteOptions& options)
{
    const auto& source = cloud.source();
    if (!options.pointFormat && source && source->layout.compatible && options.versionMinor.value_or(0) >= 5)
        return source->layout.shownFormat();
    return options.pointFormat;
}

}  // namespace

void WritePlan::setCompression(bool originVersions, bool moved)
{
    std::byte* const payload = prefix.data() + laszipAt;
    if (chunks.allOrNone && !originVersions) std::copy(laz.payload.begin(), laz.payload.end(), payload);
    if (!moved) return;
    std::int64_t special = 0;
    std::memcpy(&special, payload + kSpecialCountAt, sizeof special);
    if (special > 0) {
        special = -1;
        std::memcpy(payload + kSpecialCountAt, &special, sizeof special);
        std::memcpy(payload + kSpecialStartAt, &special, sizeof special);
        notes.push_back(kLaxLeftOut);
    }
    for (std::size_t k = evlrs.size(); k-- > 0;) {
        if (!isLax(evlrs[k])) continue;
        eraseEvlr(k);
        notes.push_back(kLaxLeftOut);
    }
}

void WritePlan::eraseEvlr(std::size_t k)
{
    if (waveformEvlr && *waveformEvlr == k)
        waveformEvlr.reset();
    else if (waveformEvlr && *waveformEvlr > k)
        --*waveformEvlr;
    evlrs.erase(evlrs.begin() + std::ptrdiff_t(k));
}

void WritePlan::setPointDataEnd(std::uint64_t end)
{
    Header h = Header::of(prefix);
    const std::uint64_t evlrStart = end + gapAfterPoints.size();
    // What lies behind the points moves as a whole.
    const auto moved = [&](std::uint64_t before) {
        const bool behind = sourcePointDataEnd != 0 && before >= sourcePointDataEnd;
        return behind ? before - sourcePointDataEnd + end : before;
    };
    if (h.extendedCounts()) {
        const bool some = !evlrs.empty() || h.get(at::kEvlrCount) != 0;
        if (some) {
            h.set(at::kEvlrStart, evlrs.empty() ? std::uint64_t(0) : evlrStart);
            h.set(at::kEvlrCount, std::uint32_t(evlrs.size()));
        } else if (const auto before = h.get(at::kEvlrStart); before != 0) {
            h.set(at::kEvlrStart, moved(before));
        }
    }
    if (const auto before = h.get(at::kWaveformStart); h.versionMinor() >= 3 && before != 0) {
        std::uint64_t now = moved(before);
        if (waveformEvlr) {
            now = evlrStart;
            for (std::size_t k = 0; k < *waveformEvlr; ++k) now += evlrs[k].bytesInFile();
        }
        h.set(at::kWaveformStart, now);
    }
    std::copy(h.bytes.begin(), h.bytes.end(), prefix.begin());
}

std::vector<std::byte> WritePlan::suffix() const
{
    std::vector<std::byte> bytes = gapAfterPoints;
    for (const Vlr& vlr : evlrs) putVlr(bytes, vlr);
    bytes.insert(bytes.end(), tail.begin(), tail.end());
    return bytes;
}

bool WritePlan::serves(const std::filesystem::path& path, const WriteOptions& wanted) const
{
    return path == target && wanted.compressed == options.compressed &&
           wanted.versionMinor == options.versionMinor && wanted.pointFormat == options.pointFormat &&
           wanted.copyChunks == options.copyChunks && (wanted.upgrade || !upgraded) &&
           (wanted.lossy == options.lossy || losses.empty());
}

WritePlan planWrite(const PointCloud& given, const std::filesystem::path& target, const WriteOptions& options,
                    Progress& progress)
{
    const auto native = nativeCloud(given, formatAsked(given, options));
    const PointCloud& cloud = native ? *native : given;
    WritePlan plan;
    plan.target = target;
    plan.options = options;
    PlannedPoints points = planPoints(cloud, target, plan.notes);
    const SourceFile& source = *points.source;
    plan.vlrs = source.vlrs;
    plan.evlrs = source.evlrs;
    plan.gapAfterPoints = source.gapAfterPoints;
    plan.tail = source.tail;
    plan.sourcePointDataEnd = source.pointDataEnd;
    plan.waveformEvlr = source.waveformEvlr;

    const FormatPlan format = planFormat(cloud, points, target, options, progress, plan.notes);
    plan.upgraded = format.upgraded;
    FieldPlan fields = planFields(cloud, points, format, target, progress, plan.notes, plan.losses);
    planRecords(cloud, points, format, fields, options, target, progress, plan);
    tellLosses(cloud, points, format, target, options, progress, plan);
    planHeader(cloud, points, format, fields, target, progress, plan);
    plan.maker =
        std::make_shared<const RecordMaker>(std::move(fields.layout), std::move(fields.columns), fields.conversion,
                                            std::move(fields.packed), std::move(points.kept));
    return plan;
}

}  // namespace punctum::las
