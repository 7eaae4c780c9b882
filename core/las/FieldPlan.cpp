// SPDX-License-Identifier: MIT
#include "core/las/FieldPlan.h"

#include "core/Error.h"
#include "core/Text.h"
#include "core/las/GpsTime.h"
#include "core/las/Header.h"

#include <utility>

namespace punctum::las
{

namespace
{

/// Times with an offset, which only LAS 1.5 has, are counted as earlier versions do.
std::shared_ptr<const Column> keepTimes(const std::shared_ptr<const Column>& times, const PlannedPoints& points,
                                        std::uint8_t minor, Progress& progress, std::vector<std::string>& notes,
                                        std::vector<Loss>& losses)
{
    const Header& header = points.source->header;
    if (minor >= 5 || gpsClock(header) != GpsClock::Offset) return times;
    constexpr double kAdjusted = 1000.0, kSeconds = 1e6;  // of the offset
    const double offset = header.get(at::kTimeOffset);
    if (offset == kAdjusted) return times;
    std::uint64_t rounded = 0;
    auto shifted = shiftedTimes(*times, (offset - kAdjusted) * kSeconds, points.kept.ranges(), rounded, progress);
    notes.push_back("GPS times are counted as LAS 1." + std::to_string(minor) +
                    " does: seconds less 1,000,000,000 instead of " + grouped(std::uint64_t(offset * kSeconds)) +
                    ".");
    if (rounded != 0)
        losses.push_back({"a GPS time that is rounded when it is counted from another origin",
                          "is rounded by a ten-millionth of a second or less", rounded});
    return shifted;
}

/// The column that fills a field as it is; null: there is none, or none of the field's type.
std::shared_ptr<const Column> matching(const PointCloud& cloud, const RecordField& f)
{
    auto c = findColumn(cloud, f.column);
    if (c != nullptr && c->type() == f.type && c->components() == f.components) return c;
    return nullptr;
}

/// Whether formats 0 to 5 and 6 to 10 hold this field in other ways.
bool isPacked(const std::string& name)
{
    return name == "Returns" || name == "Classes" || name == "Flags" || name == "Classification" ||
           name == "ScanAngle";
}

RecordMaker::Conversion conversionOf(const SourceFile& source, std::uint8_t format, const PackedColumns& packed)
{
    const bool was = isExtendedFormat(source.layout.format), is = isExtendedFormat(format);
    if (was != is) return is ? RecordMaker::Conversion::ToExtended : RecordMaker::Conversion::ToClassic;
    return !is && packed.classes ? RecordMaker::Conversion::FoldClasses : RecordMaker::Conversion::None;
}

void addField(const std::shared_ptr<const Column>& c, const std::filesystem::path& target, FieldPlan& plan)
{
    const std::size_t length = plan.layout.length + c->elementBytes();
    if (length > UINT16_MAX) throw Error(target, "The attributes do not fit a point record of 65535 bytes.");
    plan.layout.fields.push_back({c->name(), plan.layout.length, c->type(), std::uint16_t(c->components())});
    plan.layout.length = std::uint16_t(length);
    plan.columns.push_back(c);
}

}  // namespace

FieldPlan planFields(const PointCloud& cloud, const PlannedPoints& points, const FormatPlan& format,
                     const std::filesystem::path& target, Progress& progress, std::vector<std::string>& notes,
                     std::vector<Loss>& losses)
{
    const SourceFile& source = *points.source;
    FieldPlan plan;
    std::vector<std::string> none;
    plan.layout = makeLayout(format.format, standardRecordLength(format.format), {}, source.coordinates, none);
    plan.layout.attributes.clear();
    plan.layout.attributeFields.clear();
    plan.packed = packedColumns(cloud, source);
    plan.conversion = conversionOf(source, format.format, plan.packed);
    const bool converts = plan.conversion != RecordMaker::Conversion::None;
    for (const RecordField& f : plan.layout.fields) {
        std::shared_ptr<const Column> c;
        const int before = source.layout.find(f.column);  // extra bytes of the same name stay extra bytes
        const bool extra = before >= 0 && source.layout.fields[std::size_t(before)].offset >=
                                              standardRecordLength(source.layout.format);
        const bool converted = plan.conversion == RecordMaker::Conversion::FoldClasses
                                   ? f.column == "Classes"
                                   : converts && isPacked(f.column);
        if (!extra && !converted) c = matching(cloud, f);
        if (c != nullptr && !extra && f.column == "GpsTime")
            c = keepTimes(c, points, format.minor, progress, notes, losses);
        plan.columns.push_back(std::move(c));
    }
    const bool was = isExtendedFormat(source.layout.format);
    if (converts &&
        (!plan.packed.returns || !plan.packed.flags || !plan.packed.angle || (was && !plan.packed.classes)))
        throw Error(target, "The cloud lacks a field of its point format and cannot be converted.");

    auto standard = plan.columns;
    if (!was) standard.push_back(plan.packed.classes);
    plan.extra = planExtraBytes(cloud, source, standard);
    for (const auto& c : plan.extra.columns) addField(c, target, plan);
    return plan;
}

}  // namespace punctum::las
