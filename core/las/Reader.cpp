// SPDX-License-Identifier: MIT
#include "core/las/Reader.h"

#include "core/Error.h"
#include "core/Text.h"
#include "core/cloud/BlockBoxes.h"
#include "core/cloud/Residency.h"
#include "core/las/ChunkProbe.h"
#include "core/las/Compatible.h"
#include "core/las/ExtraBytesRange.h"
#include "core/las/File.h"
#include "core/las/FormatNeeds.h"
#include "core/las/Leftovers.h"
#include "core/las/Parallel.h"
#include "core/las/RecordBlocks.h"
#include "core/las/SourceParser.h"
#include "core/task/Progress.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <bit>
#include <optional>

namespace punctum::las
{

namespace
{

constexpr std::size_t kReadBytes = std::size_t(5) << 17;  ///< LAS: read at once by a thread; stays in its L2 cache
constexpr std::size_t kSliceBytes = std::size_t(1) << 18;
constexpr std::uint64_t kSlicePoints = 64;       ///< whole cache lines in each column
constexpr std::uint64_t kMostInBlock = 1 << 14;  ///< points, LAS
/// LAS: blocks that a thread reads in a row, because points of neighboring blocks share cache lines where they go.
constexpr std::uint64_t kRowOfBlocks = 4;
constexpr std::size_t kRowOfChunks = 16;  ///< LAZ: chunks read one after another, where first points are known
constexpr std::uint64_t kMostInBatch = 1 << 16;  ///< points handed on at once, LAZ
constexpr std::size_t kMostWarnings = 10;        ///< of damaged chunks, one sentence each
constexpr std::uint64_t kDecodeStep = 2048;      ///< points between two looks at the cancel flag
constexpr std::uint64_t kDecodeBytes = 1 << 17;  ///< LAZ: of records at once, to leave the cache to the models

constexpr PointIndex kFirstsRow = 1 << 16;    ///< LAS: records from one place of readFirsts() to the next
constexpr std::uint64_t kTouchedPage = 4096;  ///< bytes of memory that come with some points in a column
constexpr std::uint64_t kMostGrowth = 64;     ///< bytes that a record may have more than before it was compressed

/// What is done with points as they come, by the worker that has them.
struct Receiver {
    Reader::RecordVisitor records;              ///< raw records, in pieces that are still in the cache
    std::function<void(PointRange)> arrived;    ///< a batch whose records were all given or known, and are sound
    std::function<void(PointRange)> withdrawn;  ///< records that were given, but are damaged after all
    std::span<const PointRange> known = {};     ///< points that are not given again, in order
};

/// What the workers of one reading share.
struct Shared {
    Progress& progress;
    const Receiver& receiver;
    std::mutex mutex;
    std::vector<std::pair<PointRange, std::string>> missing;  ///< with a sentence

    /// Where, from `first` on, the points begin that were not known before.
    PointIndex knownUntil(PointIndex first) const
    {
        const auto after = std::upper_bound(receiver.known.begin(), receiver.known.end(), first,
                                            [](PointIndex i, const PointRange& range) { return i < range.first; });
        return after == receiver.known.begin() ? first : std::max(first, std::prev(after)->last);
    }
    /// Hands on the records of a range, but for those known before.
    void give(PointRange range, PointIndex fresh, std::span<const std::byte> records) const
    {
        const PointIndex first = std::max(range.first, fresh);
        if (first >= range.last) return;
        const std::size_t length = records.size() / std::size_t(range.size());
        receiver.records({first, range.last}, records.subspan(std::size_t(first - range.first) * length));
    }
    void miss(PointRange range, std::string sentence)
    {
        const std::lock_guard lock(mutex);
        missing.emplace_back(range, std::move(sentence));
    }
    /// In the order of the file, the first ones with a sentence each.
    ReadResult finish()
    {
        std::sort(missing.begin(), missing.end(),
                  [](const auto& a, const auto& b) { return a.first.first < b.first.first; });
        ReadResult result;
        std::uint64_t untold = 0;
        for (const auto& [range, sentence] : missing) {
            result.missing.push_back(range);
            if (result.warnings.size() < kMostWarnings)
                result.warnings.push_back(sentence);
            else
                untold += range.size();
        }
        if (untold != 0)
            result.warnings.push_back("Further points that are damaged and could not be read: " + grouped(untold) +
                                      ".");
        return result;
    }
};

/// Powers of two: whole groups of those who deal the points out, and of 64, which share the words of sets.
std::uint64_t blockPoints(const SourceFile& s)
{
    const std::uint64_t length = s.layout.length;
    std::uint64_t block = std::bit_floor(std::clamp<std::uint64_t>(kReadBytes / length, 64, kMostInBlock));
    while (s.pointCount / block / kRowOfBlocks >= UINT32_MAX) block *= 2;
    return block;
}

}  // namespace

struct Reader::Impl {
    File file;
    ParsedFile parsed;

