// SPDX-License-Identifier: MIT
#include "core/las/CopcPlan.h"

#include "core/Text.h"
#include "core/las/ChunkWriter.h"
#include "core/las/GpsTime.h"

#include <algorithm>
#include <cstring>

namespace punctum::las
{

namespace
{

/// Points of a node, which one thread decodes and encodes as a whole.
constexpr std::uint64_t kMostInNode = 1 << 22;

bool isCopc(const Vlr& vlr)
{
    return vlr.user() == kCopcUser &&
           (vlr.recordId == kCopcInfoId || vlr.recordId == kCopcHierarchyId || vlr.recordId == kCopcExtentsId);
}

/// Why the file that is written cannot have the octree, as the end of a sentence; empty where it can.
std::string whyNone(const PlannedPoints& points, const FormatPlan& format, const WriteOptions& options)
{
    const SourceFile& source = *points.source;
    if (!options.compressed) return "the file becomes an ordinary LAS file, and COPC is compressed";
    if (!source.copc)
        return "it did not belong to the points when they were read, and the file becomes ordinary LAZ";
    if (!copc::has(format.format, format.minor))
        return "COPC has no point format " + std::to_string(format.format) + " of LAS 1." +
               std::to_string(format.minor) + ", and the file becomes ordinary LAZ";
    for (const CopcNode& node : source.copc->nodes)
        if (!node.points.empty() && node.points.size() > kMostInNode)
            return "one of its nodes has more than " + grouped(kMostInNode) +
                   " points, and the file becomes ordinary LAZ";
    return {};
}

template <typename T>
void put(std::byte* at, T value)
{
    std::memcpy(at, &value, sizeof value);
}

}  // namespace

void planCopc(const PointCloud& cloud, const PlannedPoints& points, const FormatPlan& format,
              const WriteOptions& options, Progress& progress, WritePlan& plan)
{
    const std::string why = whyNone(points, format, options);
    if (!why.empty()) {
        if (plan.dropRecords(isCopc) != 0)
            plan.note("The spatial index of the COPC file is left out: " + why + ".");
        return;
    }
    plan.copc = points.source->copc;
    const TimeExtent now = timeExtent(cloud, points.kept.ranges(), progress);
    if (now.empty() || (points.read.complete && now == points.read.times)) return;
    put(plan.vlrs.front().data.data() + copc::kFirstTimeAt, now.min);
    put(plan.vlrs.front().data.data() + copc::kLastTimeAt, now.max);
}

void setCopcPlaces(const WrittenChunks& written, WritePlan& plan)
{
    if (!plan.copc) return;
    const CopcIndex& index = *plan.copc;
    const auto record = std::find_if(plan.evlrs.begin(), plan.evlrs.end(), isCopcHierarchy);
    std::uint64_t hierarchyAt = written.end + plan.gapAfterPoints.size() + Vlr::kExtendedHeaderSize;
    for (auto k = plan.evlrs.begin(); k != record; ++k) hierarchyAt += k->bytesInFile();
    const auto moved = [&](std::uint64_t offset) { return offset - index.hierarchyAt + hierarchyAt; };

    std::byte* const data = record->data.data();
    const auto setNode = [&](std::size_t node, std::uint64_t offset, std::uint64_t bytes, PointIndex count) {
        std::byte* const entry = data + index.nodes[node].entry;
        put(entry + copc::kOffsetAt, offset);
        put(entry + copc::kBytesAt, std::int32_t(bytes));
        put(entry + copc::kPointsAt, std::int32_t(count));
    };
    // those that have no points any more; nodes without points from the start stay as they are
    for (std::size_t k = 0; k < index.chunks; ++k) setNode(k, 0, 0, 0);
    for (std::size_t k = 0; k < written.places.size(); ++k)
        setNode(plan.chunks.nodes[k], written.places[k].offset, written.places[k].bytes,
                plan.chunks.chunks[k].points.size());
    for (const std::uint64_t page : index.pages) {
        std::uint64_t offset = 0;
        std::memcpy(&offset, data + page + copc::kOffsetAt, sizeof offset);
        put(data + page + copc::kOffsetAt, moved(offset));
    }
    put(plan.prefix.data() + copc::kInfoAt + copc::kRootOffsetAt, moved(index.rootOffset));
}

std::shared_ptr<const CopcIndex> plannedCopc(const WritePlan& plan)
{
    if (!plan.copc) return nullptr;
    auto index = std::make_shared<CopcIndex>(*plan.copc);
    for (CopcNode& node : index->nodes) node.points = {};
    for (std::size_t k = 0; k < plan.chunks.nodes.size(); ++k)
        index->nodes[plan.chunks.nodes[k]].points = plan.chunks.chunks[k].points;
    return index;
}

}  // namespace punctum::las
