// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/ChunkCodec.h"
#include "core/las/File.h"
#include "core/las/PointFormat.h"
#include "core/las/SourceParser.h"
#include "core/task/Progress.h"

#include <QTest>

#include <cstring>
#include <filesystem>
#include <functional>
#include <random>

namespace punctum::las
{

/// What the tests of the chunk decoders share: decoding as readers do, and records and damage that reach every
/// branch.

using Bytes = std::vector<std::byte>;

struct Decoded {
    Bytes records;  ///< of the points that could be decoded
    std::uint64_t position = 0;

    bool whole(std::size_t count, std::size_t length, std::size_t bytes) const
    {
        return records.size() == count * length && position == bytes;
    }
};

inline Decoded decode(const LazInfo& info, std::span<const std::byte> chunk, std::size_t count,
                      PointDecoder::Codec codec)
{
    PointDecoder decoder(info, chunk, count, codec);
    Decoded d;
    d.records.resize(count * info.recordLength);
    // in uneven pieces, as readers do
    std::size_t done = 0;
    for (std::size_t step = 1; done < count; step = step * 2 + 1) {
        const std::size_t want = std::min(step, count - done);
        const std::size_t got = decoder.decode(want, d.records.data() + done * info.recordLength);
        done += got;
        if (got < want) break;
    }
    d.records.resize(done * info.recordLength);
    d.position = decoder.position();
    return d;
}

/// Calls `take` with each chunk of the real files that are sound and compressed as `supported` wants it.
inline std::size_t forEachRealChunk(
    const std::function<bool(const LazInfo&)>& supported,
    const std::function<void(const std::filesystem::path&, const LazInfo&, const Chunk&, const Bytes&)>& take)
{
    std::size_t chunks = 0;
    for (const auto& entry : std::filesystem::directory_iterator(PUNCTUM_TEST_DATA)) {
        if (entry.path().extension() != ".laz" || entry.path().filename().string().starts_with("broken_")) continue;
        const File file(entry.path());
        const ParsedFile parsed = parseFile(file);
        if (!supported(parsed.laz)) continue;
        for (const Chunk& chunk : parsed.chunks) {
            Bytes data(chunk.bytes);
            file.readAt(chunk.offset, data);
            take(entry.path(), parsed.laz, chunk, data);
            ++chunks;
        }
    }
    return chunks;
}

/// Our decoder against LASzip on real chunks; `ends`: LASzip tells where a chunk ends as well.
inline void compareRealChunks(const std::function<bool(const LazInfo&)>& supported, bool ends)
{
    if (!std::filesystem::is_directory(PUNCTUM_TEST_DATA)) QSKIP("The folder of real files is not here.");
    const std::size_t chunks = forEachRealChunk(
        supported,
        [&](const std::filesystem::path& path, const LazInfo& info, const Chunk& chunk, const Bytes& data) {
            const Decoded ours = decode(info, data, chunk.count, PointDecoder::Codec::Fastest);
            const Decoded theirs = decode(info, data, chunk.count, PointDecoder::Codec::Laszip);
            QVERIFY2(ours.records == theirs.records, path.c_str());
            QCOMPARE(ours.position, chunk.bytes);
            if (ends) QCOMPARE(theirs.position, chunk.bytes);
        });
    qInfo("%zu chunks of real files", chunks);
    QVERIFY(chunks > 0);
}

/// Decodes our own chunk, and once more from a decoder that has another chunk behind it.
inline void checkMadeChunk(const LazInfo& info, const Bytes& records, const Bytes& chunk)
{
    const std::size_t count = records.size() / info.recordLength;
    const Decoded ours = decode(info, chunk, count, PointDecoder::Codec::Fastest);
    QVERIFY(ours.records == records);
    QCOMPARE(ours.position, std::uint64_t(chunk.size()));
    PointDecoder again(info, chunk, count);
    Bytes into(records.size());
    QCOMPARE(again.decode(count / 2, into.data()), count / 2);
    again.restart(chunk);
    QCOMPARE(again.decode(count, into.data()), count);
    QVERIFY(into == records);
    QCOMPARE(again.position(), std::uint64_t(chunk.size()));
}

/// One of four kinds of damage: a bit, a run of garbage, an end of one value, an end cut off.
inline Bytes damaged(const Bytes& sound, unsigned kind, std::mt19937& random)
{
    Bytes chunk = sound;
    const std::size_t at = random() % chunk.size();
    switch (kind % 4) {
        case 0:
            chunk[at] ^= std::byte(1u << (random() % 8));
            break;
        case 1:
            for (std::size_t k = at; k < std::min(at + 16, chunk.size()); ++k) chunk[k] = std::byte(random());
            break;
        case 2:
            std::fill(chunk.begin() + std::ptrdiff_t(at), chunk.end(), std::byte(random() % 2 == 0 ? 0 : 0xFF));
            break;
        default:
            chunk.resize(at);
    }
    return chunk;
}

/// Makes records whose fields change now and then, a little, a lot, or to what they were, in all combinations.
class RecordSource
{
public:
    RecordSource(std::uint8_t format, std::uint16_t length, unsigned seed)
        : m_format(format), m_record(length), m_random(seed)
    {
        for (auto& b : m_record) b = std::byte(m_random());
        for (auto& t : m_times) t = below(2) == 0 ? m_random() : below(100'000);
    }
    /// Formats 6 to 10: each point is of another scanner channel than the one before.
    void alwaysChangeChannel() { m_alwaysChangeChannel = true; }
    Bytes make(std::size_t count)
    {
        Bytes all(count * m_record.size());
        for (std::size_t i = 0; i < count; ++i) {
            // some parts of a chunk are quiet, some are noise
            if (below(200) == 0) m_activity = double(below(101)) / 100;
            next();
            std::memcpy(all.data() + i * m_record.size(), m_record.data(), m_record.size());
        }
        return all;
    }

private:
    std::uint64_t below(std::uint64_t n) { return m_random() % n; }
    bool changes() { return double(below(1000)) < 1000 * m_activity; }
    template <typename T>
    T get(std::size_t at) const
    {
        T v;
        std::memcpy(&v, m_record.data() + at, sizeof v);
        return v;
    }
    template <typename T>
    void set(std::size_t at, T v)
    {
        std::memcpy(m_record.data() + at, &v, sizeof v);
    }
    void next()
    {
        const bool extended = isExtendedFormat(m_format);
        for (std::size_t at = 0; at < 12; at += 4) axis(at);
        if (changes()) m_record[12] = std::byte(m_random());
        if (below(9) == 0) m_record[13] = std::byte(m_random());
        if (extended) extendedFields();
        const std::size_t plain = extended ? 22 : 20;
        for (std::size_t at = extended ? 16 : 14; at < plain; ++at)
            if (changes() && below(4) == 0) m_record[at] = std::byte(below(3) == 0 ? m_random() : below(3));
        std::size_t at = plain;
        if (hasGpsTime(m_format)) time(std::exchange(at, at + 8));
        if (hasColor(m_format)) color(std::exchange(at, at + 6));
        if (hasNir(m_format)) {
            for (std::size_t k = 0; k < 2; ++k)
                if (changes()) m_record[at + k] = std::byte(m_random());
            at += 2;
        }
        if (hasWaveform(m_format)) wave(std::exchange(at, at + 29));
        for (; at < m_record.size(); ++at)
            if (changes()) m_record[at] = std::byte(m_random());
    }
    void axis(std::size_t at)
    {
        const unsigned bits = unsigned(below(changes() ? 33 : 6));
        const std::uint64_t size = bits == 0 ? 1 : std::uint64_t(1) << bits;
        set(at, get<std::uint32_t>(at) + std::uint32_t(below(size)) - std::uint32_t(size / 2));
    }
    /// Returns, and flags with the scanner channel.
    void extendedFields()
    {
        const auto returns = get<std::uint8_t>(14);
        const unsigned number = returns & 15;
        switch (below(8)) {
            case 0:
                set(14, std::uint8_t(m_random()));
                break;
            case 1:
                set(14, std::uint8_t((returns & 0xF0) | ((number + 1) & 15)));
                break;
            case 2:
                set(14, std::uint8_t((returns & 0xF0) | ((number - 1) & 15)));
                break;
            case 3:
                set(14, std::uint8_t((returns & 0xF0) | below(16)));
                break;
            case 4:
                set(14, std::uint8_t(0x11));
                break;
            default:
                break;
        }
        if (changes() && below(4) == 0) set(15, std::uint8_t((get<std::uint8_t>(15) & 0x30) | (m_random() & 0xCF)));
        const bool anyChannel = below(12) == 0;
        if (m_alwaysChangeChannel || anyChannel) {
            const std::uint64_t change = m_alwaysChangeChannel ? 1 + below(3) : below(4);
            const auto flags = get<std::uint8_t>(15);
            set(15, std::uint8_t((flags & 0xCF) | ((flags + (change << 4)) & 0x30)));
        }
    }
    void time(std::size_t at)
    {
        if (below(6) == 0) m_sequence = below(4);
        std::uint64_t& t = m_times[m_sequence];
        std::int64_t& step = m_timeSteps[m_sequence];
        switch (below(40)) {
            case 0:
                t = m_random();
                break;
            case 1:
                t += below(0x100000000u);
                break;
            case 2:
                step = std::int64_t(below(2000)) - 1000;
                break;
            case 3:
                break;  // the same again
            case 4:
                t -= std::uint64_t(step * std::int64_t(below(15)));
                break;
            case 5:
                t += std::uint64_t(step * std::int64_t(below(700)) + std::int64_t(below(9)));
                break;
            default:
                t += std::uint64_t(step + (changes() ? std::int64_t(below(7)) - 3 : 0));
        }
        if (!isExtendedFormat(m_format) || below(3) != 0) set(at, t);
    }
    void color(std::size_t at)
    {
        if (!changes()) return;
        const bool gray = below(3) == 0;
        for (std::size_t k = 0; k < 6; ++k)
            if (below(3) != 0) m_record[at + k] = std::byte(m_random());
        if (gray)
            for (std::size_t k = 2; k < 6; ++k) m_record[at + k] = m_record[at + k % 2];
    }
    void wave(std::size_t at)
    {
        auto offset = get<std::uint64_t>(at + 1);
        const auto size = get<std::uint32_t>(at + 9);
        switch (below(5)) {
            case 0:
                offset += size;
                break;
            case 1:
                offset += below(5000);
                break;
            case 2:
                offset = changes() ? m_random() : offset - below(100);
                break;
            default:
                break;
        }
        set(at + 1, offset);
        if (changes()) set(at + 9, std::uint32_t(below(4) == 0 ? m_random() : 512));
        if (below(50) == 0) m_record[at] = std::byte(below(4));
        for (std::size_t k = at + 13; k < at + 29; ++k)
            if (changes() && below(4) == 0) m_record[k] = std::byte(m_random());
    }

    std::uint8_t m_format;
    Bytes m_record;
    std::mt19937_64 m_random;
    double m_activity = 0.5;
    std::uint64_t m_times[4] = {};
    std::int64_t m_timeSteps[4] = {1000, -37, 5, 70000};
    std::size_t m_sequence = 0;
    bool m_alwaysChangeChannel = false;
};

}  // namespace punctum::las
