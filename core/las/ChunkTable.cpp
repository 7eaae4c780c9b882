// SPDX-License-Identifier: MIT
#include "core/las/ChunkTable.h"

#include "core/Error.h"
#include "core/Text.h"
#include "core/las/ChunkProbe.h"
#include "core/las/File.h"
#include "core/las/RangeCoder.h"

#include <algorithm>
#include <cstring>

namespace punctum::las
{

namespace
{

constexpr std::size_t kTableHead = 8;  ///< version, number of chunks
constexpr std::size_t kTablePointer = 8;
constexpr std::uint64_t kMostPoints = ChunkProbe::kMostPoints;
constexpr std::uint64_t kMostPointsAByte = 4096;

template <typename T>
T readValue(const File& file, std::uint64_t offset)
{
    T v{};
    file.readAt(offset, std::as_writable_bytes(std::span(&v, 1)));
    return v;
}

std::string number(std::uint64_t n)
{
    return std::to_string(n);
}

/// One attempt at the chunks of a file; the steps of findChunks.
class Finder
{
public:
    Finder(const File& file, std::uint64_t begin, std::uint64_t end, const LazInfo& info,
           std::span<const std::uint64_t> counts, OnlyChunk only)
        : m_file(file),
          m_probe(file, info),
          m_begin(begin),
          m_end(end),
          m_info(info),
          m_counts(counts),
          m_only(only)
    {
    }

    ChunkList find()
    {
        if (m_info.compressor == LazInfo::Pointwise) {
            pointwise();
        } else if (m_end - m_begin < kTablePointer) {
            if (stated() != 0) throw Error(m_file.path(), "The file ends before its points.", m_begin);
            m_list.end = m_begin;
        } else if (!fromTable()) {
            const std::vector<Chunk> stored = std::move(m_list.chunks);
            if (m_info.compressor == LazInfo::Layered)
                walkLayered();
            else
                walkChunked();
            if (stored != m_list.chunks)
                m_list.warnings.push_back(
                    "The table of compressed chunks is missing or damaged; it was rebuilt from the chunks.");
        }
        for (const Chunk& c : m_list.chunks) m_list.points += c.count;
        return std::move(m_list);
    }

private:
    std::uint64_t stated() const { return m_counts.empty() ? 0 : m_counts.front(); }

    /// No point of these formats takes less than an eighth of a byte, unless nearly all are equal.
    static bool plausible(std::uint64_t count, std::uint64_t bytes) { return count <= bytes * 8; }
    /// Not even equal points take less: each costs a symbol of a model of 64 symbols or more (or three of 33), none
    /// of which can become rarer than 1 in 2^15.
    static bool possible(std::uint64_t count, std::uint64_t bytes) { return count <= bytes * kMostPointsAByte; }

    void pointwise()
    {
        Chunk c{m_begin, m_end - m_begin, 0, stated()};
        if (!plausible(c.count, c.bytes)) {
            // The count is wrong: it is that of a whole stream, or the stream is cut, or ends in zeros.
            if (const std::uint64_t all = m_probe.pointsUntilEnd(c); all != 0) {
                c.count = all;
            } else {
                c = m_probe.withoutZeros(c);
                if (!c.cut) c.count = m_probe.decodable(c, stated());
                c.cut = true;
            }
        } else if (c.count != 0) {
            c = m_probe.withoutZeros(c);
        }
        warnCount(stated(), c.count);
        if (c.count != 0) m_list.chunks.push_back(c);
        m_list.end = m_end;
    }

