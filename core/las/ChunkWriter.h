// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/ChunkPlan.h"
#include "core/las/WritePlan.h"

#include <vector>

namespace punctum::las
{

class AtomicFile;

/// What became of the chunks of a plan.
struct WrittenChunks {
    struct Place {
        std::uint64_t offset = 0;
        std::uint64_t bytes = 0;
        bool copied = false;
    };
    std::vector<Place> places;  ///< one for each planned chunk
    std::uint64_t end = 0;      ///< first byte after the table
    std::vector<std::byte> table;
    std::uint64_t copied = 0;
    std::uint64_t encoded = 0;
    std::shared_ptr<const File> origin;  ///< that chunks were copied from; null: none were
    bool originVersions = false;  ///< the items have the versions of the plan's file, not LASzip's present ones
};

/// Writes position, chunks and table from `begin` on. A chunk whose origin decodes to exactly the records that the
/// cloud has now is copied; others are compressed, in parallel, and written in order. Throws Error or Cancelled.
WrittenChunks writeChunks(const RecordMaker& maker, const LazInfo& laz, const ChunkPlan& plan, AtomicFile& file,
                          std::uint64_t begin, Progress& progress);

/// Whether the chunks in `file` hold what they should: a copied one the bytes of its origin (which were decoded and
/// compared before they were copied), another one, decoded, the records of the cloud. Gives the points of the first
/// chunk found that does not. Throws Error (I/O) or Cancelled.
std::optional<PointRange> findWrongChunk(const RecordMaker& maker, const LazInfo& laz, const ChunkPlan& plan,
                                         const WrittenChunks& written, const File& file, Progress& progress);

}  // namespace punctum::las
