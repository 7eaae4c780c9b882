// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/SourceFile.h"

#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace punctum
{
class Progress;
}

namespace punctum::las
{

/// What came of reading the points.
struct ReadResult {
    std::vector<std::string> warnings;  ///< one sentence each
    std::vector<PointRange> missing;    ///< points that could not be read (damaged chunks); their values are 0
    RawBounds bounds;                   ///< of the points read
};

class FolderLeftovers;
struct ParseOptions;

/// Reads one LAS or LAZ file.
///
/// Example:
///     const auto reader = las::Reader::open("a.laz");
///     const auto cloud = reader->createCloud();
///     reader->read(*cloud, progress, [&](PointRange r) { store.fill(r); });
///
/// Every size, count and offset in the file is checked before it is used; whatever the file holds, the result is
/// an Error, a warning or points. The file is read by pread, so that a file that shrinks meanwhile is an Error and
/// not a crash. Destroying the reader closes the file.
class Reader
{
public:
    /// Reads header, VLRs, EVLRs and the chunk table, no points but a few for a first idea of the extent.
    /// Throws Error.
    static std::unique_ptr<Reader> open(const std::filesystem::path& path);
    /// Likewise, for many files: what killed saves left beside the file is looked for by `leftovers`, once a
    /// folder; null: not at all.
    static std::unique_ptr<Reader> open(const std::filesystem::path& path, FolderLeftovers* leftovers);
    /// Likewise. Where the options let it believe a header's count, read() tells where that was wrong: points that
    /// are not there are missing then, and a file that holds more than it says is an Error.
    static std::unique_ptr<Reader> open(const std::filesystem::path& path, FolderLeftovers* leftovers,
                                        const ParseOptions& options);
    ~Reader();
    Reader(const Reader&) = delete;
    Reader& operator=(const Reader&) = delete;

    const std::shared_ptr<const SourceFile>& source() const noexcept { return m_source; }

    /// Closes the file, and opens it again to go on: of thousands, the system keeps only some open. One thread.
    /// Reopening throws Error when the file is not there, or not the same any more.
    void close() noexcept;
    void reopen();

    /// A cloud with the file's columns and attributes, all points unread. Throws Error (memory).
    std::shared_ptr<PointCloud> createCloud() const;

    /// Called from worker threads, several at once, each time the points of a range have arrived in the
    /// columns (while they are still in the processor's cache); each point is in exactly one range.
    using BatchSink = std::function<void(PointRange)>;

    /// Chunks (LAS: rows of records) all over a file: so many at most, or of the order in which they are read those
    /// from one turn to another.
    struct Pieces {
        std::size_t count = 0;
        std::size_t first = 0, last = SIZE_MAX;
    };

    /// Reads the first `points` points of chunks into the cloud's columns, in parallel, from all over the file: a
    /// picture of the whole, long before read() has come everywhere, as LidarScout (Erler et al. 2025) draws one of
    /// the first points of chunks. Chunks that are damaged, cut off or short, or cannot be read, are left out. The
    /// boxes of the cloud do not have these points yet. `sink` is told of them; returns where they are, in the
    /// order of the file, for read(). Throws Error (a cloud that is not the file's) or Cancelled.
    std::vector<PointRange> readFirsts(PointCloud& cloud, const Pieces& pieces, std::uint64_t points,
                                       Progress& progress, const BatchSink& sink) const;

    /// Reads all points into the cloud's columns, in parallel, in an order spread over the file, and includes them
    /// into its boxes (PointCloud::arriving()), each batch before the sink is told of it. Those that readFirsts()
    /// has given already are not written once more, but the sink is told of them like of all others; where their
    /// chunk turns out to be damaged, they are among `missing`, and 0. Throws Error (I/O) or Cancelled.
    ReadResult read(PointCloud& cloud, Progress& progress, const BatchSink& sink = {},
                    std::span<const PointRange> firsts = {}) const;

    // -- the same piece by piece

    /// How many pieces a reading has: chunks, or rows of records.
    std::size_t pieces() const;
    PointRange pointsOf(std::size_t piece) const;
    /// All pieces in the order in which read() takes them; `firsts`: readFirsts() has given some.
    std::vector<std::uint32_t> order(bool firsts) const;
    /// What a thread keeps from piece to piece of one file.
    class Worker
    {
    public:
        Worker();
        ~Worker();
        Worker(const Worker&) = delete;
        Worker& operator=(const Worker&) = delete;

    private:
        friend class Reader;
        struct Impl;
        std::unique_ptr<Impl> m_impl;
    };
    /// A read() whose pieces come in any order, from any threads.
    class Reading
    {
    public:
        /// As read(). All of this must outlive it. Throws Error (a cloud that is not the file's).
        Reading(const Reader& reader, PointCloud& cloud, Progress& progress, BatchSink sink,
                std::span<const PointRange> firsts);
        ~Reading();
        Reading(const Reading&) = delete;
        Reading& operator=(const Reading&) = delete;
        /// Each piece once. Several threads at a time, each with a worker of its own, while the file is open.
        /// Throws Error (I/O), Cancelled.
        void read(std::size_t piece, Worker& worker);
        /// When all pieces have been read, while the file is open: what read() returns. Throws Error (the file was
        /// changed), Cancelled.
        ReadResult finish();

    private:
        struct Impl;
        std::unique_ptr<Impl> m_impl;
    };

    /// Called from worker threads, several at once, with the raw records of a range, one after another.
    using RecordVisitor = std::function<void(PointRange, std::span<const std::byte>)>;

    /// Goes through all points as the file's own records (layout.length bytes each, decompressed), in parallel, in
    /// the same order, for comparing files. A damaged chunk may be found out when some of its records have been
    /// given: those in the result's `missing` mean nothing. `bounds` is not computed.
    /// Throws Error (I/O), Cancelled or what `visit` throws.
    ReadResult visitRecords(Progress& progress, const RecordVisitor& visit) const;

private:
    struct Impl;
    Reader(std::unique_ptr<Impl> impl, std::shared_ptr<const SourceFile> source);
    std::unique_ptr<Impl> m_impl;
    std::shared_ptr<const SourceFile> m_source;
};

/// Opens and reads in one call, for the command line and tests. Warnings of both steps are returned in `result`.
std::shared_ptr<PointCloud> load(const std::filesystem::path& path, Progress& progress,
                                 ReadResult* result = nullptr);

}  // namespace punctum::las
