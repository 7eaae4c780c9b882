// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/ChunkTable.h"
#include "tests/core/LasFiles.h"

#include <array>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

/// COPC files for tests, made byte by byte, and a plain reader of their octrees. Both are written from the
/// specification (COPC 1.0, copc.io: "info VLR", "hierarchy VLR") and use nothing of core/las/Copc.
namespace copcfiles
{

using lasfiles::Bytes;
using lasfiles::get;
using lasfiles::set;

constexpr std::size_t kInfo = 375 + 54;
using Key = std::array<std::int32_t, 4>;  ///< level, x, y, z

struct Node {
    std::uint64_t offset = 0;
    std::int32_t bytes = 0, points = 0;
    std::size_t entry = 0;  ///< where it stands in the file
    friend bool operator==(const Node&, const Node&) = default;
};

struct Octree {
    std::array<double, 3> center{};
    double half = 0, spacing = 0, firstTime = 0, lastTime = 0;
    std::map<Key, Node> nodes;

    Bytes chunk(const Bytes& file, const Key& key) const
    {
        const Node& n = nodes.at(key);
        return {file.begin() + std::ptrdiff_t(n.offset), file.begin() + std::ptrdiff_t(n.offset) + n.bytes};
    }
};

inline void require(bool holds, const std::string& what)
{
    if (!holds) throw std::runtime_error(what);
}

/// The octree of a file; throws where something of it is not as the specification has it.
inline Octree octreeOf(const Bytes& file)
{
    require(file.size() > kInfo + 160 && std::memcmp(file.data() + 377, "copc", 5) == 0, "no COPC");
    require(get<std::uint16_t>(file, 393) == 1 && get<std::uint16_t>(file, 395) == 160, "info record");
    Octree tree;
    for (std::size_t k = 0; k < 3; ++k) tree.center[k] = get<double>(file, kInfo + 8 * k);
    tree.half = get<double>(file, kInfo + 24);
    tree.spacing = get<double>(file, kInfo + 32);
    tree.firstTime = get<double>(file, kInfo + 56);
    tree.lastTime = get<double>(file, kInfo + 64);
    for (std::size_t k = 72; k < 160; ++k) require(file[kInfo + k] == std::byte(0), "reserved bytes");
    // the record that the pages are in
    std::size_t at = std::size_t(get<std::uint64_t>(file, 235)), begin = 0, end = 0;
    for (std::uint32_t k = 0; k < get<std::uint32_t>(file, 243); ++k) {
        const auto length = std::size_t(get<std::uint64_t>(file, at + 20));
        if (std::memcmp(file.data() + at + 2, "copc", 5) == 0 && get<std::uint16_t>(file, at + 18) == 1000) {
            begin = at + 60;
            end = begin + length;
        }
        at += 60 + length;
    }
    require(begin != 0 && at <= file.size(), "hierarchy record");
    std::vector<std::pair<std::uint64_t, std::uint64_t>> pages{
        {get<std::uint64_t>(file, kInfo + 40), get<std::uint64_t>(file, kInfo + 48)}};
    for (std::size_t p = 0; p < pages.size(); ++p) {
        const auto [offset, bytes] = pages[p];
        require(p < 1000 && offset >= begin && offset + bytes <= end && bytes % 32 == 0, "page");
        for (std::size_t e = std::size_t(offset); e < offset + bytes; e += 32) {
            const Key key{get<std::int32_t>(file, e), get<std::int32_t>(file, e + 4),
                          get<std::int32_t>(file, e + 8), get<std::int32_t>(file, e + 12)};
            const Node node{get<std::uint64_t>(file, e + 16), get<std::int32_t>(file, e + 24),
                            get<std::int32_t>(file, e + 28), e};
            if (node.points < 0)
                pages.emplace_back(node.offset, node.bytes);
            else
                require(tree.nodes.emplace(key, node).second, "a node twice");
            if (node.points == 0) require(node.offset == 0 && node.bytes == 0, "a node without points");
        }
    }
    // nodes fill the bytes between the points' beginning and the table of chunks, and have all points
    std::set<std::pair<std::uint64_t, std::int32_t>> places;
    std::uint64_t sum = 0;
    for (const auto& [key, node] : tree.nodes)
        if (node.points > 0) {
            places.emplace(node.offset, node.bytes);
            sum += std::uint64_t(node.points);
        }
    std::uint64_t next = get<std::uint32_t>(file, 96) + 8;
    for (const auto& [offset, bytes] : places) {
        require(offset == next, "a gap between nodes");
        next += std::uint64_t(bytes);
    }
    require(next == get<std::uint64_t>(file, get<std::uint32_t>(file, 96)), "the nodes' end");
    require(sum == get<std::uint64_t>(file, 247), "the sum of points");
    return tree;
}

/// Holds each point, as LASzip reads it, against the cube of its node; one step of the coordinates is rounding.
inline void checkCubes(const std::filesystem::path& path)
{
    const Bytes file = lasfiles::readFile(path);
    const Octree tree = octreeOf(file);
    std::map<std::uint64_t, Key> byOffset;
    for (const auto& [key, node] : tree.nodes)
        if (node.points > 0) byOffset[node.offset] = key;
    std::vector<Key> nodeOf;
    for (const auto& [offset, key] : byOffset)
        nodeOf.insert(nodeOf.end(), std::size_t(tree.nodes.at(key).points), key);
    std::size_t i = 0;
    lasfiles::forEachByLaszip(path, nodeOf.size(), [&](const laszip_point& p) {
        const Key& key = nodeOf[i++];
        const double side = 2 * tree.half / std::exp2(key[0]);
        const std::int32_t raw[] = {p.X, p.Y, p.Z};
        for (std::size_t k = 0; k < 3; ++k) {
            const double scale = get<double>(file, 131 + 8 * k);
            const double world = raw[k] * scale + get<double>(file, 155 + 8 * k);
            const double low = tree.center[k] - tree.half + side * key[k + 1];
            require(world >= low - scale && world <= low + side + scale, "a point outside of its node");
        }
    });
}

/// Point format 7: a root of 700 points, eight nodes of 300 to 1000, two of them on a page of their own, and a node
/// without points. GPS times are 1000 and more. `extended`: further records behind the points.
/// `part`: of all these points one of so many.
inline Bytes made(const std::vector<Bytes>& extended = {}, std::size_t part = 1)
{
    constexpr std::uint16_t kLength = 36;
    constexpr std::int32_t kSide = 100000;  // raw, of the root's cube
    std::mt19937 random(7);
    const auto below = [&](std::int32_t n) { return std::int32_t(random() % std::uint32_t(n)); };
    std::vector<Key> keys{{0, 0, 0, 0}};
    for (std::int32_t k = 0; k < 8; ++k) keys.push_back({1, k & 1, k >> 1 & 1, k >> 2});
    Bytes laszip, chunks;
    std::vector<punctum::las::ChunkEntry> table;
    std::size_t all = 0;
    for (std::size_t k = 0; k < keys.size(); ++k) {
        const std::size_t count = (k == 0 ? 700 : 200 + 100 * k) / part;
        Bytes records = lasfiles::randomRecords(7, kLength, count, std::uint32_t(k), true);
        const std::int32_t side = k == 0 ? kSide : kSide / 2;
        for (std::size_t i = 0; i < count; ++i) {
            for (std::size_t axis = 0; axis < 3; ++axis)
                set<std::int32_t>(records, i * kLength + 4 * axis, keys[k][axis + 1] * side + below(side));
            set<std::uint8_t>(records, i * kLength + 14, 0x11);
            set<std::uint8_t>(records, i * kLength + 16, std::uint8_t(i % 7));
            set<double>(records, i * kLength + 22, 1000.0 + 100.0 * double(k) + double(i) / 1000);
        }
        const Bytes one = lasfiles::compressedByLaszip(7, kLength, records, 50000, &laszip);
        const auto end = std::ptrdiff_t(get<std::int64_t>(one, 0));
        chunks.insert(chunks.end(), one.begin() + 8, one.begin() + end);
        table.push_back({std::uint32_t(count), std::uint32_t(end - 8)});
        all += count;
    }
    set<std::uint32_t>(laszip, 54 + 12, 0xFFFFFFFFu);
    Bytes info(160);
    for (std::size_t k = 0; k < 3; ++k) set<double>(info, 8 * k, 500.0);
    set<double>(info, 24, 500.0);
    set<double>(info, 32, 8.0);
    set<std::uint64_t>(info, 48, 32 * 9);
    set<double>(info, 56, 1000.0);
    set<double>(info, 64, 1000.0 + 800.0 + 0.999);

    Bytes points(8);
    lasfiles::append(points, chunks);
    lasfiles::append(points, punctum::las::encodeChunkTable(table, true));
    Bytes head = lasfiles::header(4, 7 | 0x80, kLength, all);
    set<std::uint32_t>(head, 107, 0);
    Bytes file = lasfiles::file(head, {lasfiles::record("copc", 1, info), laszip}, points);
    const std::size_t begin = file.size() - points.size();
    set<std::int64_t>(file, begin, std::int64_t(begin + 8 + chunks.size()));
    set<std::uint64_t>(file, 235, file.size());
    set<std::uint32_t>(file, 243, std::uint32_t(extended.size() + 1));
    for (const Bytes& record : extended) lasfiles::append(file, record);

    // seven nodes, one without points and one that leads to the page with the last two
    Bytes pages(32 * 11);
    std::uint64_t offset = begin + 8;
    const std::uint64_t data = file.size() + 60;
    const auto entry = [&](std::size_t place, const Key& key, std::uint64_t at, std::int32_t bytes,
                           std::int32_t count) {
        for (std::size_t k = 0; k < 4; ++k) set<std::int32_t>(pages, 32 * place + 4 * k, key[k]);
        set<std::uint64_t>(pages, 32 * place + 16, at);
        set<std::int32_t>(pages, 32 * place + 24, bytes);
        set<std::int32_t>(pages, 32 * place + 28, count);
    };
    for (std::size_t k = 0; k < keys.size(); ++k) {
        entry(k < 7 ? k : k + 2, keys[k], offset, std::int32_t(table[k].bytes), std::int32_t(table[k].count));
        offset += table[k].bytes;
    }
    entry(7, {2, 3, 3, 3}, 0, 0, 0);
    entry(8, keys[7], data + 32 * 9, 32 * 2, -1);
    lasfiles::append(file, lasfiles::record("copc", 1000, pages, true));
    set<std::uint64_t>(file, kInfo + 40, data);
    return file;
}

}  // namespace copcfiles
