// SPDX-License-Identifier: MIT
#include "core/las/ChunkPlan.h"

#include "core/Error.h"
#include "core/las/SourceParser.h"

#include <algorithm>

namespace punctum::las
{

namespace
{

/// Points of one chunk that is kept as it is cut. A chunk is decoded and encoded by one thread, as a whole.
constexpr std::uint64_t kMostInChunk = 1 << 20;

/// The part of `range` (of the cloud) that is written, as written points, when it is written in one piece.
/// `before[k]`: written points before kept[k].
std::optional<PointRange> writtenRange(PointRange range, const std::vector<PointRange>& kept,
                                       const std::vector<PointIndex>& before)
{
    const auto after = std::upper_bound(kept.begin(), kept.end(), range.first,
                                        [](PointIndex i, const PointRange& r) { return i < r.first; });
    if (after == kept.begin()) return {};
    const auto k = std::size_t(after - kept.begin()) - 1;
    if (range.last > kept[k].last) return {};
    const PointIndex first = before[k] + (range.first - kept[k].first);
    return PointRange{first, first + range.size()};
}

/// Fills the places between `planned` (rising) with chunks of at most `size` points.
std::vector<PlannedChunk> withoutGaps(const std::vector<PlannedChunk>& planned, PointIndex points,
                                      std::uint32_t size)
{
    std::vector<PlannedChunk> all;
    PointIndex next = 0;
    const auto fill = [&](PointIndex end) {
        for (; next < end; next = all.back().points.last) all.push_back({{next, std::min(next + size, end)}, {}});
    };
    for (const PlannedChunk& chunk : planned) {
        fill(chunk.points.first);
        all.push_back(chunk);
        next = chunk.points.last;
    }
    fill(points);
    return all;
}

/// The size that all chunks but the last have, or kVariableChunks; `stated` where it will do.
std::uint32_t commonSize(const std::vector<PlannedChunk>& chunks, std::uint32_t stated)
{
    if (stated == kVariableChunks || chunks.empty()) return stated;
    const PointIndex size = chunks.size() == 1 ? stated : chunks.front().points.size();
    const bool even = std::all_of(chunks.begin(), chunks.end() - 1,
                                  [&](const PlannedChunk& c) { return c.points.size() == size; });
    return even && chunks.back().points.size() <= size ? std::uint32_t(size) : kVariableChunks;
}

}  // namespace

std::vector<PlannedChunk> regularChunks(PointIndex points, std::uint32_t chunkSize)
{
    return withoutGaps({}, points, chunkSize);
}

ChunkPlan planChunks(const SourceFile& source, const LazInfo& standard, const std::vector<PointRange>& kept,
                     std::uint32_t chunkSize)
{
    std::vector<PointIndex> before;
    PointIndex points = 0;
    for (const PointRange& r : kept) {
        before.push_back(points);
        points += r.size();
    }
    ChunkPlan plan;
    plan.chunkSize = chunkSize;
    const auto regular = [&] {
        plan.chunks = regularChunks(points, chunkSize);
        return std::move(plan);
    };

    const CurrentFile place = source.current->get();
    if (place.path.empty() || FileStamp::of(place.path) != place.stamp) return regular();
    ParsedFile parsed;
    std::shared_ptr<const File> file;
    try {
        file = std::make_shared<const File>(place.path);
        if (file->stamp() != place.stamp) return regular();
        parsed = parseFile(*file);
    } catch (const Error&) {
        return regular();  // nothing is lost: every chunk is compressed anew
    }
    const SourceFile& s = *parsed.source;
    if (!s.compressed || parsed.laz.compressor != standard.compressor || s.layout.format != standard.format ||
        s.layout.length != standard.recordLength || s.findVlr("copc", 1) != nullptr ||
        s.pointCount != (place.saved ? points : source.pointCount))
        return regular();

    std::vector<PlannedChunk> planned;
    for (const Chunk& chunk : parsed.chunks) {
        if (chunk.count > kMostInChunk) return regular();
        const PointRange range{chunk.first, chunk.first + chunk.count};
        const auto written = place.saved ? range : writtenRange(range, kept, before);
        if (written && !chunk.cut) planned.push_back({*written, chunk});
    }
    plan.chunks =
        withoutGaps(planned, points, std::uint32_t(std::min<std::uint64_t>(parsed.laz.chunkSize, chunkSize)));
    plan.chunkSize = commonSize(plan.chunks, parsed.laz.chunkSize);
    plan.file = std::move(file);
    plan.laz = std::move(parsed.laz);
    plan.allOrNone = plan.laz.items != standard.items;
    return plan;
}

}  // namespace punctum::las