    std::uint64_t rowPoints() const;
    std::size_t pieces() const;
    PointRange pointsOf(std::size_t piece) const;
    std::vector<std::uint32_t> order(bool firsts) const;
    void visitBlock(PointRange block, std::vector<std::byte>& scratch, Shared& shared) const;
    /// What a worker keeps from chunk to chunk.
    struct ChunkWorker {
        std::vector<std::byte> data, records;
        std::unique_ptr<PointDecoder> decoder;
    };
    /// Where a chunk turned out not to hold what it should.
    struct Trouble {
        std::string why;
        PointIndex arrived = 0;    ///< first point that has not arrived
        PointIndex given = 0;      ///< first point that was not given, or known
        std::uint64_t undone = 0;  ///< points that the progress has not counted
    };
    void visitPiece(std::size_t piece, ChunkWorker& worker, Shared& shared) const;
    void visitChunk(const Chunk& chunk, ChunkWorker& worker, Shared& shared) const;
    std::optional<Trouble> tryChunk(const Chunk& chunk, ChunkWorker& worker, Shared& shared) const;
    static void lose(const Chunk& chunk, const Trouble& trouble, Shared& shared);
    bool recount(const Chunk& chunk, const Trouble& trouble, ChunkWorker& worker, Shared& shared) const;
    void visitStream(const Chunk& chunk, std::vector<std::byte>& scratch, Shared& shared) const;
    std::optional<Trouble> decode(PointDecoder& decoder, const Chunk& chunk, const std::function<bool()>& whole,
                                  std::vector<std::byte>& scratch, Shared& shared) const;
    ReadResult visit(Progress& progress, const Receiver& receiver) const;
    PointRange readPiece(std::uint64_t piece, std::uint64_t points, ChunkWorker& worker) const;
    bool firstsOfChunk(const Chunk& chunk, std::uint64_t points, ChunkWorker& worker) const;
};

Reader::Reader(std::unique_ptr<Impl> impl, std::shared_ptr<const SourceFile> source)
    : m_impl(std::move(impl)), m_source(std::move(source))
{
}

Reader::~Reader() = default;

std::unique_ptr<Reader> Reader::open(const std::filesystem::path& path)
{
    FolderLeftovers leftovers;
    return open(path, &leftovers);
}

std::unique_ptr<Reader> Reader::open(const std::filesystem::path& path, FolderLeftovers* leftovers)
{
    return open(path, leftovers, ParseOptions());
}

std::unique_ptr<Reader> Reader::open(const std::filesystem::path& path, FolderLeftovers* leftovers,
                                     const ParseOptions& options)
{
    File file(path);
    ParsedFile parsed;
    try {
        parsed = parseFile(file, options);
    } catch (const Error& e) {
        if (!e.file().empty()) throw;
        throw Error(path, e.what());
    }
    auto source = parsed.source;
    if (leftovers != nullptr)
        for (std::string& sentence : leftovers->of(path)) source->warnings.push_back(std::move(sentence));
    auto impl = std::make_unique<Impl>(Impl{std::move(file), std::move(parsed)});
    return std::unique_ptr<Reader>(new Reader(std::move(impl), std::move(source)));
}

void Reader::close() noexcept
{
    m_impl->file.close();
}

void Reader::reopen()
{
    m_impl->file.reopen();
}

std::shared_ptr<PointCloud> Reader::createCloud() const
{
    auto cloud = std::make_shared<PointCloud>(m_source->pointCount, m_source->coordinates);
    makeColumns(*cloud, m_source->layout);
    cloud->setUnits(m_source->units);
    cloud->setSource(m_source);
    cloud->setArriving(std::make_shared<BlockBoxes>(cloud->size()));
    return cloud;
}

/// LAS: points that are one piece, but for the last one.
std::uint64_t Reader::Impl::rowPoints() const
{
    return blockPoints(*parsed.source) * kRowOfBlocks;
}

std::size_t Reader::Impl::pieces() const
{
    if (parsed.source->compressed) return parsed.chunks.size();
    const std::uint64_t row = rowPoints();
    return std::size_t((parsed.source->pointCount + row - 1) / row);
}

PointRange Reader::Impl::pointsOf(std::size_t piece) const
{
    if (parsed.source->compressed) {
        const Chunk& chunk = parsed.chunks[piece];
        return {chunk.first, chunk.first + chunk.count};
    }
    const std::uint64_t row = rowPoints();
    return {piece * row, std::min((piece + 1) * row, parsed.source->pointCount)};
}

/// Where some points of all of the file are there already, neighboring chunks come one after another: they share
/// pages of what is drawn of them, which may lie beyond memory.
std::vector<std::uint32_t> Reader::Impl::order(bool firsts) const
{
    const std::size_t count = pieces(), row = firsts && parsed.source->compressed ? kRowOfChunks : 1;
    if (parsed.source->copc) return parsed.source->copc->chunksByLevel();
    std::vector<std::uint32_t> order;
    order.reserve(count);
    for (const std::uint32_t first : spreadOrder(std::uint32_t((count + row - 1) / row)))
        for (std::size_t k = first * row; k < std::min(count, (first + 1) * row); ++k)
            order.push_back(std::uint32_t(k));
    return order;
}

void Reader::Impl::visitPiece(std::size_t piece, ChunkWorker& worker, Shared& shared) const
{
    shared.progress.check();
    if (parsed.source->compressed) {
        const Chunk& chunk = parsed.chunks[piece];
        if (parsed.laz.compressor == LazInfo::Pointwise)
            visitStream(chunk, worker.records, shared);
        else
            visitChunk(chunk, worker, shared);
        return;
    }
    const std::uint64_t block = blockPoints(*parsed.source);
    const PointRange row = pointsOf(piece);
    for (PointIndex first = row.first; first < row.last; first += block)
        visitBlock({first, std::min(first + block, row.last)}, worker.records, shared);
}

/// Reads in slices, so that records, columns and what is made of them fit the cache together.
void Reader::Impl::visitBlock(PointRange block, std::vector<std::byte>& scratch, Shared& shared) const
{
    shared.progress.check();
    const SourceFile& s = *parsed.source;
    const std::uint64_t length = s.layout.length;
    const std::uint64_t slice =
        std::min(block.size(), std::max<std::uint64_t>(1, kSliceBytes / length / kSlicePoints) * kSlicePoints);
    scratch.resize(std::size_t(slice * length));
    const PointIndex fresh = shared.knownUntil(block.first);
    for (PointIndex first = block.first; first < block.last; first += slice) {
        const PointRange part{first, std::min(first + slice, block.last)};
        const auto records = std::span(scratch).first(std::size_t(part.size() * length));
        file.readAt(s.header.pointOffset() + part.first * length, records);
        shared.give(part, fresh, records);
    }
    shared.receiver.arrived(block);
    shared.progress.add(block.size());
}

/// Decodes a chunk batch by batch. `whole` tells, once all is decoded, whether its bytes are; empty where they
/// cannot be. Where the chunk's end tells whether it is sound, none of its points have arrived before all are
/// decoded: bytes that are not what was written give points that never were, long before a decoder fails. So all
/// are missing then; of others those of the batch that fails, and all later ones.
auto Reader::Impl::decode(PointDecoder& decoder, const Chunk& chunk, const std::function<bool()>& whole,
                          std::vector<std::byte>& scratch, Shared& shared) const -> std::optional<Trouble>
{
    const std::uint64_t length = parsed.source->layout.length;
    const std::uint64_t step = std::clamp<std::uint64_t>(kDecodeBytes / length, 1, kDecodeStep);
    scratch.resize(std::size_t(step * length));
    const PointIndex fresh = shared.knownUntil(chunk.first);
    std::uint64_t arrived = 0;
    const auto arrive = [&](std::uint64_t end) {
        for (; arrived < end; arrived += std::min(end - arrived, kMostInBatch))
            shared.receiver.arrived({chunk.first + arrived, chunk.first + std::min(end, arrived + kMostInBatch)});
    };
    for (std::uint64_t done = 0; done < chunk.count;) {
        const std::uint64_t batch = std::min(chunk.count - done, kMostInBatch);
        const PointIndex first = chunk.first + done;
        std::string trouble;
        std::uint64_t given = 0;
        while (given < batch && trouble.empty()) {
            shared.progress.check();
            const std::uint64_t n = std::min(step, batch - given);
            if (decoder.decode(std::size_t(n), scratch.data()) != n) {
                trouble = decoder.error();
            } else {
                shared.give({first + given, first + given + n}, fresh,
                            std::span(scratch).first(std::size_t(n * length)));
                given += n;
            }
        }
        // A chunk that decodes into fewer or more bytes than it has holds something else than its points.
        if (trouble.empty() && whole && done + batch == chunk.count) {
            if (decoder.position() != chunk.bytes)
                trouble = "its end is not where it should be";
            else if (!whole())
                trouble = "it has zeros in place of its bytes";
        }
        if (!trouble.empty())
            return Trouble{trouble, chunk.first + arrived, std::max(first + given, fresh), chunk.count - done};
        done += batch;
        if (!whole || done == chunk.count) arrive(done);
        shared.progress.add(batch);
    }
    return {};
}

/// Points of a damaged chunk are taken back, and missing.
void Reader::Impl::lose(const Chunk& chunk, const Trouble& trouble, Shared& shared)
{
    shared.receiver.withdrawn({trouble.arrived, trouble.given});
    const PointRange lost{trouble.arrived, chunk.first + chunk.count};
    shared.miss(lost, "The points " + grouped(lost.first) + " to " + grouped(lost.last - 1) +
                          " are damaged and could not be read (" + trouble.why + ").");
    shared.progress.add(trouble.undone);
}

void Reader::Impl::visitChunk(const Chunk& chunk, ChunkWorker& worker, Shared& shared) const
{
    const std::optional<Trouble> trouble = tryChunk(chunk, worker, shared);
    if (!trouble || (parsed.unproved && recount(chunk, *trouble, worker, shared))) return;
    lose(chunk, *trouble, shared);
}

/// Where the file's only chunk is sound but for the number of its points, which nobody has proved: gives those that
/// are there. False where it is damaged.
bool Reader::Impl::recount(const Chunk& chunk, const Trouble& trouble, ChunkWorker& worker, Shared& shared) const
{
    const std::uint64_t found = ChunkProbe(file, parsed.laz).pointsUntilEnd(chunk);
    if (found == 0 || found == chunk.count) return false;
    const std::string sentence =
        "The header says " + grouped(chunk.count) + " points, the file holds " + grouped(found);
    shared.receiver.withdrawn({std::min(found, trouble.given), trouble.given});
    if (found > chunk.count) throw Error(file.path(), sentence + "; open it by itself to see them.");
    Chunk there = chunk;
    there.count = found;
    if (tryChunk(there, worker, shared)) return false;
    shared.miss({found, chunk.count}, sentence + ".");
    return true;
}

auto Reader::Impl::tryChunk(const Chunk& chunk, ChunkWorker& worker, Shared& shared) const -> std::optional<Trouble>
{
    worker.data.resize(std::size_t(chunk.bytes));
    file.readAt(chunk.offset, worker.data);
    if (parsed.laz.compressor == LazInfo::Layered) {
        const std::string why = checkLayeredChunk(worker.data, parsed.laz, std::uint32_t(chunk.count));
        if (!why.empty()) return Trouble{why, chunk.first, shared.knownUntil(chunk.first), chunk.count};
    }
    if (worker.decoder)
        worker.decoder->restart(worker.data);
    else
        worker.decoder = std::make_unique<PointDecoder>(parsed.laz, worker.data, chunk.count);
    const auto whole = [&] {
        return worker.decoder->own() == nullptr ||
               wholeChunk(parsed.laz, worker.data, chunk.count, *worker.decoder);
    };
    auto trouble =
        decode(*worker.decoder, chunk, chunk.cut ? std::function<bool()>() : whole, worker.records, shared);
    if (trouble || !worker.decoder->reusable()) worker.decoder.reset();
    return trouble;
}

void Reader::Impl::visitStream(const Chunk& chunk, std::vector<std::byte>& scratch, Shared& shared) const
{
    PointDecoder decoder(parsed.laz, file, chunk.offset, chunk.bytes, chunk.count);
    if (const auto trouble = decode(decoder, chunk, {}, scratch, shared)) lose(chunk, *trouble, shared);
}

ReadResult Reader::Impl::visit(Progress& progress, const Receiver& receiver) const
{
    Shared shared{progress, receiver, {}, {}};
    const std::vector<std::uint32_t> turns = order(false);
    forEachInOrder<ChunkWorker>(
        turns.size(), [&](ChunkWorker& worker, std::size_t turn) { visitPiece(turns[turn], worker, shared); });
    progress.check();
    file.checkUnchanged();
    return shared.finish();
}

/// Reads the first records of a piece, as readFirsts() counts them, into the worker's; returns which points they
/// are, none where they cannot be had.
PointRange Reader::Impl::readPiece(std::uint64_t piece, std::uint64_t points, ChunkWorker& worker) const
{
    try {
        if (parsed.source->compressed) {
            const Chunk& chunk = parsed.chunks[std::size_t(piece)];
            // one of which all points came would seem read
            if (chunk.cut || chunk.count < 2 * points || !firstsOfChunk(chunk, points, worker)) return {};
            return {chunk.first, chunk.first + points};
        }
        const PointIndex first = piece * kFirstsRow;
        const PointRange range{first, first + std::min(points, kFirstsRow / 2)};
        const std::uint64_t length = parsed.source->layout.length;
        worker.records.resize(std::size_t(range.size() * length));
        file.readAt(parsed.source->header.pointOffset() + first * length, worker.records);
        return range;
    } catch (const Error&) {
        return {};  // read() tells of it
    }
}

/// Decodes the first points of a chunk into the worker's records; false where they are damaged. Of a pointwise
/// chunk no more bytes are read than they can take; of one in layers all, since each layer has some of theirs.
bool Reader::Impl::firstsOfChunk(const Chunk& chunk, std::uint64_t points, ChunkWorker& worker) const
{
    const std::uint64_t length = parsed.source->layout.length;
    const bool layered = parsed.laz.compressor == LazInfo::Layered;
    worker.data.resize(
        std::size_t(layered ? chunk.bytes : std::min(chunk.bytes, points * (length + kMostGrowth) + kMostGrowth)));
    file.readAt(chunk.offset, worker.data);
    if (layered && !checkLayeredChunk(worker.data, parsed.laz, std::uint32_t(chunk.count)).empty()) return false;
    if (worker.decoder)
        worker.decoder->restart(worker.data);
    else
        worker.decoder = std::make_unique<PointDecoder>(parsed.laz, worker.data, chunk.count);
    worker.records.resize(std::size_t(points * length));
    const bool decoded = worker.decoder->decode(std::size_t(points), worker.records.data()) == points;
    if (!decoded || !worker.decoder->reusable()) worker.decoder.reset();
    return decoded;
}

ReadResult Reader::visitRecords(Progress& progress, const RecordVisitor& visit) const
{
    return m_impl->visit(progress, {visit, [](PointRange) {}, [](PointRange) {}});
}

namespace
{

void checkFits(const PointCloud& cloud, const SourceFile& source)
{
    const std::size_t columns = source.layout.fields.size() + source.layout.derived.size();
    if (cloud.size() != source.pointCount || cloud.columns().size() < columns)
        throw Error(source.path, "The points do not fit the cloud they are read into.");
}

/// Puts the records of a range into the cloud's columns.
void putRecords(PointCloud& cloud, const RecordLayout& layout, const Deinterleaver& deinterleave, PointRange range,
                std::span<const std::byte> records)
{
    std::vector<std::byte*> columns(layout.fields.size() + layout.derived.size());
    for (std::size_t k = 0; k < columns.size(); ++k)
        columns[k] = cloud.columns()[k]->data() + range.first * layout.field(std::int32_t(k)).bytes();
    deinterleave(records.data(), std::size_t(range.size()), std::span(columns).first(layout.fields.size()));
    decodeCompatible(layout, columns, std::size_t(range.size()));
}

/// Points have been read and handed on: where their columns lie beyond memory, nobody needs them at once.
void leaveColumns(const PointCloud& cloud, const RecordLayout& layout, PointRange range)
{
    for (std::size_t k = 0; k < layout.fields.size() + layout.derived.size(); ++k) {
        const std::size_t bytes = layout.field(std::int32_t(k)).bytes();
        Residency::instance().leave(cloud.columns()[k]->data() + range.first * bytes,
                                    std::size_t(range.size()) * bytes);
    }
}

/// Extent and returns of the points of one thread.
struct Seen {
    RawBounds bounds;
    std::array<std::uint64_t, 16> byReturn{};
    TimeExtent times;

