// SPDX-License-Identifier: MIT
#include "core/las/Writer.h"

#include "core/Error.h"
#include "core/las/AtomicFile.h"
#include "core/las/ChunkWriter.h"
#include "core/las/Compatible.h"
#include "core/las/CopcPlan.h"
#include "core/las/Parallel.h"
#include "core/las/SourceParser.h"
#include "core/las/StagedWrite.h"
#include "core/las/WaveformFile.h"
#include "core/las/WritePlan.h"
#include "core/task/Progress.h"

#include <algorithm>
#include <chrono>
#include <mutex>
#include <shared_mutex>

namespace punctum::las
{

namespace
{

constexpr std::size_t kWriteBytes = std::size_t(1) << 20;  ///< of records made and written at once (LAS)

/// What the written file must hold besides its points.
struct Written {
    std::uint64_t pointDataEnd = 0;
    std::uint64_t bytes = 0;
    std::vector<std::byte> suffix;
    WrittenChunks chunks;  ///< when compressed
};

/// Runs work(scratch, range) for each block of points, in parallel; `scratch` is the worker's own.
template <typename Work>
void forEachBlock(const RecordMaker& maker, Progress& progress, const Work& work)
{
    const std::uint64_t block = std::max<std::uint64_t>(1, kWriteBytes / maker.layout().length);
    const std::uint64_t blocks = (maker.points() + block - 1) / block;
    forEachInOrder(std::size_t(blocks), [&](std::vector<std::byte>& scratch, std::size_t k) {
        progress.check();
        const PointRange range{k * block, std::min((k + 1) * block, maker.points())};
        work(scratch, range);
        progress.add(range.size());
    });
}

void writePlain(const RecordMaker& maker, AtomicFile& file, std::uint64_t begin, Progress& progress)
{
    const std::uint64_t length = maker.layout().length;
    forEachBlock(maker, progress, [&](std::vector<std::byte>& records, PointRange range) {
        records.resize(std::size_t(range.size() * length));
        maker.make(range, records.data());
        file.writeAt(begin + range.first * length, records);
    });
}

/// Whether uncompressed points from `begin` on are the records of the cloud. Gives the first block found that is
/// not.
std::optional<PointRange> findWrongBlock(const RecordMaker& maker, const File& file, std::uint64_t begin,
                                         Progress& progress)
{
    const std::uint64_t length = maker.layout().length;
    std::optional<PointRange> wrong;
    std::mutex mutex;
    forEachBlock(maker, progress, [&](std::vector<std::byte>& scratch, PointRange range) {
        const auto size = std::size_t(range.size() * length);
        scratch.resize(2 * size);
        file.readAt(begin + range.first * length, std::span(scratch).first(size));
        maker.make(range, scratch.data() + size);
        if (std::memcmp(scratch.data(), scratch.data() + size, size) == 0) return;
        const std::lock_guard lock(mutex);
        if (!wrong || range.first < wrong->first) wrong = range;
    });
    return wrong;
}

/// Reads the written file as any other and compares every record with what the cloud says now, and all other bytes
/// with what was meant. Throws Error when anything differs.
void verify(const AtomicFile& target, const WritePlan& plan, const Written& written, Progress& progress)
{
    const File file(target.temporary());
    const ParsedFile parsed = parseFile(file);
    const SourceFile& s = *parsed.source;
    const RecordMaker& maker = *plan.maker;
    const auto differs = [](const std::string& what) {
        throw Error("The written file does not hold what was meant (" + what + "); nothing was changed.");
    };
    if (s.pointCount != maker.points() || s.layout.length != maker.layout().length ||
        s.layout.format != maker.layout().format || s.fileSize != written.bytes)
        differs("its size");
    std::vector<std::byte> part(plan.prefix.size());
    file.readAt(0, part);
    if (part != plan.prefix) differs("the header");
    part.resize(written.suffix.size());
    file.readAt(written.pointDataEnd, part);
    if (part != written.suffix) differs("the records after the points");
    if (plan.compressed) {  // a reader makes a lost table again, so it is looked at by itself
        const std::uint64_t tableAt = written.pointDataEnd - written.chunks.table.size();
        std::uint64_t position = 0;
        file.readAt(plan.prefix.size(), std::as_writable_bytes(std::span(&position, 1)));
        part.resize(written.chunks.table.size());
        file.readAt(tableAt, part);
        if (position != tableAt || part != written.chunks.table) differs("the table of chunks");
    }
    if (parsed.chunks.size() != written.chunks.places.size()) differs("the number of chunks");
    for (std::size_t k = 0; k < parsed.chunks.size(); ++k)
        if (parsed.chunks[k].offset != written.chunks.places[k].offset ||
            parsed.chunks[k].bytes != written.chunks.places[k].bytes ||
            parsed.chunks[k].count != plan.chunks.chunks[k].points.size())
            differs("the table of chunks");
    // The parser holds each entry of the octree against the table.
    if (plan.copc && (!s.copc || !sameNodes(*s.copc, *plannedCopc(plan)))) differs("the spatial index");

    progress.begin("Checking the file", maker.points());
    const auto wrong = plan.compressed
                           ? findWrongChunk(maker, parsed.laz, plan.chunks, written.chunks, file, progress)
                           : findWrongBlock(maker, file, plan.prefix.size(), progress);
    if (!wrong) return;
    const std::string points = "points " + std::to_string(wrong->first) + " to " + std::to_string(wrong->last - 1);
    if (!plan.compressed) differs(points);
    throw Error("Compressing would not keep what is in the " + points +
                "; nothing was changed. Save as LAS, which keeps everything.");
}

/// The cloud's own file must be as it was read or saved, or the user would undo what another program did.
void askIfChanged(const PointCloud& cloud, const std::filesystem::path& target)
{
    if (cloud.source() == nullptr) return;
    const CurrentFile place = cloud.source()->current->get();
    std::error_code ec;
    if (place.path.empty() || !std::filesystem::equivalent(place.path, target, ec)) return;
    const auto now = FileStamp::of(target);
    if (now && *now != place.stamp)
        throw WriteQuestion(WriteQuestion::Kind::TargetChanged, target,
                            std::string("Another program changed this file since it was ") +
                                (place.saved ? "saved" : "read") +
                                "; saving would undo that. Save under another name to keep both.");
}

/// Bytes that the chunks take if all can be copied: what others take is not known before they are compressed, and a
/// disk that is too small for them stops the save without harm.
std::uint64_t expectedChunks(const ChunkPlan& plan)
{
    std::uint64_t bytes = 0;
    for (const PlannedChunk& chunk : plan.chunks) bytes += chunk.origin ? chunk.origin->bytes : 0;
    return bytes;
}

/// Packets in a file of their own go with the points to another name.
std::unique_ptr<AtomicFile> writeWaveforms(const SourceFile* source, const RecordMaker& maker,
                                           const AtomicFile& file, std::vector<std::string>& notes,
                                           Progress& progress)
{
    const bool external =
        source != nullptr && hasWaveform(maker.layout().format) && source->header.says(encoding::kExternalWaveform);
    const std::filesystem::path from = external ? source->current->get().path : std::filesystem::path();
    return from.empty() ? nullptr : copyWaveforms(from, file, notes, progress);
}

}  // namespace

bool KnownPlan::fits(const std::filesystem::path& path, const WriteOptions& options) const
{
    return plan && plan->serves(path, options) && (!holds || holds());
}

StagedWrite stage(const PointCloud& cloud, const std::filesystem::path& path, const WriteOptions& options,
                  Progress& progress, const KnownPlan& known)
{
    storeCompatible(cloud);
    const std::shared_lock lock(cloud.mutex());
    progress.begin("Preparing", 0);
    return withName(path, [&] {
        if (!options.overwriteChanged) askIfChanged(cloud, path);
        if (!options.replaceProtected && writeProtected(path))
            throw WriteQuestion(WriteQuestion::Kind::TargetProtected, path, "This file is write-protected.");
        const auto begun = std::chrono::steady_clock::now();
        WritePlan plan = known.fits(path, options) ? *known.plan : planWrite(cloud, path, options, progress);
        const RecordMaker& maker = *plan.maker;
        const std::uint64_t begin = plan.prefix.size();
        const std::uint64_t plainEnd = begin + maker.points() * maker.layout().length;

        auto staged = std::make_unique<StagedWrite::State>();
        staged->path = path;
        staged->source = cloud.source();
        staged->copc = plan.copc != nullptr;
        staged->file = std::make_unique<AtomicFile>(
            path, options.compressed ? expectedChunks(plan.chunks) : plainEnd,
            options.replaceProtected ? AtomicFile::Protected::Replace : AtomicFile::Protected::Refuse);
        AtomicFile& file = *staged->file;
        const SourceFile* const source = staged->source.get();
        Written written;
        if (options.compressed) {
            written.chunks = writeChunks(maker, plan.laz, plan.chunks, file, begin, progress);
            written.pointDataEnd = written.chunks.end;
            staged->pristine = written.chunks.encoded == 0 && source != nullptr &&
                               source->current->get().pristine && written.pointDataEnd == source->pointDataEnd &&
                               begin == source->header.pointOffset();
            plan.setCompression(written.chunks.originVersions, !staged->pristine);
        } else {
            progress.begin("Writing points", maker.points());
            writePlain(maker, file, begin, progress);
            written.pointDataEnd = plainEnd;
        }
        plan.setPointDataEnd(written.pointDataEnd);
        setCopcPlaces(written.chunks, plan);
        written.suffix = plan.suffix();
        written.bytes = written.pointDataEnd + written.suffix.size();
        file.writeAt(written.pointDataEnd, written.suffix);
        file.writeAt(0, plan.prefix);
        const std::chrono::duration<double> writing = std::chrono::steady_clock::now() - begun;
        file.sync();
        if (options.verify) verify(file, plan, written, progress);
        progress.check();
        staged->waveforms = writeWaveforms(source, maker, file, plan.notes, progress);
        if (staged->waveforms) staged->waveforms->seal();
        file.seal();

        if (maker.points() != cloud.size()) staged->kept = std::make_shared<const KeptPoints>(maker.kept());
        WriteReport& report = staged->report;
        report.points = maker.points();
        report.bytes = written.bytes;
        report.chunksCopied = written.chunks.copied;
        report.chunksEncoded = written.chunks.encoded;
        report.writeSeconds = writing.count();
        report.notes = std::move(plan.notes);
        report.losses = std::move(plan.losses);
        return StagedWrite(std::move(staged));
    });
}

WriteReport write(const PointCloud& cloud, const std::filesystem::path& path, const WriteOptions& options,
                  Progress& progress, const KnownPlan& known)
{
    return stage(cloud, path, options, progress, known).commit();
}

}  // namespace punctum::las
