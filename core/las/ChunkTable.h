// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/ChunkCodec.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace punctum::las
{

class File;

/// Compressed points that can be decoded on their own.
struct Chunk {
    std::uint64_t offset = 0;  ///< in the file
    std::uint64_t bytes = 0;
    PointIndex first = 0;
    std::uint64_t count = 0;
    bool cut = false;  ///< the file ends inside: only `count` points are there, and the end cannot be checked
    friend bool operator==(const Chunk&, const Chunk&) = default;
};

/// An entry of the chunk table as it is stored.
struct ChunkEntry {
    std::uint32_t count = 0;  ///< points; 0 where all chunks have the same
    std::uint32_t bytes = 0;
    friend bool operator==(const ChunkEntry&, const ChunkEntry&) = default;
};

/// The table's bytes (version, number, entries through the range coder), as LASzip writes them.
std::vector<std::byte> encodeChunkTable(std::span<const ChunkEntry> entries, bool variable);
/// Entries of the table that begins at data[0]; nothing when it cannot be one. At most `maxEntries`.
std::optional<std::vector<ChunkEntry>> decodeChunkTable(std::span<const std::byte> data, bool variable,
                                                        std::uint64_t maxEntries);

/// Where the compressed points of a file are.
struct ChunkList {
    std::vector<Chunk> chunks;
    std::uint64_t end = 0;  ///< first byte after chunks and table
    PointIndex points = 0;
    std::vector<std::string> warnings;
    std::vector<std::string> losses;  ///< those of the warnings that tell of points that are not there
    bool unproved = false;            ///< there is one chunk, and its count is the header's, not looked at
};

/// What is done about the count of a chunk that is the only one of its file, does not say how many points it has,
/// and so tells only when all of it is decoded.
enum class OnlyChunk {
    Prove,   ///< it is decoded
    Believe  ///< the header is believed, until the points are read
};

/// Finds the chunks of the compressed points between `begin` (the header's point offset) and `end` (first EVLR or
/// end of the file). `counts`: what the header says of the number of points, the most trusted first.
/// A table that is missing or wrong is rebuilt: layered chunks by walking from one to the next, others of fixed
/// size by decoding. Throws Error when that cannot be done.
ChunkList findChunks(const File& file, std::uint64_t begin, std::uint64_t end, const LazInfo& info,
                     std::span<const std::uint64_t> counts, OnlyChunk only = OnlyChunk::Prove);

}  // namespace punctum::las