    void include(const RawBounds& part, const std::uint8_t* returns, std::size_t n, std::uint8_t mask)
    {
        bounds.include(part);
        // Four tables: neighbors often have the same value, and must not wait for each other.
        std::uint32_t counts[4][256] = {};
        std::size_t i = 0;
        for (; i + 4 <= n; i += 4)
            for (std::size_t k = 0; k < 4; ++k) ++counts[k][returns[i + k]];
        for (; i < n; ++i) ++counts[0][returns[i]];
        for (unsigned v = 0; v < 256; ++v)
            byReturn[v & mask] += std::uint64_t(counts[0][v]) + counts[1][v] + counts[2][v] + counts[3][v];
    }
};

}  // namespace

std::vector<PointRange> Reader::readFirsts(PointCloud& cloud, const Pieces& pieces, std::uint64_t points,
                                           Progress& progress, const BatchSink& sink) const
{
    checkFits(cloud, *m_source);
    // LASzip takes a stream apart from its beginning alone.
    const bool compressed = m_source->compressed;
    if (compressed && m_impl->parsed.laz.compressor == LazInfo::Pointwise) return {};
    const std::uint64_t there =
        compressed ? m_impl->parsed.chunks.size() : std::uint64_t(m_source->pointCount / kFirstsRow);
    const auto count = std::uint32_t(std::min<std::uint64_t>({there, pieces.count, UINT32_MAX}));
    const Deinterleaver deinterleave(m_source->layout);
    const std::vector<std::uint32_t> order = spreadOrder(count);
    // the coarse nodes of an octree are the picture of the whole
    const auto byLevel = m_source->copc ? m_source->copc->chunksByLevel() : std::vector<std::uint32_t>();
    std::vector<PointRange> found(count);
    const std::size_t first = std::min<std::size_t>(pieces.first, count);
    const std::size_t last = std::clamp<std::size_t>(pieces.last, first, count);
    forEachInOrder<Impl::ChunkWorker>(last - first, [&](Impl::ChunkWorker& worker, std::size_t k) {
        progress.check();
        const std::size_t turn = first + k;
        const std::uint64_t piece =
            byLevel.empty() ? std::uint64_t(order[turn]) * there / count : std::uint64_t(byLevel[turn]);
        const PointRange range = m_impl->readPiece(piece, points, worker);
        if (range.empty()) return;
        putRecords(cloud, m_source->layout, deinterleave, range, worker.records);
        found[order[turn]] = range;
        sink(range);
        Residency::instance().keepUp(cloud.columns().size() * kTouchedPage);
    });
    std::erase_if(found, [](const PointRange& range) { return range.empty(); });
    std::sort(found.begin(), found.end(), [](PointRange a, PointRange b) { return a.first < b.first; });
    return found;
}

std::size_t Reader::pieces() const
{
    return m_impl->pieces();
}

PointRange Reader::pointsOf(std::size_t piece) const
{
    return m_impl->pointsOf(piece);
}

std::vector<std::uint32_t> Reader::order(bool firsts) const
{
    return m_impl->order(firsts);
}

// -- reading piece by piece

struct Reader::Worker::Impl {
    Reader::Impl::ChunkWorker own;
};

Reader::Worker::Worker() : m_impl(std::make_unique<Impl>()) {}

Reader::Worker::~Worker() = default;

struct Reader::Reading::Impl {
    const Reader& reader;
    PointCloud& cloud;
    Progress& progress;
    BatchSink sink;
    Deinterleaver deinterleave;
    std::size_t returnsField;
    std::uint8_t returnMask;
    tbb::enumerable_thread_specific<Seen> seen{};
    // A cloud that keeps no boxes of its own, such as a part of a larger one, has bounds all the same.
    std::optional<BlockBoxes> passing{};
    std::shared_ptr<const Column> times{};  ///< where their range is noted
    Receiver receiver{};
    Shared shared{progress, receiver, {}, {}};

