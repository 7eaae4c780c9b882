// SPDX-License-Identifier: MIT
#include "core/las/Writer.h"

#include "core/Error.h"
#include "core/las/AtomicFile.h"
#include "core/las/ChunkTable.h"
#include "core/las/File.h"
#include "core/las/Parallel.h"
#include "core/las/Reader.h"
#include "core/las/WritePlan.h"
#include "core/task/Progress.h"

#include <tbb/parallel_pipeline.h>

#include <algorithm>
#include <shared_mutex>

namespace punctum::las
{

namespace
{

constexpr std::size_t kBlockBytes = std::size_t(1) << 20;  ///< of records made and written at once (LAS)

/// What the written file must hold besides its points.
struct Written {
    std::uint64_t pointDataEnd = 0;
    std::uint64_t bytes = 0;
    std::vector<std::byte> suffix;
};

void writePlain(const RecordMaker& maker, AtomicFile& file, std::uint64_t begin, Progress& progress)
{
    const std::uint64_t length = maker.layout().length;
    const std::uint64_t block = std::max<std::uint64_t>(1, kBlockBytes / length);
    const std::uint64_t blocks = (maker.points() + block - 1) / block;
    forEachInOrder(std::size_t(blocks), [&](std::vector<std::byte>& scratch, std::size_t k) {
        progress.check();
        const PointRange range{k * block, std::min((k + 1) * block, maker.points())};
        scratch.resize(std::size_t(block * length));
        const auto records = std::span(scratch).first(std::size_t(range.size() * length));
        maker.make(range, records.data());
        file.writeAt(begin + range.first * length, records);
        progress.add(range.size());
    });
}

/// Compresses chunks in parallel and writes them in order, then the table and its position. Gives the end.
std::uint64_t writeCompressed(const RecordMaker& maker, const LazInfo& laz, AtomicFile& file, std::uint64_t begin,
                              Progress& progress)
{
    struct Piece {
        PointRange range;
        std::vector<std::byte> bytes;
    };
    const std::uint64_t length = maker.layout().length;
    std::vector<ChunkEntry> entries;
    std::uint64_t offset = begin + sizeof(std::int64_t);
    PointIndex next = 0;

    const auto tokens = std::size_t(std::max(1, tbb::this_task_arena::max_concurrency())) * 2;
    tbb::parallel_pipeline(
        tokens, tbb::make_filter<void, PointRange>(tbb::filter_mode::serial_in_order,
                                                   [&](tbb::flow_control& control) {
                                                       const PointIndex first = next;
                                                       if (first >= maker.points() || progress.cancelled()) {
                                                           control.stop();
                                                           return PointRange{};
                                                       }
                                                       next = std::min(first + kDefaultChunkSize, maker.points());
                                                       return PointRange{first, next};
                                                   }) &
                    tbb::make_filter<PointRange, std::shared_ptr<Piece>>(
                        tbb::filter_mode::parallel,
                        [&](PointRange range) {
                            progress.check();
                            std::vector<std::byte> records(std::size_t(range.size() * length));
                            maker.make(range, records.data());
                            return std::make_shared<Piece>(Piece{range, encodeChunk(laz, records)});
                        }) &
                    tbb::make_filter<std::shared_ptr<Piece>, void>(
                        tbb::filter_mode::serial_in_order, [&](const std::shared_ptr<Piece>& piece) {
                            progress.check();
                            if (piece->bytes.size() > UINT32_MAX)
                                throw Error("A chunk of compressed points is too large for the format.");
                            file.writeAt(offset, piece->bytes);
                            offset += piece->bytes.size();
                            entries.push_back({0, std::uint32_t(piece->bytes.size())});
                            progress.add(piece->range.size());
                        }));
    progress.check();

    const auto position = std::int64_t(offset);
    file.writeAt(begin, std::as_bytes(std::span(&position, 1)));
    const std::vector<std::byte> table = encodeChunkTable(entries, false);
    file.writeAt(offset, table);
    return offset + table.size();
}

/// Reads the written file as any other and compares every record with what the cloud says now, and all other bytes
/// with what was meant. Throws Error when anything differs.
void verify(const AtomicFile& file, const WritePlan& plan, const Written& written, Progress& progress)
{
    const auto reader = Reader::open(file.temporary());
    const SourceFile& s = *reader->source();
    const RecordMaker& maker = *plan.maker;
    const std::uint64_t length = maker.layout().length;
    const auto differs = [](const std::string& what) {
        throw Error("The written file does not hold what was meant (" + what + "); nothing was changed.");
    };
    if (s.pointCount != maker.points() || s.layout.length != length || s.layout.format != maker.layout().format ||
        s.fileSize != written.bytes)
        differs("its size");
    const File bytes(file.temporary());
    std::vector<std::byte> part(plan.prefix.size());
    bytes.readAt(0, part);
    if (part != plan.prefix) differs("the header");
    part.resize(written.suffix.size());
    bytes.readAt(written.pointDataEnd, part);
    if (part != written.suffix) differs("the records after the points");

    progress.begin("Checking the file", maker.points());
    const ReadResult result =
        reader->visitRecords(progress, [&](PointRange range, std::span<const std::byte> records) {
            thread_local std::vector<std::byte> meant;
            meant.resize(records.size());
            maker.make(range, meant.data());
            if (std::memcmp(meant.data(), records.data(), records.size()) != 0)
                differs("points " + std::to_string(range.first) + " to " + std::to_string(range.last - 1));
        });
    if (!result.missing.empty()) differs("a chunk of points");
}

std::string lowerExtension(const std::filesystem::path& path)
{
    std::string ending = path.extension().string();
    for (char& c : ending)
        if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
    return ending;
}

}  // namespace

bool isCompressedName(const std::filesystem::path& path)
{
    return lowerExtension(path) == ".laz";
}

WriteReport write(const PointCloud& cloud, const std::filesystem::path& path, const WriteOptions& options,
                  Progress& progress)
{
    const std::shared_lock lock(cloud.mutex());
    progress.begin("Preparing", 0);
    try {
        WritePlan plan = planWrite(cloud, path, options, progress);
        const RecordMaker& maker = *plan.maker;
        const std::uint64_t begin = plan.prefix.size();
        const std::uint64_t plainEnd = begin + maker.points() * maker.layout().length;

        AtomicFile file(path, options.compressed ? 0 : plainEnd);
        progress.begin("Writing points", maker.points());
        Written written;
        if (options.compressed) {
            written.pointDataEnd = writeCompressed(maker, plan.laz, file, begin, progress);
        } else {
            writePlain(maker, file, begin, progress);
            written.pointDataEnd = plainEnd;
        }
        plan.setPointDataEnd(written.pointDataEnd);
        written.suffix = plan.suffix();
        written.bytes = written.pointDataEnd + written.suffix.size();
        file.writeAt(written.pointDataEnd, written.suffix);
        file.writeAt(0, plan.prefix);
        file.sync();
        if (options.verify) verify(file, plan, written, progress);
        progress.check();
        if (file.hasOtherNames())
            plan.notes.push_back("The file had other names (hard links); they keep the old contents.");
        file.commit();
        return {maker.points(), written.bytes, std::move(plan.notes)};
    } catch (const Error& e) {
        if (e.file() == path) throw;
        throw Error(path, e.file().empty() ? e.what() : std::string("The file could not be saved: ") + e.what());
    }
}

}  // namespace punctum::las
