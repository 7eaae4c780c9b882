// SPDX-License-Identifier: MIT
#include "core/las/ChunkTable.h"

#include "core/Error.h"
#include "core/las/File.h"
#include "core/las/RangeCoder.h"

#include <algorithm>
#include <cstring>

namespace punctum::las
{

namespace
{

constexpr std::size_t kTableHead = 8;  ///< version, number of chunks
constexpr std::size_t kPointerBytes = 8;
constexpr std::uint64_t kMostPoints = std::uint64_t(1) << 31;  ///< in one chunk
constexpr std::uint64_t kMostPointsAByte = 4096;
constexpr std::size_t kDecodeStep = 1024;

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
           std::span<const std::uint64_t> counts)
        : m_file(file), m_begin(begin), m_end(end), m_info(info), m_counts(counts)
    {
    }

    ChunkList find()
    {
        if (m_info.compressor == LazInfo::Pointwise) {
            pointwise();
        } else if (m_end - m_begin < kPointerBytes) {
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
            c.count = decodable(c, stated());
            c.cut = true;
            warnCount(stated(), c.count);
        }
        if (c.count != 0) m_list.chunks.push_back(c);
        m_list.end = m_end;
    }

    bool fromTable()
    {
        auto position = readValue<std::int64_t>(m_file, m_begin);
        if (position == -1 && m_end - m_begin >= 2 * kPointerBytes)
            position = readValue<std::int64_t>(m_file, m_end - kPointerBytes);  // written to a stream without seeks
        const std::uint64_t chunksBegin = m_begin + kPointerBytes;
        if (position < 0 || std::uint64_t(position) < chunksBegin || std::uint64_t(position) > m_end ||
            m_end - std::uint64_t(position) < kTableHead)
            return false;
        const auto tableAt = std::uint64_t(position);
        m_tableAt = tableAt;
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
            if (endsExactly(last)) return true;
        }
        return countByDecoding();
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

    /// The head of the last chunk is damaged: reading will find that out, here only its size matters.
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

    bool endsExactly(const Chunk& c) const
    {
        std::uint64_t consumed = 0;
        return decodable(c, c.count, &consumed) == c.count && consumed == c.bytes;
    }

    /// The chunk size in the record or the header's count is wrong: decode until each chunk's bytes are used up.
    bool countByDecoding()
    {
        std::vector<Chunk>& chunks = m_list.chunks;
        // The first chunk tells whether the stated size is right for all but the last.
        const bool sizeHolds = chunks.size() > 1 && endsExactly(chunks.front());
        if (!sizeHolds && chunks.size() > 1)
            m_list.warnings.push_back("The stated chunk size " + number(m_info.chunkSize) +
                                      " is wrong; the chunks were counted.");
        std::uint64_t first = 0;
        for (Chunk& c : chunks) {
            c.first = first;
            if (!sizeHolds || &c == &chunks.back()) {
                const std::uint64_t n = pointsUntilEnd(c);
                if (n == 0) return false;
                c.count = n;
            }
            first += c.count;
        }
        warnCount(stated(), first);
        return true;
    }

    std::vector<std::byte> load(const Chunk& c) const
    {
        std::vector<std::byte> data(std::size_t(c.bytes));
        m_file.readAt(c.offset, data);
        return data;
    }

    std::uint64_t pointsUntilEnd(const Chunk& c) const
    {
        const auto data = load(c);
        PointDecoder decoder(m_info, data, kMostPoints);
        std::vector<std::byte> record(m_info.recordLength);
        std::uint64_t n = 0;
        // `position` reaches the end some points early only where points take no bytes at all
        while (n < std::max<std::uint64_t>(data.size() * 8, 1) && decoder.decode(1, record.data()) == 1) {
            ++n;
            if (decoder.position() >= data.size()) return n;
        }
        return 0;
    }

    /// How many of `count` points can be decoded from the chunk's bytes.
    std::uint64_t decodable(const Chunk& c, std::uint64_t count, std::uint64_t* consumed = nullptr) const
    {
        LazInfo info = m_info;
        std::vector<std::byte> data;
        std::optional<PointDecoder> decoder;
        if (info.compressor == LazInfo::Pointwise) {
            decoder.emplace(info, m_file, c.offset, c.bytes, count);
        } else {
            data = load(c);
            decoder.emplace(info, data, count);
        }
        std::vector<std::byte> records(kDecodeStep * info.recordLength);
        std::uint64_t n = 0;
        while (n < count) {
            const std::size_t step = std::size_t(std::min<std::uint64_t>(kDecodeStep, count - n));
            const std::size_t got = decoder->decode(step, records.data());
            n += got;
            if (got < step) break;
            if (consumed == nullptr && decoder->position() >= c.bytes) break;
        }
        if (consumed != nullptr) *consumed = decoder->position();
        return n;
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
        m_list.end = m_end;
        endOfWalk();
    }
    std::uint64_t walkLayered(std::uint64_t end, bool untilAllFound)
    {
        std::uint64_t at = m_begin + kPointerBytes, points = 0;
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

    /// Chunks of a fixed size follow each other; where one ends is known only when it is decoded.
    void walkChunked()
    {
        if (m_info.variable())
            throw Error(m_file.path(),
                        "The table of compressed chunks is damaged and cannot be rebuilt, because the "
                        "chunks differ in size.");
        const std::uint64_t chunksBegin = m_begin + kPointerBytes;
        std::vector<std::byte> records(kDecodeStep * m_info.recordLength);
        std::uint64_t at = chunksBegin, points = 0;
        while (points < stated() && at < m_end) {
            const std::uint64_t want = std::min<std::uint64_t>(m_info.chunkSize, stated() - points);
            PointDecoder decoder(m_info, m_file, at, m_end - at, want);
            std::uint64_t n = 0;
            while (n < want) {
                const std::size_t step = std::size_t(std::min<std::uint64_t>(kDecodeStep, want - n));
                const std::size_t got = decoder.decode(step, records.data());
                n += got;
                if (got < step) break;
            }
            const std::uint64_t bytes = std::min(decoder.position(), m_end - at);
            if (n != 0) m_list.chunks.push_back({at, bytes, points, n, n < want});
            points += n;
            at += bytes;
            if (n < want) break;
        }
        m_list.end = m_end;
        endOfWalk();
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
        m_list.losses.push_back("The header says " + number(said) + " points, the file holds " + number(found) +
                                ".");
        m_list.warnings.push_back(m_list.losses.back());
    }

    const File& m_file;
    std::uint64_t m_begin;
    std::uint64_t m_end;
    const LazInfo& m_info;
    std::span<const std::uint64_t> m_counts;
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
                     std::span<const std::uint64_t> counts)
{
    return Finder(file, begin, end, info, counts).find();
}

}  // namespace punctum::las