    bool fromTable()
    {
        auto position = readValue<std::int64_t>(m_file, m_begin);
        if (position == -1 && m_end - m_begin >= 2 * kTablePointer)
            position = readValue<std::int64_t>(m_file, m_end - kTablePointer);  // written to a stream without seeks
        const std::uint64_t chunksBegin = m_begin + kTablePointer;
        if (position < 0 || std::uint64_t(position) < chunksBegin || std::uint64_t(position) > m_end) return false;
        const auto tableAt = std::uint64_t(position);
        m_tableAt = tableAt;
        if (m_end - tableAt < kTableHead) return false;
        const std::uint64_t chunkBytes = tableAt - chunksBegin;
        // A chunk has its first point uncompressed, so the table cannot have more entries than this, and an entry
        // takes far less than 16 bytes.
        const std::uint64_t most = chunkBytes / m_info.recordLength;
        std::vector<std::byte> table(std::size_t(std::min(m_end - tableAt, kTableHead + 64 + most * 16)));
        m_file.readAt(tableAt, table);
        const auto entries = decodeChunkTable(table, m_info.variable(), most);
        if (!entries) return false;

        std::uint64_t at = chunksBegin, first = 0;
        for (const ChunkEntry& e : *entries) {
            // A chunk size that cannot be is looked at below; here it only must not overflow.
            const std::uint64_t count =
                m_info.variable() ? e.count : std::min<std::uint64_t>(m_info.chunkSize, kMostPoints);
            if (e.bytes < m_info.recordLength || e.bytes > tableAt - at || count == 0 || count > kMostPoints ||
                (m_info.variable() && !possible(count, e.bytes)))
                return false;
            m_list.chunks.push_back({at, e.bytes, first, count});
            at += e.bytes;
            first += count;
        }
        if (at != tableAt) return false;
        const auto same = encodeChunkTable(*entries, m_info.variable());
        m_list.end = tableAt + kTableHead;
        if (same.size() <= table.size() && std::equal(same.begin(), same.end(), table.begin()))
            m_list.end = tableAt + same.size();
        else if (!entries->empty())
            m_list.end = m_end;  // where a table that we would write otherwise ends is not known
        return settleCounts();
    }

    /// Compares the chunks' counts with the header's; the data decides. False when the table must be wrong.
    bool settleCounts()
    {
        std::vector<Chunk>& chunks = m_list.chunks;
        if (chunks.empty()) {
            warnCount(stated(), 0);
            return true;
        }
        Chunk& last = chunks.back();
        const std::uint64_t before = last.first;
        if (m_info.variable()) {
            const std::uint64_t sum = before + last.count;
            if (std::find(m_counts.begin(), m_counts.end(), sum) != m_counts.end()) return true;
            if (m_info.compressor == LazInfo::Layered) return false;  // walking tells the truth
            warnCount(stated(), sum);
            return true;
        }
        if (m_info.compressor == LazInfo::Layered) {
            const std::uint32_t count = statedIn(last);
            if (count == 0) return keepStated(last);
            if (count > m_info.chunkSize || !possible(count, last.bytes)) return false;
            last.count = count;
            if (std::find(m_counts.begin(), m_counts.end(), before + count) != m_counts.end()) return true;
            // The header's count is wrong, or the chunk size: the first chunk tells.
            if (chunks.size() > 1 && statedIn(chunks.front()) != m_info.chunkSize) return false;
            warnCount(stated(), before + count);
            return true;
        }
        for (const std::uint64_t n : m_counts) {
            if (n <= before || n - before > m_info.chunkSize || !possible(n - before, last.bytes)) continue;
            last.count = n - before;
            const bool few = chunks.size() == 1;
            if (!few && similarDensity(chunks)) return true;
            if (few && m_only == OnlyChunk::Believe) return m_list.unproved = true;
            if (m_probe.endsExactly(last)) return true;
        }
        return countByDecoding() || keepStated(last);
    }

    /// Points that a layered chunk says it has; 0 when its head is damaged.
    std::uint32_t statedIn(const Chunk& c) const
    {
        std::vector<std::byte> head(std::min<std::size_t>(std::size_t(c.bytes), headBytes()));
        m_file.readAt(c.offset, head);
        std::uint32_t count = 0;
        std::uint64_t bytes = 0;
        return layeredChunkSize(head, m_info, count, bytes) ? count : 0;
    }

    /// The last chunk is damaged: reading will find that out, here only its size matters.
    bool keepStated(Chunk& last)
    {
        for (const std::uint64_t n : m_counts)
            if (n > last.first && n - last.first <= m_info.chunkSize && possible(n - last.first, last.bytes)) {
                last.count = n - last.first;
                return true;
            }
        return false;
    }

    static bool similarDensity(const std::vector<Chunk>& chunks)
    {
        const Chunk& last = chunks.back();
        const Chunk& other = chunks.front();
        const double a = double(last.bytes) / double(last.count), b = double(other.bytes) / double(other.count);
        return a < 4 * b && b < 4 * a;
    }

