// SPDX-License-Identifier: MIT
// Header, VLRs, EVLRs, coordinate system and where the points are: all that is read when a file is opened.
#include "core/las/File.h"
#include "core/las/SourceParser.h"
#include "tests/fuzz/Fuzz.h"

using namespace punctum;
using fuzz::promise;

namespace
{

/// Every byte of the file is in exactly one part of what was read.
void checkParts(const las::ParsedFile& parsed, std::uint64_t size)
{
    const las::SourceFile& s = *parsed.source;
    std::uint64_t before = s.header.bytes.size() + s.gapBeforePoints.size();
    for (const las::Vlr& v : s.vlrs) before += v.bytesInFile();
    promise(before == s.header.pointOffset(), "header, records and gap reach to the points");
    std::uint64_t after = s.gapAfterPoints.size() + s.tail.size();
    for (const las::Vlr& v : s.evlrs) after += v.bytesInFile();
    promise(s.pointDataEnd <= size && size - s.pointDataEnd == after, "what follows the points reaches to the end");
    promise(s.pointDataEnd >= s.header.pointOffset(), "points end behind their beginning");
    promise(!s.waveformEvlr || *s.waveformEvlr < s.evlrs.size(), "the waveform record exists");

    PointIndex points = 0;
    for (const las::Chunk& c : parsed.chunks) {
        promise(c.offset >= s.header.pointOffset() && c.offset <= size && c.bytes <= size - c.offset,
                "chunks are in the file");
        promise(c.first == points && c.count > 0, "chunks follow one another");
        points += c.count;
    }
    if (s.copc)
        for (std::size_t k = 0; k < s.copc->chunks; ++k)
            promise(s.copc->nodes[k].points.first == parsed.chunks[k].first &&
                        s.copc->nodes[k].points.size() == parsed.chunks[k].count,
                    "each chunk is a node");
    if (s.compressed)
        promise(points == s.pointCount, "the chunks hold the points");
    else
        promise(s.pointDataEnd - s.header.pointOffset() == s.pointCount * s.layout.length,
                "points fill their bytes");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    fuzz::oneThread();
    static fuzz::MemoryFile memory;
    memory.set({reinterpret_cast<const std::byte*>(data), size});
    try {
        const las::File file(memory.path());
        const las::ParsedFile parsed = las::parseFile(file);
        fuzz::checkLayout(parsed.source->layout);
        fuzz::checkSentences(parsed.source->warnings);
        checkParts(parsed, size);
    } catch (const Error& e) {
        fuzz::checkSentence(e);
    }
    return 0;
}
