// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/ChunkCodec.h"
#include "core/las/ChunkTable.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace punctum::las
{

class File;

/// What decoding tells of compressed chunks while their number, size or points are in doubt: a table that is lost,
/// a count that cannot be, bytes that read as zeros because a copy was interrupted. For one thread.
class ChunkProbe
{
public:
    static constexpr std::uint64_t kMostPoints = std::uint64_t(1) << 31;  ///< in one chunk

    ChunkProbe(const File& file, const LazInfo& info) : m_file(file), m_info(info) {}

    /// How many of `count` points can be decoded from the chunk's bytes and no others.
    std::uint64_t decodable(const Chunk& chunk, std::uint64_t count, std::uint64_t* consumed = nullptr) const;
    /// Whether chunk.count points use up its bytes.
    bool endsExactly(const Chunk& chunk) const;
    /// Points that use up the chunk's bytes, as far as these can be whole; 0 when they cannot.
    std::uint64_t pointsUntilEnd(const Chunk& chunk) const;
    /// The chunk of `want` points that begins at `at`, which is not whole where fewer are found or where its bytes
    /// cannot be all a coder's: then it is cut off before the damage, and may have no points.
    Chunk next(std::uint64_t at, std::uint64_t end, std::uint64_t first, std::uint64_t want) const;
    /// The stream of chunk.count points up to where zeros stand in place of its bytes.
    Chunk withoutZeros(const Chunk& chunk) const;

private:
    std::vector<std::byte> load(const Chunk& chunk) const;

    const File& m_file;
    const LazInfo& m_info;
};

/// Whether the bytes of a chunk are whole, whose `count` points have been decoded by `decoder`. Zeros are what is
/// read where a copy was interrupted, and they decode to points that never were. A coder ends with two or three of
/// them (see RangeDecoder::zerosAtEnd); one or two more come by chance, and then the end must be one that it can
/// have written. Longer runs it writes, too, for points that all go on as those before; so whatever has them must
/// give the same bytes when it is compressed again. Of layers, that says nothing where another program wrote them;
/// so only their ends, and runs as long as a sector, are doubted.
bool wholeChunk(const LazInfo& info, std::span<const std::byte> data, std::uint64_t count,
                const PointDecoder& decoder);

/// First byte of the first `least` zeros in a row in a file's part [begin, end); `end` when there are none.
std::uint64_t zerosFrom(const File& file, std::uint64_t begin, std::uint64_t end, std::uint64_t least);

/// First byte of the zeros that a file's part [begin, end) ends with; `end` when it ends with none. Looks at no
/// more than `most` bytes.
std::uint64_t zerosBefore(const File& file, std::uint64_t begin, std::uint64_t end,
                          std::uint64_t most = UINT64_MAX);

}  // namespace punctum::las