    RawBounds include(PointRange range)
    {
        BlockBoxes& boxes = passing ? *passing : *cloud.arriving();
        return boxes.include(range, cloud.rawX().data() + range.first, cloud.rawY().data() + range.first,
                             cloud.rawZ().data() + range.first);
    }
    void arrived(PointRange range)
    {
        const auto* returns = reinterpret_cast<const std::uint8_t*>(cloud.columns()[returnsField]->data());
        seen.local().include(include(range), returns + range.first, std::size_t(range.size()), returnMask);
        if (times) seen.local().times.include(times->values<double>().subspan(range.first, range.size()));
        if (sink) sink(range);
        leaveColumns(cloud, reader.source()->layout, range);
        Residency::instance().keepUp(range.size() * reader.source()->layout.length);
    }
    void withdrawn(PointRange range) const
    {
        const RecordLayout& layout = reader.source()->layout;
        for (std::size_t k = 0; k < layout.fields.size() + layout.derived.size(); ++k) {
            const std::size_t bytes = layout.field(std::int32_t(k)).bytes();
            std::memset(cloud.columns()[k]->data() + range.first * bytes, 0, std::size_t(range.size()) * bytes);
        }
    }
};

Reader::Reading::Reading(const Reader& reader, PointCloud& cloud, Progress& progress, BatchSink sink,
                         std::span<const PointRange> firsts)
{
    const SourceFile& source = *reader.source();
    checkFits(cloud, source);
    m_impl.reset(new Impl{reader, cloud, progress, std::move(sink), Deinterleaver(source.layout),
                          std::size_t(source.layout.returnsColumn()),
                          std::uint8_t(isExtendedFormat(source.layout.shownFormat()) ? 15 : 7)});
    if (cloud.arriving() == nullptr) m_impl->passing.emplace(cloud.size());
    Impl& impl = *m_impl;
    if (source.copc) impl.times = findColumn(cloud, "GpsTime");
    impl.receiver.known = firsts;
    impl.receiver.records = [&impl](PointRange range, std::span<const std::byte> records) {
        putRecords(impl.cloud, impl.reader.source()->layout, impl.deinterleave, range, records);
    };
    impl.receiver.arrived = [&impl](PointRange range) { impl.arrived(range); };
    impl.receiver.withdrawn = [&impl](PointRange range) { impl.withdrawn(range); };
}

Reader::Reading::~Reading() = default;

void Reader::Reading::read(std::size_t piece, Worker& worker)
{
    m_impl->reader.m_impl->visitPiece(piece, worker.m_impl->own, m_impl->shared);
}

ReadResult Reader::Reading::finish()
{
    Progress& progress = m_impl->progress;
    PointCloud& cloud = m_impl->cloud;
    const SourceFile& source = *m_impl->reader.source();
    progress.check();
    m_impl->reader.m_impl->file.checkUnchanged();
    ReadResult result = m_impl->shared.finish();
    for (const PointRange& range : result.missing) m_impl->include(range);

    PointsAsRead summary;
    for (const Seen& s : m_impl->seen) {
        summary.bounds.include(s.bounds);
        for (std::size_t k = 0; k < 16; ++k) summary.byReturn[k] += s.byReturn[k];
        summary.times.include(s.times);
    }
    summary.complete = true;
    summary.missing = result.missing;
    if (source.header.versionMinor() >= 5)
        summary.gps = gpsRange(cloud, readable(cloud.size(), result.missing), progress);
    summary.extra = extraBytesRanges(cloud, source, readable(cloud.size(), result.missing), progress);
    result.bounds = summary.bounds;
    source.asRead->set(std::move(summary));
    return result;
}

ReadResult Reader::read(PointCloud& cloud, Progress& progress, const BatchSink& sink,
                        std::span<const PointRange> firsts) const
{
    Reading reading(*this, cloud, progress, sink, firsts);
    progress.begin("Reading points", m_source->pointCount);
    const std::vector<std::uint32_t> turns = order(!firsts.empty());
    forEachInOrder<Worker>(turns.size(),
                           [&](Worker& worker, std::size_t turn) { reading.read(turns[turn], worker); });
    return reading.finish();
}

std::shared_ptr<PointCloud> load(const std::filesystem::path& path, Progress& progress, ReadResult* result)
{
    const auto reader = Reader::open(path);
    auto cloud = reader->createCloud();
    ReadResult read = reader->read(*cloud, progress);
    if (result != nullptr) {
        const auto& opened = reader->source()->warnings;
        read.warnings.insert(read.warnings.begin(), opened.begin(), opened.end());
        *result = std::move(read);
    }
    return cloud;
}

}  // namespace punctum::las
