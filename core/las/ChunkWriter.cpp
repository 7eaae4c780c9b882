// SPDX-License-Identifier: MIT
#include "core/las/ChunkWriter.h"

#include "core/Error.h"
#include "core/las/AtomicFile.h"
#include "core/las/Parallel.h"
#include "core/task/Progress.h"

#include <tbb/parallel_pipeline.h>

#include <mutex>

namespace punctum::las
{

namespace
{

constexpr std::size_t kStepBytes = 1 << 16;  ///< of records made, decoded and compared at once: stays in the cache

/// Thrown when a chunk must be compressed anew while others were copied that cannot stand beside it.
struct VersionsDiffer {
};

/// Whether the chunk decodes, to its last byte, into the records of these points.
bool holds(std::span<const std::byte> chunk, const LazInfo& laz, const RecordMaker& maker, PointRange points,
           const Progress& progress)
{
    if (laz.compressor == LazInfo::Layered && !checkLayeredChunk(chunk, laz, std::uint32_t(points.size())).empty())
        return false;
    PointDecoder decoder(laz, chunk, points.size());
    const std::uint64_t length = laz.recordLength;
    const std::uint64_t step = std::max<std::uint64_t>(1, kStepBytes / length);
    std::vector<std::byte> found(std::size_t(step * length)), meant(found.size());
    for (PointIndex i = points.first; i < points.last;) {
        progress.check();
        const std::uint64_t n = std::min(step, points.last - i);
        if (decoder.decode(std::size_t(n), found.data()) != n) return false;
        maker.make({i, i + n}, meant.data());
        if (std::memcmp(found.data(), meant.data(), std::size_t(n * length)) != 0) return false;
        i += n;
    }
    return decoder.position() == chunk.size();
}

struct Piece {
    std::size_t number = 0;
    std::vector<std::byte> bytes;
    bool copied = false;
};

class ChunkWriter
{
public:
    ChunkWriter(const RecordMaker& maker, const LazInfo& laz, const ChunkPlan& plan, AtomicFile& file,
                std::uint64_t begin, std::shared_ptr<const File> origin, Progress& progress)
        : m_maker(maker),
          m_laz(laz),
          m_plan(plan),
          m_file(file),
          m_begin(begin),
          m_origin(std::move(origin)),
          m_progress(progress)
    {
        m_written.originVersions = m_origin != nullptr && plan.allOrNone;
    }

    WrittenChunks write()
    {
        std::uint64_t offset = m_begin + sizeof(std::int64_t);
        std::size_t next = 0;
        const auto tokens = std::size_t(std::max(1, tbb::this_task_arena::max_concurrency())) * 2;
        tbb::parallel_pipeline(
            tokens,
            tbb::make_filter<void, std::size_t>(tbb::filter_mode::serial_in_order,
                                                [&](tbb::flow_control& control) {
                                                    if (next >= m_plan.chunks.size() || m_progress.cancelled())
                                                        control.stop();
                                                    return next++;
                                                }) &
                tbb::make_filter<std::size_t, std::shared_ptr<Piece>>(
                    tbb::filter_mode::parallel,
                    [&](std::size_t number) { return std::make_shared<Piece>(makePiece(number)); }) &
                tbb::make_filter<std::shared_ptr<Piece>, void>(tbb::filter_mode::serial_in_order,
                                                               [&](const std::shared_ptr<Piece>& piece) {
                                                                   put(*piece, offset);
                                                                   offset += piece->bytes.size();
                                                               }));
        m_progress.check();

        const auto position = std::int64_t(offset);
        m_file.writeAt(m_begin, std::as_bytes(std::span(&position, 1)));
        m_written.table = encodeChunkTable(m_entries, m_laz.variable());
        m_file.writeAt(offset, m_written.table);
        m_written.end = offset + m_written.table.size();
        m_written.origin = m_origin;
        return std::move(m_written);
    }

private:
    Piece makePiece(std::size_t number) const
    {
        m_progress.check();
        const PlannedChunk& chunk = m_plan.chunks[number];
        Piece piece{number, {}, false};
        if (m_origin && chunk.origin) {
            piece.bytes.resize(std::size_t(chunk.origin->bytes));
            m_origin->readAt(chunk.origin->offset, piece.bytes);
            piece.copied = holds(piece.bytes, m_plan.laz, m_maker, chunk.points, m_progress);
        }
        if (piece.copied) return piece;
        if (m_origin && m_plan.allOrNone) throw VersionsDiffer{};
        std::vector<std::byte> records(std::size_t(chunk.points.size() * m_laz.recordLength));
        m_maker.make(chunk.points, records.data());
        piece.bytes = encodeChunk(m_laz, records, m_progress);
        return piece;
    }

