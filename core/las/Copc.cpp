// SPDX-License-Identifier: MIT
#include "core/las/Copc.h"

#include "core/Text.h"
#include "core/cloud/KeptPoints.h"
#include "core/las/ChunkTable.h"
#include "core/las/RecordBlocks.h"
#include "core/las/SourceFile.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace punctum::las
{

namespace
{

constexpr std::int32_t kDeepest = 30;  ///< level; keys are 32 bits with a sign

/// Thrown with the end of the sentence that says why the index cannot be used.
struct NoIndex {
    std::string why;
};

std::string keyText(const CopcKey& key)
{
    return std::to_string(key.level) + "-" + std::to_string(key.x) + "-" + std::to_string(key.y) + "-" +
           std::to_string(key.z);
}

class IndexReader
{
public:
    IndexReader(const SourceFile& source, std::uint64_t hierarchyAt, const LazInfo& laz,
                std::span<const Chunk> chunks)
        : m_source(source), m_laz(laz), m_chunks(chunks), m_nodes(chunks.size())
    {
        m_index.hierarchyAt = hierarchyAt;
        m_index.chunks = chunks.size();
    }

    CopcIndex read()
    {
        checkFile();
        readInfo();
        readPages();
        for (std::size_t k = 0; k < m_nodes.size(); ++k)
            if (m_nodes[k].points.empty())
                throw NoIndex{"chunk " + grouped(k + 1) + " of " + grouped(m_nodes.size()) + " is not in it"};
        m_index.nodes = std::move(m_nodes);
        m_index.nodes.insert(m_index.nodes.end(), m_empty.begin(), m_empty.end());
        std::vector<CopcKey> keys;
        keys.reserve(m_index.nodes.size());
        for (const CopcNode& node : m_index.nodes) keys.push_back(node.key);
        std::sort(keys.begin(), keys.end());
        if (const auto twice = std::adjacent_find(keys.begin(), keys.end()); twice != keys.end())
            throw NoIndex{"it has the node " + keyText(*twice) + " twice"};
        return std::move(m_index);
    }

private:
    struct Page {
        std::uint64_t offset = 0, bytes = 0;
    };

    void checkFile() const
    {
        if (!m_source.compressed) throw NoIndex{"the points are not compressed"};
        const Header& h = m_source.header;
        if (!copc::has(m_source.layout.format, h.versionMinor()))
            throw NoIndex{"COPC has no point format " + std::to_string(m_source.layout.format) + " of LAS " +
                          h.version()};
        if (h.bytes.size() != standardHeaderSize(4) || m_source.vlrs.empty() ||
            !m_source.vlrs.front().is(kCopcUser, kCopcInfoId))
            throw NoIndex{"its first record is not right behind the header"};
        if (!m_laz.variable()) throw NoIndex{"chunks are of one size"};
        if (m_index.hierarchyAt == 0) throw NoIndex{"the extended record with its nodes is missing"};
        const auto cut = std::any_of(m_chunks.begin(), m_chunks.end(), [](const Chunk& c) { return c.cut; });
        if (cut) throw NoIndex{"points are missing"};
    }

    void readInfo()
    {
        const std::vector<std::byte>& info = m_source.vlrs.front().data;
        if (info.size() != copc::kInfoBytes)
            throw NoIndex{"its first record has " + std::to_string(info.size()) + " bytes instead of " +
                          std::to_string(copc::kInfoBytes)};
        const auto number = [&](std::size_t k) { return loadAs<double>(info.data() + 8 * k); };
        m_index.center = {number(0), number(1), number(2)};
        m_index.halfSize = number(3);
        m_index.spacing = number(4);
        for (int k = 0; k < 3; ++k)
            if (!std::isfinite(m_index.center[k])) throw NoIndex{"its cube is nowhere"};
        if (!std::isfinite(m_index.halfSize) || m_index.halfSize < 0 || !std::isfinite(m_index.spacing) ||
            m_index.spacing < 0)
            throw NoIndex{"its cube has no size"};
        m_index.rootOffset = loadAs<std::uint64_t>(info.data() + copc::kRootOffsetAt);
        m_index.rootBytes = loadAs<std::uint64_t>(info.data() + copc::kRootBytesAt);
    }

    void readPages()
    {
        m_data = std::find_if(m_source.evlrs.begin(), m_source.evlrs.end(), isCopcHierarchy)->data;
        addPage({m_index.rootOffset, m_index.rootBytes});
        for (std::size_t k = 0; k < m_pages.size(); ++k) {
            const Page page = m_pages[k];
            const std::uint64_t begin = page.offset - m_index.hierarchyAt;
            for (std::uint64_t at = begin; at < begin + page.bytes; at += copc::kEntryBytes) readEntry(at);
        }
        std::sort(m_pages.begin(), m_pages.end(), [](const Page& a, const Page& b) { return a.offset < b.offset; });
        for (std::size_t k = 1; k < m_pages.size(); ++k)
            if (m_pages[k - 1].offset + m_pages[k - 1].bytes > m_pages[k].offset)
                throw NoIndex{"its pages lie one over another"};
    }

    /// Pages that fill more than the record lead in a circle, or lie over one another: so their number has an end.
    void addPage(Page page)
    {
        const std::uint64_t begin = m_index.hierarchyAt, size = m_data.size();
        if (page.bytes == 0 || page.bytes % copc::kEntryBytes != 0 || page.offset < begin ||
            page.offset - begin > size || page.bytes > size - (page.offset - begin))
            throw NoIndex{"a page at byte " + grouped(page.offset) + " is not in its record"};
        if (page.bytes > size - m_paged) throw NoIndex{"its pages lead in a circle"};
        m_paged += page.bytes;
        m_pages.push_back(page);
    }

    void readEntry(std::uint64_t at)
    {
        const std::byte* const entry = m_data.data() + at;
        CopcNode node;
        node.entry = at;
        node.key = {loadAs<std::int32_t>(entry), loadAs<std::int32_t>(entry + 4), loadAs<std::int32_t>(entry + 8),
                    loadAs<std::int32_t>(entry + 12)};
        const std::int32_t level = node.key.level;
        const auto outside = [&](std::int32_t k) { return k < 0 || k >= std::int32_t(1) << level; };
        if (level < 0 || level > kDeepest || outside(node.key.x) || outside(node.key.y) || outside(node.key.z))
            throw NoIndex{"there is no node " + keyText(node.key)};
        const auto offset = loadAs<std::uint64_t>(entry + copc::kOffsetAt);
        const auto bytes = loadAs<std::int32_t>(entry + copc::kBytesAt);
        const auto points = loadAs<std::int32_t>(entry + copc::kPointsAt);
        if (points < -1 || (points != 0 && bytes <= 0))
            throw NoIndex{"the node " + keyText(node.key) + " has a size that cannot be"};
        if (points == -1) {
            m_index.pages.push_back(at);
            addPage({offset, std::uint64_t(bytes)});
        } else if (points == 0) {
            m_empty.push_back(node);
        } else {
            takeChunk(node, offset, std::uint64_t(bytes), std::uint64_t(points));
        }
    }

    void takeChunk(CopcNode& node, std::uint64_t offset, std::uint64_t bytes, std::uint64_t points)
    {
        const auto found = std::lower_bound(m_chunks.begin(), m_chunks.end(), offset,
                                            [](const Chunk& c, std::uint64_t place) { return c.offset < place; });
        if (found == m_chunks.end() || found->offset != offset || found->bytes != bytes || found->count != points)
            throw NoIndex{"the node " + keyText(node.key) + " is no chunk of the file"};
        CopcNode& taken = m_nodes[std::size_t(found - m_chunks.begin())];
        if (!taken.points.empty())
            throw NoIndex{"the nodes " + keyText(taken.key) + " and " + keyText(node.key) + " are the same chunk"};
        node.points = {found->first, found->first + found->count};
        taken = node;
    }

    const SourceFile& m_source;
    const LazInfo& m_laz;
    std::span<const Chunk> m_chunks;
    std::span<const std::byte> m_data;
    std::vector<Page> m_pages;
    std::uint64_t m_paged = 0;  ///< bytes of them
    std::vector<CopcNode> m_nodes, m_empty;
    CopcIndex m_index;
};

}  // namespace

bool isCopcHierarchy(const Vlr& vlr)
{
    return vlr.is(kCopcUser, kCopcHierarchyId);
}

WorldBounds CopcIndex::cube(const CopcKey& key) const
{
    const double side = std::ldexp(2 * halfSize, -key.level);
    const glm::dvec3 low = center - glm::dvec3(halfSize) + side * glm::dvec3(key.x, key.y, key.z);
    return {low, low + glm::dvec3(side)};
}

std::int32_t CopcIndex::levels() const
{
    std::int32_t n = 0;
    for (const CopcNode& node : nodes)
        if (!node.points.empty()) n = std::max(n, node.key.level + 1);
    return n;
}

std::vector<PointIndex> CopcIndex::pointsByLevel() const
{
    std::vector<PointIndex> points(std::size_t(levels()), 0);
    for (const CopcNode& node : nodes)
        if (!node.points.empty()) points[std::size_t(node.key.level)] += node.points.size();
    return points;
}

std::shared_ptr<const CopcIndex> CopcIndex::of(const KeptPoints& kept) const
{
    auto part = std::make_shared<CopcIndex>(*this);
    for (CopcNode& node : part->nodes)
        if (!node.points.empty()) node.points = {kept.placeOf(node.points.first), kept.placeOf(node.points.last)};
    return part;
}

std::vector<std::uint32_t> CopcIndex::chunksByLevel() const
{
    std::vector<std::uint32_t> order = spreadOrder(std::uint32_t(chunks));
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return nodes[a].key.level < nodes[b].key.level; });
    return order;
}

bool sameNodes(const CopcIndex& a, const CopcIndex& b)
{
    if (a.center != b.center || a.halfSize != b.halfSize || a.spacing != b.spacing) return false;
    const auto counted = [](const CopcIndex& index) {
        std::vector<std::pair<CopcKey, PointIndex>> list;
        list.reserve(index.nodes.size());
        for (const CopcNode& node : index.nodes) list.emplace_back(node.key, node.points.size());
        std::sort(list.begin(), list.end());
        return list;
    };
    return counted(a) == counted(b);
}

std::shared_ptr<const CopcIndex> readCopc(const SourceFile& source, std::uint64_t hierarchyAt, const LazInfo& laz,
                                          std::span<const Chunk> chunks, std::string& trouble)
{
    if (source.findVlr(kCopcUser, kCopcInfoId) == nullptr) return nullptr;
    try {
        return std::make_shared<const CopcIndex>(IndexReader(source, hierarchyAt, laz, chunks).read());
    } catch (const NoIndex& e) {
        trouble = e.why;
        return nullptr;
    }
}

}  // namespace punctum::las