    /// The chunk size in the record or the header's count is wrong: decode until each chunk's bytes are used up.
    /// False, and nothing is changed, when a chunk is damaged.
    bool countByDecoding()
    {
        std::vector<Chunk> counted = m_list.chunks;
        // The first chunk tells whether the stated size is right for all but the last.
        const bool sizeHolds = counted.size() > 1 && m_probe.endsExactly(counted.front());
        std::uint64_t first = 0;
        for (Chunk& c : counted) {
            c.first = first;
            if (!sizeHolds || &c == &counted.back()) c.count = m_probe.pointsUntilEnd(c);
            if (c.count == 0) return false;
            first += c.count;
        }
        if (!sizeHolds && counted.size() > 1)
            m_list.warnings.push_back("The stated chunk size " + grouped(m_info.chunkSize) +
                                      " is wrong; the chunks were counted.");
        m_list.chunks = std::move(counted);
        warnCount(stated(), first);
        return true;
    }

    std::size_t headBytes() const
    {
        return std::size_t(m_info.recordLength) + 4 + 4 * std::size_t(m_info.layers());
    }

    /// Layered chunks state their size, so that each leads to the next: up to the table where its position is
    /// known, else until all points are found.
    void walkLayered()
    {
        std::uint64_t reached = walkLayered(m_tableAt.value_or(m_end), !m_tableAt);
        if (m_tableAt && reached != *m_tableAt) reached = walkLayered(m_end, true);
        dropUnfinished();
        m_list.end = m_end;
        endOfWalk();
    }
    /// Zeros in place of the table and of the last chunk's last bytes: a copy that was interrupted in the chunk.
    void dropUnfinished()
    {
        constexpr std::uint64_t kMostAtEnd = 5;  // of a coder's own, and by chance: see wholeChunk()
        if (m_list.chunks.empty()) return;
        const Chunk& last = m_list.chunks.back();
        const std::uint64_t end = last.offset + last.bytes;
        if (end < m_end && zerosBefore(m_file, last.offset, m_end) + kMostAtEnd < end) m_list.chunks.pop_back();
    }
    std::uint64_t walkLayered(std::uint64_t end, bool untilAllFound)
    {
        std::uint64_t at = m_begin + kTablePointer, points = 0;
        std::vector<std::byte> head(headBytes());
        m_list.chunks.clear();
        while (at < end && end - at >= head.size() && (!untilAllFound || points < stated())) {
            m_file.readAt(at, head);
            std::uint32_t count = 0;
            std::uint64_t bytes = 0;
            if (!layeredChunkSize(head, m_info, count, bytes) || bytes > end - at || count > kMostPoints ||
                !possible(count, bytes))
                break;
            // Without the table's position as the goal, the other figures must do to tell chunks from other bytes.
            if (untilAllFound && !m_info.variable() && count > m_info.chunkSize) break;
            if (untilAllFound && count > stated() - points) break;
            m_list.chunks.push_back({at, bytes, points, count});
            at += bytes;
            points += count;
        }
        return at;
    }

    /// Chunks that were found one after the other.
    struct Walk {
        std::vector<Chunk> chunks;
        std::uint64_t end = 0;  ///< of the last one
        bool all = false;       ///< as many points as the header says, in whole chunks
    };

    /// Chunks of a fixed size follow each other; where one ends is known only when it is decoded. So the walk must
    /// end where a table is, or where the bytes do: whatever else it gives is not what was written.
    void walkChunked()
    {
        if (m_info.variable())
            throw Error(m_file.path(),
                        "The table of compressed chunks is damaged and cannot be rebuilt, because the "
                        "chunks differ in size.");
        const std::uint64_t named = m_tableAt.value_or(m_end);
        Walk walk = walkChunked(named);
        bool sound = walk.all && (walk.end == named || tableAgrees(walk));
        if (!sound && named != m_end) {  // it may be the pointer that is wrong
            Walk other = walkChunked(m_end);
            if (other.all && (other.end == m_end || tableAgrees(other))) {
                walk = std::move(other);
                sound = true;
            }
        }
        m_list.chunks = std::move(walk.chunks);
        m_list.end = m_end;
        if (walk.all && !sound)
            lose("The compressed points end at " + number(walk.end) + ", but their table should begin at " +
                 number(named) + "; some of them may be damaged.");
        endOfWalk();
    }
    Walk walkChunked(std::uint64_t end) const
    {
        Walk walk{{}, m_begin + kTablePointer, false};
        std::uint64_t points = 0;
        bool whole = true;
        while (whole && points < stated() && walk.end < end) {
            const std::uint64_t want = std::min<std::uint64_t>(m_info.chunkSize, stated() - points);
            const Chunk chunk = m_probe.next(walk.end, end, points, want);
            whole = !chunk.cut;
            if (chunk.count == 0) break;
            walk.chunks.push_back(chunk);
            walk.end += chunk.bytes;
            points += chunk.count;
        }
        walk.all = whole && points == stated();
        return walk;
    }
    /// Whether a table follows that says just these chunks.
    bool tableAgrees(const Walk& walk) const
    {
        std::vector<ChunkEntry> entries;
        for (const Chunk& c : walk.chunks) entries.push_back({0, std::uint32_t(c.bytes)});
        const std::uint64_t size = encodeChunkTable(entries, false).size();
        std::vector<std::byte> table(std::size_t(std::min(m_end - walk.end, size + 64)));
        m_file.readAt(walk.end, table);
        return decodeChunkTable(table, false, entries.size()) == entries;
    }

