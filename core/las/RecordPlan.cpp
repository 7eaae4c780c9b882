// SPDX-License-Identifier: MIT
#include "core/las/RecordPlan.h"

#include "core/Error.h"
#include "core/Text.h"
#include "core/las/CopcPlan.h"
#include "core/las/ExtraBytesRange.h"

#include <algorithm>
#include <utility>

namespace punctum::las
{

namespace
{

/// Minimum and maximum in the descriptors that state them, where edits changed them: what is wrong from the
/// start stays as it is.
void updateRanges(const PointCloud& cloud, const PlannedPoints& points, ExtraBytesPlan& extra, Progress& progress,
                  WritePlan& plan)
{
    if (!points.read.complete) return;
    const auto now = extraBytesRanges(cloud, *points.source, points.kept.ranges(), progress);
    for (const ExtraBytesRange& range : now) {
        if (std::find(points.read.extra.begin(), points.read.extra.end(), range) != points.read.extra.end())
            continue;
        const ExtraBytesPlan::SourceItem& item = extra.sourceItems[range.item];
        if (item.descriptor) setRange(extra.descriptors[*item.descriptor].bytes.data(), range);
        std::size_t record = 0;
        for (auto* list : {&plan.vlrs, &plan.evlrs})
            for (Vlr& vlr : *list)
                if (vlr.is("LASF_Spec", kExtraBytesRecordId) && record++ == item.record)
                    setRange(vlr.data.data() + item.place, range);
    }
}

void replaceDescriptors(const std::vector<ExtraBytesDescriptor>& descriptors, std::uint8_t minor,
                        const std::filesystem::path& target, WritePlan& plan)
{
    std::vector<std::byte> data;
    for (const ExtraBytesDescriptor& d : descriptors) data.insert(data.end(), d.bytes.begin(), d.bytes.end());
    const bool large = data.size() > UINT16_MAX;
    if (large && minor < 4)
        throw Error(target, grouped(descriptors.size()) + " attributes are more than the " +
                                grouped(UINT16_MAX / ExtraBytesDescriptor::kSize) + " that LAS 1." +
                                std::to_string(minor) + " can describe; LAS 1.4 can.");
    bool placed = descriptors.empty();
    for (auto* list : {&plan.vlrs, &plan.evlrs}) {
        for (std::size_t k = 0; k < list->size();) {
            Vlr& vlr = (*list)[k];
            if (!vlr.is("LASF_Spec", kExtraBytesRecordId)) {
                ++k;
            } else if (!placed && (!large || vlr.extended)) {
                vlr.data = data;
                placed = true;
                ++k;
            } else {
                if (list == &plan.evlrs)
                    plan.eraseEvlr(k);
                else
                    list->erase(list->begin() + std::ptrdiff_t(k));
            }
        }
    }
    if (placed) return;
    Vlr record = makeVlr("LASF_Spec", kExtraBytesRecordId, "Extra Bytes Record", std::move(data), large);
    (large ? plan.evlrs : plan.vlrs).push_back(std::move(record));
}

/// What the record says, if chunks that we write can be of that kind.
std::optional<LazInfo> fitting(const Vlr& record, const RecordLayout& layout, WritePlan& plan)
{
    try {
        LazInfo info = LazInfo::parse(record, layout.format, layout.length);
        if (info.compressor == plan.laz.compressor) return info;
        if (info.compressor == LazInfo::Pointwise)
            plan.note("The points, until now compressed in one stream, are compressed in chunks.");
    } catch (const Error&) {  // of another point format
    }
    return {};
}

/// The file's own laszip record and chunks stay wherever they say the same as LASzip's present ones.
void planCompression(const PlannedPoints& points, const RecordLayout& layout, const WriteOptions& options,
                     WritePlan& plan)
{
    LazInfo& laz = plan.laz;
    laz = LazInfo::standard(layout.format, layout.length);
    const auto found = std::find_if(plan.vlrs.rbegin(), plan.vlrs.rend(), isLaszip);  // the last one counts
    std::optional<LazInfo> own;
    if (found != plan.vlrs.rend()) own = fitting(*found, layout, plan);
    const bool ownSize = own && !own->variable() && own->chunkSize <= kDefaultChunkSize;
    plan.chunks = plan.copc
                      ? planNodeChunks(*points.source, laz, points.kept)
                      : planChunks(*points.source, laz, points.kept, ownSize ? own->chunkSize : kDefaultChunkSize);
    if (!options.copyChunks) {
        plan.chunks.originPath.clear();
        plan.chunks.allOrNone = false;
    }
    laz.setChunkSize(plan.chunks.chunkSize);

    if (found == plan.vlrs.rend()) {
        plan.vlrs.push_back(makeVlr(kLaszipUser, kLaszipRecordId, "by Punctum with LASzip", laz.payload));
    } else if (!own || own->items != (plan.chunks.allOrNone ? plan.chunks.laz.items : laz.items)) {
        found->data = laz.payload;
    } else if (own->chunkSize != laz.chunkSize) {
        own->setChunkSize(laz.chunkSize);
        std::copy(own->payload.begin(), own->payload.end(), found->data.begin());
    }
}

/// Before 1.4 there are no EVLRs but the waveform record of 1.3.
void shortenEvlrs(std::uint8_t minorBefore, std::uint8_t minor, WritePlan& plan)
{
    if (minorBefore < 4) return;
    std::vector<Vlr> stay;
    std::optional<std::size_t> waveform;
    for (std::size_t k = 0; k < plan.evlrs.size(); ++k) {
        Vlr& vlr = plan.evlrs[k];
        if (minor == 3 && plan.waveformEvlr == k) {
            waveform = stay.size();
            stay.push_back(std::move(vlr));
        } else if (vlr.data.size() > UINT16_MAX) {
            plan.losses.push_back({"the extended record " + vlr.user() + "/" + std::to_string(vlr.recordId) +
                                       " of " + grouped(vlr.data.size()) + " bytes",
                                   "is left out", 0});
        } else {
            plan.note("The extended record " + vlr.user() + "/" + std::to_string(vlr.recordId) +
                      " becomes an ordinary one.");
            vlr.extended = false;
            plan.vlrs.push_back(std::move(vlr));
        }
    }
    plan.evlrs = std::move(stay);
    plan.waveformEvlr = waveform;
}

}  // namespace

bool isLax(const Vlr& vlr)
{
    return vlr.is("LAStools", 30);
}

void planRecords(const PointCloud& cloud, const PlannedPoints& points, const FormatPlan& format, FieldPlan& fields,
                 const WriteOptions& options, const std::filesystem::path& target, Progress& progress,
                 WritePlan& plan)
{
    const SourceFile& source = *points.source;
    ExtraBytesPlan& extra = fields.extra;
    updateRanges(cloud, points, extra, progress, plan);
    if (!extra.unchanged()) {
        replaceDescriptors(extra.descriptors, format.minor, target, plan);
        const auto say = [&](const char* what, const std::vector<std::string>& names) {
            if (!names.empty()) plan.note(what + listText(names, names.size()) + ".");
        };
        say("Stored as extra bytes: ", extra.added);
        say("Renamed: ", extra.renamed);
        say("No longer in the file: ", extra.gone);
    }
    planCopc(cloud, points, format, options, progress, plan);
    // In a file that stays compressed, the index in an EVLR is right while the points are where they were: what
    // is written tells (WritePlan::setCompression).
    const bool stays = options.compressed && format.minor >= 4;
    if (source.compressed &&
        plan.dropRecords([&](const Vlr& v) { return isLax(v) && !(stays && v.extended); }) != 0)
        plan.note(kLaxLeftOut);

    plan.compressed = options.compressed;
    if (options.compressed)
        planCompression(points, fields.layout, options, plan);
    else if (source.compressed)  // in a plain file it is just a record that somebody left there
        std::erase_if(plan.vlrs, isLaszip);
    if (format.minor < 4) shortenEvlrs(source.header.versionMinor(), format.minor, plan);
}

}  // namespace punctum::las
