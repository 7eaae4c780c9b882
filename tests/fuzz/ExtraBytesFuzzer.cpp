// SPDX-License-Identifier: MIT
// Descriptions of extra bytes, laid over records, and records taken apart and put together again.
// Input: format, extra bytes (u16), then records, each with its length (u16) in front.
#include "core/cloud/PointCloud.h"
#include "core/las/ExtraBytes.h"
#include "core/las/RecordBlocks.h"
#include "core/las/SourceFile.h"
#include "tests/fuzz/Fuzz.h"

using namespace punctum;
using fuzz::promise;

namespace
{

constexpr std::size_t kPoints = 19;
constexpr std::size_t kMostRecords = 8;

void roundTrip(const las::RecordLayout& layout)
{
    PointCloud cloud(kPoints, {});
    las::makeColumns(cloud, layout);
    promise(cloud.columns().size() == layout.fields.size(), "each field has its column");
    std::vector<std::byte> records(kPoints * layout.length), back(records.size());
    for (std::size_t k = 0; k < records.size(); ++k) records[k] = std::byte(k * 37 + 11);
    std::vector<std::byte*> to;
    std::vector<const std::byte*> from;
    for (const auto& c : cloud.columns()) {
        to.push_back(c->data());
        from.push_back(c->data());
    }
    const las::Deinterleaver deinterleave(layout);
    deinterleave(records.data(), kPoints, to);
    las::interleave(layout, from, kPoints, back.data());
    promise(records == back, "records are put together as they were");
    for (const Attribute& a : cloud.attributes())
        for (std::size_t i = 0; i < kPoints; ++i)
            if (a.components == 1 && a.kind != AttributeKind::Opaque) (void)a.number(i);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    fuzz::Input input(data, size);
    const auto format = std::uint8_t(input.take<std::uint8_t>() % (las::kLastPointFormat + 1));
    const std::uint32_t length = las::standardRecordLength(format) + std::uint32_t(input.take<std::uint16_t>());
    if (length > UINT16_MAX) return -1;
    std::vector<las::Vlr> records;
    while (!input.rest().empty() && records.size() < kMostRecords) {
        const auto payload = input.take(input.take<std::uint16_t>());
        records.push_back(
            las::makeVlr("LASF_Spec", las::kExtraBytesRecordId, "", {payload.begin(), payload.end()}));
    }
    std::vector<const las::Vlr*> pointers;
    for (const las::Vlr& r : records) pointers.push_back(&r);
    try {
        std::vector<std::string> warnings;
        const auto items = las::parseExtraBytes(pointers, las::standardRecordLength(format), length, warnings);
        std::uint32_t at = las::standardRecordLength(format);
        for (const las::ExtraBytesItem& item : items) {
            promise(item.offset == at && item.bytes > 0 && item.bytes <= length - at, "items follow one another");
            promise(item.bytes == item.values * sizeOf(item.type), "an item's values fill its bytes");
            at += item.bytes;
        }
        const las::RecordLayout layout = las::makeLayout(format, std::uint16_t(length), pointers, {}, warnings);
        fuzz::checkSentences(warnings);
        fuzz::checkLayout(layout);
        roundTrip(layout);
    } catch (const Error& e) {
        fuzz::checkSentence(e);
    }
    return 0;
}
