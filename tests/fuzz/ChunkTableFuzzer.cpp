// SPDX-License-Identifier: MIT
// The table of compressed chunks, and the search for chunks where it is lost.
// Input: bit 0 of the first byte: chunks of different sizes; bit 1: the bytes are a table, else the point part of a
// file; bits 2-5: point format; then the count of points in the header (u32), and the bytes.
#include "core/las/ChunkTable.h"
#include "core/las/File.h"
#include "tests/fuzz/Fuzz.h"

using namespace punctum;
using fuzz::promise;

namespace
{

void decodeTable(std::span<const std::byte> bytes, bool variable, std::uint32_t most)
{
    const auto entries = las::decodeChunkTable(bytes, variable, most);
    if (!entries) return;
    promise(entries->size() <= most, "a table has no more entries than may be");
    const auto again = las::decodeChunkTable(las::encodeChunkTable(*entries, variable), variable, most);
    promise(again && *again == *entries, "a table that is written is read again");
}

void findInFile(std::span<const std::byte> bytes, bool variable, std::uint8_t format, std::uint64_t count)
{
    static fuzz::MemoryFile memory;
    memory.set(bytes);
    try {
        las::LazInfo info = las::LazInfo::standard(format, las::standardRecordLength(format));
        info.chunkSize = variable ? las::kVariableChunks : 50;
        const las::File file(memory.path());
        const las::ChunkList list = las::findChunks(file, 0, bytes.size(), info, std::span(&count, 1));
        fuzz::checkSentences(list.warnings);
        promise(list.end <= bytes.size(), "the points end in the file");
        PointIndex points = 0;
        for (const las::Chunk& c : list.chunks) {
            promise(c.offset <= bytes.size() && c.bytes <= bytes.size() - c.offset, "chunks are in the file");
            promise(c.first == points && c.count > 0, "chunks follow one another");
            points += c.count;
        }
        promise(points == list.points, "the points are those of the chunks");
    } catch (const Error& e) {
        fuzz::checkSentence(e);
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    fuzz::oneThread();
    fuzz::Input input(data, size);
    const auto choice = input.take<std::uint8_t>();
    const auto count = input.take<std::uint32_t>();
    const auto format = std::uint8_t((choice >> 2 & 15) % (las::kLastPointFormat + 1));
    if ((choice & 2) != 0)
        decodeTable(input.rest(), (choice & 1) != 0, std::min<std::uint32_t>(count, 1 << 16));
    else
        findInFile(input.rest(), (choice & 1) != 0, format, count);
    return 0;
}
