// SPDX-License-Identifier: MIT
#include "core/las/ChunkProbe.h"

#include "core/las/ChunkDecoder.h"
#include "core/las/File.h"
#include "core/las/PointwiseDecoder.h"
#include "core/task/Progress.h"

#include <algorithm>
#include <cstring>
#include <optional>

namespace punctum::las
{

namespace
{

constexpr std::size_t kProbeStep = 1024;
constexpr std::size_t kFewestZeros = 2;                    ///< at the end of a coder's bytes: RangeEncoder::finish
constexpr std::size_t kByChance = 2;                       ///< more of them are no surprise
constexpr std::size_t kLongZeros = 16;                     ///< that many in a row no coder writes by chance
constexpr std::size_t kLeastHole = 512;                    ///< the least that a copy leaves out
constexpr std::size_t kMostProved = std::size_t(1) << 30;  ///< bytes of records that are compressed for a proof
constexpr std::size_t kWindow = std::size_t(1) << 16;

std::size_t zerosAtEnd(std::span<const std::byte> data)
{
    const auto last = std::find_if(data.rbegin(), data.rend(), [](std::byte b) { return b != std::byte(0); });
    return std::size_t(last - data.rbegin());
}

/// Where the first run of at least so many zeros begins; data.size() when there is none. A run has one of every
/// `least` bytes.
std::size_t firstZeros(std::span<const std::byte> data, std::size_t least = kLongZeros)
{
    for (std::size_t at = least - 1; at < data.size(); at += least) {
        if (data[at] != std::byte(0)) continue;
        std::size_t begin = at;
        while (begin > 0 && data[begin - 1] == std::byte(0)) --begin;
        const auto run = data.subspan(begin, std::min(least, data.size() - begin));
        if (zerosAtEnd(run) == least) return begin;
    }
    return data.size();
}

bool provable(const LazInfo& info, std::uint64_t count)
{
    return count <= kMostProved / info.recordLength;
}

/// The bytes that a chunk's points give when they are compressed again.
std::vector<std::byte> compressedAgain(const LazInfo& info, std::span<const std::byte> data, std::uint64_t count)
{
    std::vector<std::byte> records(std::size_t(count * info.recordLength));
    PointDecoder again(info, data, count);
    if (again.decode(std::size_t(count), records.data()) != count) return {};
    return encodeChunk(info, records, Progress());
}

}  // namespace

std::vector<std::byte> ChunkProbe::load(const Chunk& chunk) const
{
    std::vector<std::byte> data(std::size_t(chunk.bytes));
    m_file.readAt(chunk.offset, data);
    return data;
}

std::uint64_t ChunkProbe::decodable(const Chunk& chunk, std::uint64_t count, std::uint64_t* consumed) const
{
    std::vector<std::byte> data;
    std::optional<PointDecoder> decoder;
    if (m_info.compressor == LazInfo::Pointwise) {
        decoder.emplace(m_info, m_file, chunk.offset, chunk.bytes, count);
    } else {
        data = load(chunk);
        decoder.emplace(m_info, data, count);
    }
    std::vector<std::byte> records(kProbeStep * m_info.recordLength);
    std::uint64_t n = 0;
    while (n < count) {
        const auto step = std::size_t(std::min<std::uint64_t>(kProbeStep, count - n));
        const std::size_t got = decoder->decode(step, records.data());
        n += got;
        if (got < step) break;
        if (consumed == nullptr && decoder->position() >= chunk.bytes) break;
    }
    if (consumed != nullptr) *consumed = decoder->position();
    return n;
}

bool ChunkProbe::endsExactly(const Chunk& chunk) const
{
    std::uint64_t consumed = 0;
    return decodable(chunk, chunk.count, &consumed) == chunk.count && consumed == chunk.bytes;
}

std::uint64_t ChunkProbe::pointsUntilEnd(const Chunk& chunk) const
{
    const auto data = load(chunk);
    PointDecoder decoder(m_info, data, kMostPoints);
    std::vector<std::byte> record(m_info.recordLength);
    std::uint64_t n = 0;
    // `position` reaches the end some points early only where points take no bytes at all
    while (n < std::max<std::uint64_t>(data.size() * 8, 1) && decoder.decode(1, record.data()) == 1) {
        ++n;
        if (decoder.position() >= data.size()) return wholeChunk(m_info, data, n, decoder) ? n : 0;
    }
    return 0;
}

Chunk ChunkProbe::next(std::uint64_t at, std::uint64_t end, std::uint64_t first, std::uint64_t want) const
{
    PointDecoder decoder(m_info, m_file, at, end - at, want);
    std::vector<std::byte> records(kProbeStep * m_info.recordLength);
    std::uint64_t n = 0;
    while (n < want) {
        const auto step = std::size_t(std::min<std::uint64_t>(kProbeStep, want - n));
        const std::size_t got = decoder.decode(step, records.data());
        n += got;
        if (got < step) break;
    }
    const std::uint64_t taken = decoder.position();
    Chunk chunk{at, std::min(taken, end - at), first, n, n < want};
    const std::vector<std::byte> data = load(chunk);
    if (!chunk.cut && zerosAtEnd(data) >= kFewestZeros && wholeChunk(m_info, data, n, decoder)) return chunk;
    // What comes before a long run of zeros is sound, and so is all when the bytes just end; other damage may be
    // anywhere.
    const auto coded = std::span(data).subspan(std::min<std::size_t>(m_info.recordLength, data.size()));
    const std::size_t zeros = firstZeros(coded);
    const bool ended = n < want && taken > end - at;
    chunk.cut = true;
    if (zeros != coded.size()) {
        chunk.bytes = data.size() - coded.size() + zeros;
        chunk.count = decodable(chunk, n);
    } else if (!ended) {
        chunk.count = 0;
    }
    return chunk;
}

Chunk ChunkProbe::withoutZeros(const Chunk& chunk) const
{
    const std::uint64_t end = chunk.offset + chunk.bytes;
    const std::uint64_t coded = chunk.offset + std::min<std::uint64_t>(m_info.recordLength, chunk.bytes);
    std::uint64_t zeros = zerosFrom(m_file, coded, end, kLongZeros);
    if (zeros == end) return chunk;
    if (chunk.bytes <= kMostProved && provable(m_info, chunk.count) && PointwiseDecoder::supports(m_info)) {
        const auto data = load(chunk);
        std::vector<std::byte> records(std::size_t(chunk.count * m_info.recordLength));
        PointDecoder decoder(m_info, data, chunk.count);
        if (decoder.decode(std::size_t(chunk.count), records.data()) == chunk.count &&
            wholeChunk(m_info, data, chunk.count, decoder))
            return chunk;
    } else {  // nothing proves it: short runs are believed but at the end
        const std::uint64_t last = zerosBefore(m_file, coded, end);
        zeros = std::min(zerosFrom(m_file, coded, end, kLeastHole), end - last >= kLongZeros ? last : end);
        if (zeros == end) return chunk;
    }
    Chunk sound = chunk;
    sound.bytes = zeros - chunk.offset;
    sound.count = decodable(sound, chunk.count);
    if (sound.count == chunk.count) return chunk;
    sound.cut = true;
    return sound;
}

bool wholeChunk(const LazInfo& info, std::span<const std::byte> data, std::uint64_t count,
                const PointDecoder& decoder)
{
    if (decoder.own() != nullptr && info.compressor == LazInfo::Layered) return decoder.own()->endsAsWritten();
    const auto coded = data.subspan(std::min<std::size_t>(info.recordLength, data.size()));
    const std::size_t zeros = zerosAtEnd(coded);
    if (decoder.own() == nullptr) return zeros < kLongZeros;  // of version 1: we do not write those
    if (!decoder.own()->endsAsWritten()) return false;
    if (zeros <= decoder.own()->zerosAtEnd() + kByChance && firstZeros(coded) == coded.size()) return true;
    if (!provable(info, count)) return false;
    const std::vector<std::byte> again = compressedAgain(info, data, count);
    return std::equal(again.begin(), again.end(), data.begin(), data.end());
}

std::uint64_t zerosFrom(const File& file, std::uint64_t begin, std::uint64_t end, std::uint64_t least)
{
    std::vector<std::byte> window;
    std::uint64_t run = 0;  // zeros before `at`
    for (std::uint64_t at = begin; at < end; at += window.size()) {
        window.resize(std::size_t(std::min<std::uint64_t>(kWindow, end - at)));
        file.readAt(at, window);
        for (std::size_t k = 0; k < window.size(); ++k) {
            run = window[k] == std::byte(0) ? run + 1 : 0;
            if (run == least) return at + k + 1 - run;
        }
    }
    return end;
}

std::uint64_t zerosBefore(const File& file, std::uint64_t begin, std::uint64_t end, std::uint64_t most)
{
    std::vector<std::byte> window;
    const std::uint64_t from = end - std::min(end - begin, most);
    std::uint64_t at = end;
    while (at > from) {
        window.resize(std::size_t(std::min<std::uint64_t>(kWindow, at - from)));
        file.readAt(at - window.size(), window);
        const std::size_t zeros = zerosAtEnd(window);
        at -= zeros;
        if (zeros != window.size()) break;
    }
    return at;
}

}  // namespace punctum::las