    void endOfWalk()
    {
        std::uint64_t points = 0;
        for (const Chunk& c : m_list.chunks) points += c.count;
        if (points == 0 && stated() != 0)
            throw Error(m_file.path(), "The compressed points are damaged: not one can be read.", m_begin);
        if (std::find(m_counts.begin(), m_counts.end(), points) == m_counts.end()) warnCount(stated(), points);
    }

    void warnCount(std::uint64_t said, std::uint64_t found)
    {
        if (said == found) return;
        const std::string sentence =
            "The header says " + grouped(said) + " points, the file holds " + grouped(found) + ".";
        if (found < said)
            lose(sentence);
        else
            m_list.warnings.push_back(sentence);
    }

    void lose(const std::string& sentence)
    {
        m_list.losses.push_back(sentence);
        m_list.warnings.push_back(sentence);
    }

    const File& m_file;
    ChunkProbe m_probe;
    std::uint64_t m_begin;
    std::uint64_t m_end;
    const LazInfo& m_info;
    std::span<const std::uint64_t> m_counts;
    OnlyChunk m_only;
    std::optional<std::uint64_t> m_tableAt;  ///< where the header's pointer says, if that can be
    ChunkList m_list;
};

}  // namespace

std::vector<std::byte> encodeChunkTable(std::span<const ChunkEntry> entries, bool variable)
{
    std::vector<std::byte> bytes(kTableHead);
    const auto count = std::uint32_t(entries.size());
    std::memcpy(bytes.data() + 4, &count, 4);
    if (entries.empty()) return bytes;
    IntegerEncoder encoder;
    ChunkEntry previous;
    for (const ChunkEntry& e : entries) {
        if (variable) encoder.encode(std::int32_t(previous.count), std::int32_t(e.count), 0);
        encoder.encode(std::int32_t(previous.bytes), std::int32_t(e.bytes), 1);
        previous = e;
    }
    const auto coded = encoder.finish();
    bytes.insert(bytes.end(), coded.begin(), coded.end());
    return bytes;
}

std::optional<std::vector<ChunkEntry>> decodeChunkTable(std::span<const std::byte> data, bool variable,
                                                        std::uint64_t maxEntries)
{
    if (data.size() < kTableHead) return {};
    std::uint32_t version = 0, count = 0;
    std::memcpy(&version, data.data(), 4);
    std::memcpy(&count, data.data() + 4, 4);
    if (version != 0 || count > maxEntries) return {};
    std::vector<ChunkEntry> entries;
    if (count == 0) return entries;
    entries.reserve(count);
    IntegerDecoder decoder(data.subspan(kTableHead));
    ChunkEntry previous;
    for (std::uint32_t k = 0; k < count; ++k) {
        ChunkEntry e;
        if (variable) e.count = std::uint32_t(decoder.decode(std::int32_t(previous.count), 0));
        e.bytes = std::uint32_t(decoder.decode(std::int32_t(previous.bytes), 1));
        if (decoder.overrun()) return {};
        entries.push_back(previous = e);
    }
    return entries;
}

ChunkList findChunks(const File& file, std::uint64_t begin, std::uint64_t end, const LazInfo& info,
                     std::span<const std::uint64_t> counts, OnlyChunk only)
{
    return Finder(file, begin, end, info, counts, only).find();
}

}  // namespace punctum::las
