// SPDX-License-Identifier: MIT
#include "core/las/LazInfo.h"

#include "core/Error.h"
#include "core/las/LaszipHandle.h"

namespace punctum::las
{

namespace
{

enum ItemType : std::uint16_t {
    kByte = 0,
    kPoint10 = 6,
    kGpsTime11 = 7,
    kRgb12 = 8,
    kWave13 = 9,
    kPoint14 = 10,
    kRgb14 = 11,
    kRgbNir14 = 12,
    kWave14 = 13,
    kByte14 = 14
};
constexpr std::size_t kFixedPayload = 34, kItemBytes = 6;
constexpr std::uint32_t kCoreLayers = 9;

/// The items that a record of this format and length is made of (types and sizes).
std::vector<LazInfo::Item> itemsOf(std::uint8_t format, std::uint16_t length)
{
    std::vector<LazInfo::Item> items;
    const bool extended = isExtendedFormat(format);
    items.push_back(extended ? LazInfo::Item{kPoint14, 30, 3} : LazInfo::Item{kPoint10, 20, 2});
    if (!extended && hasGpsTime(format)) items.push_back({kGpsTime11, 8, 2});
    if (hasNir(format))
        items.push_back({kRgbNir14, 8, 3});
    else if (hasColor(format))
        items.push_back(extended ? LazInfo::Item{kRgb14, 6, 3} : LazInfo::Item{kRgb12, 6, 2});
    if (hasWaveform(format))
        items.push_back(extended ? LazInfo::Item{kWave14, 29, 3} : LazInfo::Item{kWave13, 29, 1});
    if (const int extra = length - standardRecordLength(format); extra > 0)
        items.push_back({extended ? kByte14 : kByte, std::uint16_t(extra), std::uint16_t(extended ? 3 : 2)});
    return items;
}

bool versionExists(const LazInfo::Item& item)
{
    if (item.type >= kPoint14) return item.version >= 2 && item.version <= 4;
    if (item.type == kWave13) return item.version == 1;
    return item.version == 1 || item.version == 2;
}

}  // namespace

std::uint32_t LazInfo::layers() const
{
    std::uint32_t n = 0;
    for (const Item& item : items) {
        switch (item.type) {
            case kPoint14:
                n += kCoreLayers;
                break;
            case kRgbNir14:
                n += 2;
                break;
            case kByte14:
                n += item.size;
                break;
            default:
                n += 1;
                break;
        }
    }
    return n;
}

void LazInfo::setChunkSize(std::uint32_t size)
{
    chunkSize = size;
    std::memcpy(payload.data() + kChunkSizeAt, &size, sizeof size);
}

LazInfo LazInfo::parse(const Vlr& record, std::uint8_t format, std::uint16_t recordLength)
{
    const std::vector<std::byte>& d = record.data;
    if (d.size() < kFixedPayload)
        throw Error("The compression record is too short (" + std::to_string(d.size()) + " bytes).");
    LazInfo info;
    info.format = format;
    info.recordLength = recordLength;
    info.compressor = loadAs<std::uint16_t>(d.data());
    const auto coder = loadAs<std::uint16_t>(d.data() + 2);
    if (info.compressor < Pointwise || info.compressor > Layered || coder != 0)
        throw Error("The points are compressed in an unsupported way (compressor " +
                    std::to_string(info.compressor) + ", coder " + std::to_string(coder) + ").");
    if ((info.compressor == Layered) != isExtendedFormat(format))
        throw Error("The compression record does not fit point format " + std::to_string(format) +
                    " (unsupported compressor " + std::to_string(info.compressor) + ").");
    info.chunkSize = loadAs<std::uint32_t>(d.data() + kChunkSizeAt);
    if (info.chunkSize == 0) info.chunkSize = kVariableChunks;

    const std::size_t count = loadAs<std::uint16_t>(d.data() + 32);
    const std::vector<Item> expected = itemsOf(format, recordLength);
    if (d.size() < kFixedPayload + kItemBytes * count)
        throw Error("The compression record is too short for its " + std::to_string(count) + " items.");
    bool fits = count == expected.size();
    for (std::size_t k = 0; fits && k < count; ++k) {
        const std::byte* p = d.data() + kFixedPayload + kItemBytes * k;
        const Item item{loadAs<std::uint16_t>(p), loadAs<std::uint16_t>(p + 2), loadAs<std::uint16_t>(p + 4)};
        fits = item.type == expected[k].type && item.size == expected[k].size;
        if (fits && !versionExists(item))
            throw Error("The points are compressed with an unsupported version (" + std::to_string(item.version) +
                        ") of item " + std::to_string(item.type) + ".");
        info.items.push_back(item);
    }
    if (!fits)
        throw Error("The compression record does not fit point format " + std::to_string(format) +
                    " with records of " + std::to_string(recordLength) + " bytes.");
    info.payload.assign(d.begin(), d.begin() + std::ptrdiff_t(kFixedPayload + kItemBytes * count));
    return info;
}

LazInfo LazInfo::standard(std::uint8_t format, std::uint16_t recordLength)
{
    const LaszipHandle handle;
    laszip_U8* bytes = nullptr;
    laszip_U32 size = 0;
    if (laszip_set_point_type_and_size(handle.get(), format, recordLength) != 0 ||
        laszip_request_native_extension(handle.get(), 1) != 0 ||
        laszip_set_chunk_size(handle.get(), kDefaultChunkSize) != 0 ||
        laszip_create_laszip_vlr(handle.get(), &bytes, &size) != 0 || size < Vlr::kHeaderSize)
        throw Error("LASzip cannot compress point format " + std::to_string(format) + " (" + handle.error() + ").");
    Vlr record;
    const auto* p = reinterpret_cast<const std::byte*>(bytes) + Vlr::kHeaderSize;
    record.data.assign(p, p + size - Vlr::kHeaderSize);
    return parse(record, format, recordLength);
}

bool layeredChunkSize(std::span<const std::byte> start, const LazInfo& info, std::uint32_t& count,
                      std::uint64_t& bytes)
{
    const std::uint32_t layers = info.layers();
    const std::uint64_t head = std::uint64_t(info.recordLength) + 4 + 4 * std::uint64_t(layers);
    if (start.size() < head) return false;
    count = loadAs<std::uint32_t>(start.data() + info.recordLength);
    bytes = head;
    for (std::uint32_t k = 0; k < layers; ++k)
        bytes += loadAs<std::uint32_t>(start.data() + info.recordLength + 4 + 4 * std::size_t(k));
    return count > 0 && bytes < UINT32_MAX;
}

std::string checkLayeredChunk(std::span<const std::byte> chunk, const LazInfo& info,
                              std::optional<std::uint32_t> count)
{
    std::uint32_t stated = 0;
    std::uint64_t bytes = 0;
    if (!layeredChunkSize(chunk, info, stated, bytes)) return "its layer sizes cannot be";
    if (count && stated != *count)
        return "it states " + std::to_string(stated) + " points where the table says " + std::to_string(*count);
    if (bytes != chunk.size()) return "its layers do not fill its bytes";
    return {};
}

}  // namespace punctum::las
