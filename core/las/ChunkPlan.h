// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/ChunkTable.h"
#include "core/las/SourceFile.h"

#include <memory>
#include <optional>
#include <vector>

namespace punctum::las
{

/// A chunk that is to be written.
struct PlannedChunk {
    PointRange points;            ///< of the written points
    std::optional<Chunk> origin;  ///< the same points in the file they came from: copied when no edit touched them
};

/// How the points of a compressed file are cut into chunks.
struct ChunkPlan {
    std::vector<PlannedChunk> chunks;
    std::uint32_t chunkSize = kDefaultChunkSize;  ///< kVariableChunks when the table must say each chunk's points
    std::filesystem::path originPath;             ///< that the origins lie in; empty: no chunk is copied
    FileStamp originStamp;                        ///< of that file, which is opened when chunks are copied
    LazInfo laz;                                  ///< of that file
    /// That file's chunks are coded in versions that LASzip no longer writes. All chunks of a file have one
    /// version, so that either all are copied or none.
    bool allOrNone = false;

    /// Of a COPC file: the node of its index that each chunk holds the points of.
    std::vector<std::size_t> nodes;

    bool copies() const noexcept { return !originPath.empty(); }
    /// Null when there is none, or it is no longer that file: then all chunks are compressed anew. Never throws.
    std::shared_ptr<const File> openOrigin() const;
};

/// Chunks of points written one after another, each but the last with `chunkSize` points.
std::vector<PlannedChunk> regularChunks(PointIndex points, std::uint32_t chunkSize);

/// Cuts the points that are written (`kept`) as they are cut in the file that holds the cloud
/// at present, if that is a LAZ file with records of this kind and nobody changed it since, else into chunks of
/// `chunkSize`. `standard`: what LASzip writes for such records. Chunks that lost points are cut anew.
/// The file is looked at, its points are not read. Never throws: a file that cannot be used is no origin.
ChunkPlan planChunks(const SourceFile& source, const LazInfo& standard, const KeptPoints& kept,
                     std::uint32_t chunkSize);
/// Likewise by the nodes of the source's octree (CopcIndex), a chunk for each that still has points. Those are
/// copied of which the file at present has a node with as many points.
ChunkPlan planNodeChunks(const SourceFile& source, const LazInfo& standard, const KeptPoints& kept);

}  // namespace punctum::las
