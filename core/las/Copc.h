// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Column.h"
#include "core/cloud/PointCloud.h"

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <tuple>
#include <vector>

namespace punctum
{
class KeptPoints;
}

namespace punctum::las
{

struct Chunk;
struct LazInfo;
struct SourceFile;
struct Vlr;

constexpr const char* kCopcUser = "copc";
constexpr std::uint16_t kCopcInfoId = 1, kCopcHierarchyId = 1000;
constexpr std::uint16_t kCopcExtentsId = 10000;  ///< of drafts of the specification

/// The sections of the COPC 1.0 specification (copc.io) that are meant below: "info VLR" and "hierarchy VLR".
namespace copc
{
constexpr std::size_t kInfoBytes = 160;
constexpr std::size_t kRootOffsetAt = 40, kRootBytesAt = 48, kFirstTimeAt = 56, kLastTimeAt = 64;  ///< in the info
constexpr std::size_t kEntryBytes = 32;
constexpr std::size_t kOffsetAt = 16, kBytesAt = 24, kPointsAt = 28;  ///< in an entry, behind its key
/// Where the info record's data are in a file: it is the first record behind a header of LAS 1.4.
constexpr std::uint64_t kInfoAt = 375 + 54;
/// Whether a file of this format and version can be one ("LAS PDRFs 6, 7, or 8", "Introduction").
constexpr bool has(std::uint8_t format, std::uint8_t minor)
{
    return format >= 6 && format <= 8 && minor == 4;
}
}  // namespace copc

/// A node's place in the octree ("hierarchy VLR", VoxelKey): on level n there are 2^n cubes along each axis.
struct CopcKey {
    std::int32_t level = 0, x = 0, y = 0, z = 0;
    friend bool operator==(const CopcKey&, const CopcKey&) = default;
    friend bool operator<(const CopcKey& a, const CopcKey& b)
    {
        return std::tie(a.level, a.x, a.y, a.z) < std::tie(b.level, b.x, b.y, b.z);
    }
};

struct CopcNode {
    CopcKey key;
    PointRange points;        ///< of the cloud; empty where the node has none
    std::uint64_t entry = 0;  ///< where its entry begins in the data of the hierarchy record
    friend bool operator==(const CopcNode&, const CopcNode&) = default;
};

/// The octree of a COPC file ("info VLR", "hierarchy VLR"), checked against its chunks: each chunk holds the points
/// of one node. Immutable.
struct CopcIndex {
    glm::dvec3 center{0.0};                       ///< of the root's cube, world
    double halfSize = 0.0;                        ///< of it
    double spacing = 0.0;                         ///< of points in the root; half of it on each level below
    std::uint64_t rootOffset = 0, rootBytes = 0;  ///< the first page, in the file that was read
    std::uint64_t hierarchyAt = 0;                ///< where the data of the hierarchy record begin in that file
    std::vector<CopcNode> nodes;  ///< those that had points when they were read, in the file's order; the others
    std::size_t chunks = 0;       ///< node k, of so many, was chunk k of the file that was read
    std::vector<std::uint64_t> pages;  ///< where entries begin, in those data, that lead to further pages

    WorldBounds cube(const CopcKey& key) const;
    /// Of the nodes that have points, and those above them; 0 where there are none.
    std::int32_t levels() const;
    /// Points on each of them.
    std::vector<PointIndex> pointsByLevel() const;
    /// The index of a cloud of those of its points alone that are kept, in their order.
    std::shared_ptr<const CopcIndex> of(const KeptPoints& kept) const;
    /// Chunks of the file that was read, by level, so that the first ones show all of it evenly; those of one level
    /// in an order spread over the file.
    std::vector<std::uint32_t> chunksByLevel() const;
};

bool isCopcHierarchy(const Vlr& vlr);

/// Whether both have the same cubes, with as many points in each.
bool sameNodes(const CopcIndex& a, const CopcIndex& b);

/// The index of a file whose other parts were read. `hierarchyAt`: where the data of its hierarchy record are in
/// the file; 0 where there is none. Null where the file has no such records, or they cannot be used: then `trouble`
/// says why, as the end of a sentence. Every size, offset, count and key is checked, and each chunk is one node.
std::shared_ptr<const CopcIndex> readCopc(const SourceFile& source, std::uint64_t hierarchyAt, const LazInfo& laz,
                                          std::span<const Chunk> chunks, std::string& trouble);

}  // namespace punctum::las
