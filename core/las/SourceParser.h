// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/ChunkTable.h"
#include "core/las/SourceFile.h"

#include <memory>
#include <vector>

namespace punctum::las
{

class File;
class KnownCrs;

/// A file's non-point part, checked, and where its points are.
struct ParsedFile {
    std::shared_ptr<SourceFile> source;
    LazInfo laz;                ///< of compressed files
    std::vector<Chunk> chunks;  ///< of compressed files
    bool unproved = false;      ///< ChunkList::unproved
};

/// What may be left out where many files are opened.
struct ParseOptions {
    OnlyChunk only = OnlyChunk::Prove;  ///< a header is believed only when its counts by return agree
    KnownCrs* crs = nullptr;            ///< of files that were opened before; null: nothing is known
};

/// Reads and checks header, VLRs, EVLRs, extra bytes, coordinate system and chunk table, and samples a few points
/// for a first idea of the extent. Every size, count and offset is checked before it is used.
/// Throws Error on what cannot be opened; what can is warned of in the SourceFile.
ParsedFile parseFile(const File& file, const ParseOptions& options = {});

}  // namespace punctum::las
