// SPDX-License-Identifier: MIT
#include "core/las/FormatPlan.h"

#include "core/Error.h"
#include "core/Text.h"
#include "core/cloud/PointCloud.h"
#include "core/las/FormatNeeds.h"

#include <system_error>

namespace punctum::las
{

namespace
{

/// For a cloud that came from nowhere: the format that holds the standard columns it has.
std::shared_ptr<const SourceFile> inventSource(const PointCloud& cloud)
{
    const auto has = [&](const char* name) { return findColumn(cloud, name) != nullptr; };
    std::uint8_t format = 6;
    if (has("Classes"))
        format = std::uint8_t((has("GpsTime") ? 1 : 0) + (has("Red") ? 2 : 0));
    else if (has("NIR"))
        format = 8;
    else if (has("Red"))
        format = 7;
    return makeSource(format, {}, cloud.coordinates(), {}, cloud.size());
}

/// The version that was asked for decides the format, unless that was asked for, too.
void followVersion(std::uint8_t before, const std::filesystem::path& target, const WriteOptions& options,
                   FormatPlan& plan, std::vector<std::string>& notes)
{
    const std::string version = "LAS 1." + std::to_string(plan.minor);
    if (plan.minor < 2 || plan.minor > kNewestMinor)
        throw Error(target, version + " cannot be written; choose 1.2, 1.3, 1.4 or 1.5.");
    if (options.pointFormat) {
        if (plan.minor > newestMinor(plan.format))
            throw Error(target,
                        version + " has no point format " + std::to_string(plan.format) + ", only 6 to 10.");
        return;
    }
    plan.format = formatIn(plan.format, plan.minor);
    if (plan.format != before)
        notes.push_back("The points become point format " + std::to_string(plan.format) + ": " + version +
                        " has no point format " + std::to_string(before) + ".");
}

/// What there is now does not fit the source's format: another one only if the user says so.
void upgrade(const std::vector<std::string>& reasons, const SourceFile& source, const std::filesystem::path& target,
             const WriteOptions& options, FormatPlan& plan, std::vector<std::string>& notes)
{
    std::string list;
    for (const std::string& reason : reasons) list += (list.empty() ? "" : ", ") + reason;
    const std::string old = "Point format " + std::to_string(source.layout.format) + " of LAS 1." +
                            std::to_string(source.header.versionMinor());
    const std::string now =
        "point format " + std::to_string(plan.format) + " of LAS 1." + std::to_string(plan.minor);
    if (!options.upgrade)
        throw WriteQuestion(WriteQuestion::Kind::Upgrade, target,
                            old + " cannot hold what the points are now: " + list + ".", now);
    plan.upgraded = true;
    notes.push_back("The file becomes " + now + ", since the former one cannot hold it: " + list + ".");
}

const char* isOrAre(PointIndex n)
{
    return n == 1 ? "is" : "are";
}

}  // namespace

PlannedPoints planPoints(const PointCloud& cloud, const std::filesystem::path& target,
                         std::vector<std::string>& notes)
{
    PlannedPoints points;
    points.source = cloud.source() ? cloud.source() : inventSource(cloud);
    const SourceFile& source = *points.source;
    points.made = source.path.empty();
    points.read = source.asRead->get();
    const bool damaged = source.recovered || !points.read.missing.empty();
    std::error_code ec;
    if (damaged && std::filesystem::equivalent(source.path, target, ec))
        throw Error(
            target,
            "This file was damaged when it was opened; save under another name, so that the original stays.");
    points.kept = KeptPoints(readable(cloud.size(), points.read.missing));
    if (const PointIndex lost = cloud.size() - points.kept.count(); lost != 0)
        notes.push_back(pointsText(lost) + " that could not be read " + isOrAre(lost) + " left out.");
    if (const PointIndex readable = points.kept.count(); cloud.deleted()) {
        points.kept = points.kept.without(*cloud.deleted());
        const PointIndex deleted = readable - points.kept.count();
        notes.push_back(pointsText(deleted) + " that " + (deleted == 1 ? "was" : "were") + " deleted " +
                        isOrAre(deleted) + " left out.");
    }
    return points;
}

FormatPlan planFormat(const PointCloud& cloud, const PlannedPoints& points, const std::filesystem::path& target,
                      const WriteOptions& options, Progress& progress, std::vector<std::string>& notes)
{
    const SourceFile& source = *points.source;
    const std::uint8_t before = source.layout.format, minorBefore = source.header.versionMinor();
    FormatPlan plan;
    FormatNeeds needs;
    if (!options.pointFormat) needs = findNeeds(cloud, source, points.kept.ranges(), progress);
    plan.format = options.pointFormat.value_or(needs.formatFor(before));
    if (plan.format > kLastPointFormat)
        throw Error(target, "There is no point format " + std::to_string(plan.format) + ".");
    plan.minor = options.versionMinor.value_or(minorBefore);
    if (options.versionMinor) followVersion(before, target, options, plan, notes);
    const bool formatAsked = plan.format != before || (options.versionMinor && plan.minor != minorBefore);
    std::uint8_t needed = formatAsked ? oldestMinor(plan.format) : std::uint8_t(0);
    const PointIndex count = points.kept.count();
    const bool many = count > UINT32_MAX;
    if (many) needed = 4;
    if (many && plan.minor < needed) needs.reasons.push_back(grouped(count) + " points are more than it can count");
    if (plan.minor < needed) {
        if (options.versionMinor)
            throw Error(target, (many ? grouped(count) + " points need"
                                      : "Point format " + std::to_string(plan.format) + " needs") +
                                    " LAS 1." + std::to_string(needed) + " or newer.");
        plan.minor = needed;
    }
    const auto becomes = [&](const std::string& why) {
        notes.push_back("The file becomes LAS 1." + std::to_string(plan.minor) + ", " + why + ".");
    };
    const std::string format = "point format " + std::to_string(plan.format);
    if (!needs.reasons.empty())
        upgrade(needs.reasons, source, target, options, plan, notes);
    else if (plan.minor != minorBefore && !options.versionMinor)
        becomes("which " + format + " needs");
    if (plan.format != before && plan.minor > newestMinor(plan.format)) {
        plan.minor = newestMinor(plan.format);
        becomes("the last version that has " + format);
    }
    plan.changed = plan.format != before || plan.minor != minorBefore;
    return plan;
}

}  // namespace punctum::las
