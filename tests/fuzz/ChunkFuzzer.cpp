// SPDX-License-Identifier: MIT
// One chunk of compressed points of any format, by our decoder and LASzip's, through the reader, then compressed
// and read again. Input: format; bits 0-2 of the second byte: extra bytes, bits 3-4: version of the items, bit 5:
// one stream instead of chunks; number of points (u16); the chunk.
#include "core/las/ChunkCodec.h"
#include "core/las/ChunkDecoder.h"
#include "core/las/ChunkTable.h"
#include "core/las/Reader.h"
#include "core/task/Progress.h"
#include "tests/core/LasFiles.h"
#include "tests/fuzz/Fuzz.h"

using namespace punctum;
using fuzz::promise;

namespace
{

constexpr std::size_t kMostPoints = 4096;  ///< that the table says
constexpr PointIndex kMostRead = 100000;
constexpr std::size_t kItemsAt = 34, kItemBytes = 6;
constexpr std::uint16_t kWave13 = 9, kWave14 = 13;

/// The laszip record with items of another version, if that exists.
std::vector<std::byte> payloadOf(const las::LazInfo& standard, unsigned version, bool stream,
                                 std::uint32_t chunkSize)
{
    lasfiles::Bytes payload = standard.payload;
    for (std::size_t k = 0; k < standard.items.size(); ++k) {
        const las::LazInfo::Item& item = standard.items[k];
        if (item.type == kWave13) continue;
        const bool extended = las::isExtendedFormat(standard.format);
        const auto v = std::uint16_t(extended ? 2 + version % 3 : 1 + version % 2);
        lasfiles::set<std::uint16_t>(payload, kItemsAt + kItemBytes * k + 4, v);
    }
    if (stream) lasfiles::set<std::uint16_t>(payload, 0, las::LazInfo::Pointwise);
    lasfiles::set<std::uint32_t>(payload, 12, chunkSize);
    return payload;
}

lasfiles::Bytes fileAround(std::span<const std::byte> chunk, const las::LazInfo& standard, unsigned version,
                           bool stream, std::uint32_t count)
{
    const lasfiles::Bytes vlr =
        lasfiles::record(las::kLaszipUser, las::kLaszipRecordId, payloadOf(standard, version, stream, count));
    lasfiles::Bytes head = lasfiles::header(lasfiles::minorFor(standard.format),
                                            std::uint8_t(standard.format | 0x80), standard.recordLength, count);
    lasfiles::Bytes points(chunk.begin(), chunk.end());
    if (!stream) {
        const las::ChunkEntry entry{0, std::uint32_t(chunk.size())};
        points.insert(points.begin(), 8, std::byte(0));
        lasfiles::set<std::int64_t>(points, 0, std::int64_t(head.size() + vlr.size() + points.size()));
        lasfiles::append(points, las::encodeChunkTable(std::span(&entry, 1), false));
    }
    return lasfiles::file(head, {vlr}, points);
}

/// What could be read is the same when it is written and read again.
void encodeAgain(const las::LazInfo& standard, const lasfiles::Bytes& records)
{
    const auto chunk = las::encodeChunk(standard, records, Progress());
    const std::size_t count = records.size() / standard.recordLength;
    if (standard.compressor == las::LazInfo::Layered)
        promise(las::checkLayeredChunk(chunk, standard, std::uint32_t(count)).empty(),
                "our own chunks pass our checks");
    las::PointDecoder decoder(standard, chunk, count);
    lasfiles::Bytes back(records.size());
    promise(decoder.decode(count, back.data()) == count, "our own chunks are read");
    // LASzip itself loses wave packets of more than 2^31 bytes, which our writer finds out.
    promise(back == records || las::hasWaveform(standard.format), "compressed points are as they were");
    promise(decoder.position() == chunk.size(), "our own chunks end where they should");
}

/// Our decoders and LASzip's, where both read all points, read the same. LASzip lets more damage in layers pass.
void decodeByBoth(const las::LazInfo& info, std::span<const std::byte> chunk, std::uint32_t count)
{
    if (las::ChunkDecoder::make(info) == nullptr || chunk.size() < info.recordLength) return;
    const auto onlyOurs = [](const las::LazInfo::Item& item) { return item.type == kWave14 && item.version == 2; };
    if (std::any_of(info.items.begin(), info.items.end(), onlyOurs)) return;
    if (info.compressor == las::LazInfo::Layered && !las::checkLayeredChunk(chunk, info, count).empty()) return;
    lasfiles::Bytes ours(std::size_t(count) * info.recordLength), theirs(ours.size());
    las::PointDecoder own(info, chunk, count), laszip(info, chunk, count, las::PointDecoder::Codec::Laszip);
    const std::size_t read = own.decode(count, ours.data());
    if (read != count || own.position() != chunk.size()) return;
    promise(laszip.decode(count, theirs.data()) == count, "LASzip reads what we read to the end");
    promise(ours == theirs, "both decoders read the same points");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    fuzz::oneThread();
    fuzz::Input input(data, size);
    const auto format = std::uint8_t(input.take<std::uint8_t>() % (las::kLastPointFormat + 1));
    const auto choice = input.take<std::uint8_t>();
    const auto count = std::uint32_t(1 + input.take<std::uint16_t>() % kMostPoints);
    const auto length = std::uint16_t(las::standardRecordLength(format) + (choice & 7));
    const bool stream = (choice & 32) != 0 && !las::isExtendedFormat(format);
    const las::LazInfo standard = las::LazInfo::standard(format, length);
    const las::Vlr record = las::makeVlr(las::kLaszipUser, las::kLaszipRecordId, "",
                                         payloadOf(standard, choice >> 3 & 3, false, count));
    decodeByBoth(las::LazInfo::parse(record, format, length), input.rest(), count);
    static fuzz::MemoryFile memory;
    memory.set(fileAround(input.rest(), standard, choice >> 3 & 3, stream, count));

    lasfiles::Bytes records;
    try {
        const auto reader = las::Reader::open(memory.path());
        const PointIndex points = reader->source()->pointCount;
        if (points > kMostRead) return -1;
        records.resize(std::size_t(points) * length);
        Progress progress;
        const auto result = reader->visitRecords(progress, [&](PointRange r, std::span<const std::byte> bytes) {
            promise(r.last <= points && bytes.size() == r.size() * length, "records come in their places");
            std::memcpy(records.data() + r.first * length, bytes.data(), bytes.size());
        });
        fuzz::checkSentences(result.warnings);
        for (const PointRange& m : result.missing)
            promise(!m.empty() && m.last <= points, "what is missing exists");
        if (points == 0 || !result.missing.empty() || points > las::kDefaultChunkSize) return 0;
    } catch (const Error& e) {
        fuzz::checkSentence(e);
        return 0;
    }
    encodeAgain(standard, records);
    return 0;
}