    void put(const Piece& piece, std::uint64_t offset)
    {
        m_progress.check();
        if (piece.bytes.size() > UINT32_MAX)
            throw Error("A chunk of compressed points is too large for the format.");
        m_file.writeAt(offset, piece.bytes);
        const std::uint64_t points = m_plan.chunks[piece.number].points.size();
        m_entries.push_back({m_laz.variable() ? std::uint32_t(points) : 0, std::uint32_t(piece.bytes.size())});
        m_written.places.push_back({offset, piece.bytes.size(), piece.copied});
        ++(piece.copied ? m_written.copied : m_written.encoded);
        m_progress.add(points);
    }

    const RecordMaker& m_maker;
    const LazInfo& m_laz;
    const ChunkPlan& m_plan;
    AtomicFile& m_file;
    std::uint64_t m_begin;
    std::shared_ptr<const File> m_origin;  ///< null: nothing is copied
    Progress& m_progress;
    std::vector<ChunkEntry> m_entries;
    WrittenChunks m_written;
};

}  // namespace

WrittenChunks writeChunks(const RecordMaker& maker, const LazInfo& laz, const ChunkPlan& plan, AtomicFile& file,
                          std::uint64_t begin, Progress& progress)
{
    const auto attempt = [&](const std::shared_ptr<const File>& origin) {
        progress.begin("Writing points", maker.points());
        return ChunkWriter(maker, laz, plan, file, begin, origin, progress).write();
    };
    const auto origin = plan.openOrigin();
    WrittenChunks written;
    try {
        written = attempt(origin);
    } catch (const VersionsDiffer&) {
        file.resize(0);
        written = attempt(nullptr);
    }
    if (origin != nullptr) origin->checkUnchanged();
    return written;
}

std::optional<PointRange> findWrongChunk(const RecordMaker& maker, const LazInfo& laz, const ChunkPlan& plan,
                                         const WrittenChunks& written, const File& file, Progress& progress)
{
    std::optional<PointRange> wrong;
    std::mutex mutex;
    forEachInOrder(plan.chunks.size(), [&](std::vector<std::byte>& scratch, std::size_t k) {
        progress.check();
        const PlannedChunk& chunk = plan.chunks[k];
        const WrittenChunks::Place& place = written.places[k];
        const auto size = std::size_t(place.bytes);
        bool good = false;
        if (place.copied) {
            scratch.resize(2 * size);
            const auto there = std::span(scratch).first(size), origin = std::span(scratch).last(size);
            file.readAt(place.offset, there);
            written.origin->readAt(chunk.origin->offset, origin);
            good = std::memcmp(there.data(), origin.data(), size) == 0;
        } else {
            scratch.resize(size);
            file.readAt(place.offset, scratch);
            good = holds(scratch, laz, maker, chunk.points, progress);
        }
        progress.add(chunk.points.size());
        const std::lock_guard lock(mutex);
        if (!good && (!wrong || chunk.points.first < wrong->first)) wrong = chunk.points;
    });
    return wrong;
}

}  // namespace punctum::las
