// SPDX-License-Identifier: MIT
#include "core/las/ChunkPlan.h"

#include "core/Error.h"
#include "core/las/SourceParser.h"

#include <algorithm>
#include <map>

namespace punctum::las
{

namespace
{

/// Points of one chunk that is kept as it is cut. A chunk is decoded and encoded by one thread, as a whole.
constexpr std::uint64_t kMostInChunk = 1 << 20;

/// The places where the points of a range of places `before` are `now`, when nothing of it went or came between.
std::optional<PointRange> sameRange(PointRange range, const KeptPoints& before, const KeptPoints& now)
{
    if (range.last > before.count()) return {};
    const auto place = [&](PointIndex old) {
        return old < before.count() ? now.placeOf(before.index(old)) : now.count();
    };
    const PointIndex first = place(range.first);
    const PointIndex last = range.empty() ? first : now.placeOf(before.index(range.last - 1) + 1);
    return last - first == range.size() ? std::optional(PointRange{first, last}) : std::nullopt;
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

/// The file that holds the cloud at present, where chunks of it can be copied. Never throws.
std::optional<ParsedFile> parseCurrent(const CurrentFile& place, const LazInfo& standard)
{
    if (place.path.empty() || FileStamp::of(place.path) != place.stamp) return {};
    try {
        const File file(place.path);
        if (file.stamp() != place.stamp) return {};
        ParsedFile parsed = parseFile(file);
        const SourceFile& s = *parsed.source;
        if (s.compressed && parsed.laz.compressor == standard.compressor && s.layout.format == standard.format &&
            s.layout.length == standard.recordLength)
            return parsed;
    } catch (const Error&) {  // nothing is lost: every chunk is compressed anew
    }
    return {};
}

void setOrigin(const CurrentFile& place, LazInfo&& laz, const LazInfo& standard, ChunkPlan& plan)
{
    plan.originPath = place.path;
    plan.originStamp = place.stamp;
    plan.laz = std::move(laz);
    plan.allOrNone = plan.laz.items != standard.items;
}

}  // namespace

std::shared_ptr<const File> ChunkPlan::openOrigin() const
{
    if (!copies()) return nullptr;
    try {
        auto file = std::make_shared<const File>(originPath);
        return file->stamp() == originStamp ? file : nullptr;
    } catch (const Error&) {
        return nullptr;  // nothing is lost
    }
}

std::vector<PlannedChunk> regularChunks(PointIndex points, std::uint32_t chunkSize)
{
    return withoutGaps({}, points, chunkSize);
}

ChunkPlan planChunks(const SourceFile& source, const LazInfo& standard, const KeptPoints& kept,
                     std::uint32_t chunkSize)
{
    ChunkPlan plan;
    plan.chunkSize = chunkSize;
    const auto regular = [&] {
        plan.chunks = regularChunks(kept.count(), chunkSize);
        return std::move(plan);
    };

    const CurrentFile place = source.current->get();
    std::optional<ParsedFile> parsed = parseCurrent(place, standard);
    // chunks of an octree differ in size, as those of a file without one should not
    if (!parsed || parsed->source->copc != nullptr ||
        parsed->source->pointCount != (place.kept ? place.kept->count() : source.pointCount))
        return regular();
    const KeptPoints held = place.kept ? *place.kept : KeptPoints::all(parsed->source->pointCount);

    std::vector<PlannedChunk> planned;
    for (const Chunk& chunk : parsed->chunks) {
        if (chunk.count > kMostInChunk) return regular();
        const PointRange range{chunk.first, chunk.first + chunk.count};
        const auto written = sameRange(range, held, kept);
        if (written && !chunk.cut) planned.push_back({*written, chunk});
    }
    plan.chunks = withoutGaps(planned, kept.count(),
                              std::uint32_t(std::min<std::uint64_t>(parsed->laz.chunkSize, chunkSize)));
    plan.chunkSize = commonSize(plan.chunks, parsed->laz.chunkSize);
    setOrigin(place, std::move(parsed->laz), standard, plan);
    return plan;
}

ChunkPlan planNodeChunks(const SourceFile& source, const LazInfo& standard, const KeptPoints& kept)
{
    ChunkPlan plan;
    plan.chunkSize = kVariableChunks;
    for (std::size_t k = 0; k < source.copc->nodes.size(); ++k) {
        const PointRange& points = source.copc->nodes[k].points;
        if (points.empty()) continue;
        const PointRange written{kept.placeOf(points.first), kept.placeOf(points.last)};
        if (written.empty()) continue;
        plan.chunks.push_back({written, {}});
        plan.nodes.push_back(k);
    }
    const CurrentFile place = source.current->get();
    std::optional<ParsedFile> parsed = parseCurrent(place, standard);
    if (!parsed || parsed->source->copc == nullptr) return plan;
    const CopcIndex& there = *parsed->source->copc;
    std::map<CopcKey, std::size_t> chunkOf;
    for (std::size_t k = 0; k < there.chunks; ++k) chunkOf[there.nodes[k].key] = k;
    for (std::size_t k = 0; k < plan.chunks.size(); ++k) {
        const auto found = chunkOf.find(source.copc->nodes[plan.nodes[k]].key);
        if (found == chunkOf.end()) continue;
        const Chunk& chunk = parsed->chunks[found->second];
        if (chunk.count == plan.chunks[k].points.size()) plan.chunks[k].origin = chunk;
    }
    setOrigin(place, std::move(parsed->laz), standard, plan);
    return plan;
}

}  // namespace punctum::las
