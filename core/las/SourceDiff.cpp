// SPDX-License-Identifier: MIT
#include "core/las/SourceDiff.h"

#include "core/Text.h"
#include "core/las/ChunkCodec.h"
#include "core/las/ExtraBytes.h"
#include "core/las/SourceFile.h"

#include <algorithm>
#include <cstdio>

namespace punctum::las
{

namespace
{

std::string hex(std::span<const std::byte> bytes)
{
    std::string text;
    for (const std::byte b : bytes) {
        char digits[4];
        std::snprintf(digits, sizeof digits, "%02x", std::to_integer<unsigned>(b));
        text += digits;
    }
    return text;
}

using T = HeaderField::Type;

ToldValue told(const HeaderField& f, std::span<const std::byte> bytes)
{
    if (bytes.empty()) return std::monostate{};
    const auto number = [&](auto zero) {
        std::memcpy(&zero, bytes.data(), sizeof zero);
        return zero;
    };
    switch (f.type) {
        case T::U8:
            return std::uint64_t(std::to_integer<unsigned>(bytes[0]) & f.mask);
        case T::U16:
            return std::uint64_t(number(std::uint16_t{}));
        case T::U32:
            return std::uint64_t(number(std::uint32_t{}));
        case T::U64:
            return number(std::uint64_t{});
        case T::F64:
            return number(double{});
        case T::Text:
            return fixedText(bytes);
        case T::Guid:
            break;
    }
    return hex(bytes);
}

bool sameBytes(std::span<const std::byte> a, std::span<const std::byte> b)
{
    return std::equal(a.begin(), a.end(), b.begin(), b.end());
}

void compareFields(const Header& a, const Header& b, Difference& d)
{
    for (const HeaderField& f : headerFields()) {
        if (f.kind == HeaderField::Kind::Place) continue;  // compareContainers looks at what they mean
        for (std::size_t k = 0; k < f.count; ++k) {
            const auto x = f.in(a, k), y = f.in(b, k);
            if (x.size() == y.size()) {
                const bool masked = !x.empty() && f.mask != 0xFF;
                if (masked ? ((x[0] ^ y[0]) & std::byte(f.mask)) == std::byte(0) : sameBytes(x, y)) continue;
            }
            FieldDifference field{f.name, f.group, told(f, x), told(f, y)};
            if (f.count > 1) field.name += "[" + std::to_string(k + 1) + "]";
            // Texts that only differ behind their end, and NaNs, are told by their bytes.
            if (toText(field.a) == toText(field.b)) {
                field.a = "0x" + hex(x);
                field.b = "0x" + hex(y);
            }
            d.header.push_back(std::move(field));
        }
    }
}

void compareBytes(const std::string& what, std::span<const std::byte> a, std::span<const std::byte> b,
                  Difference& d)
{
    const auto at = std::mismatch(a.begin(), a.end(), b.begin(), b.end()).first;
    if (at == a.end() && a.size() == b.size()) return;
    d.bytes.push_back({what, a.size(), b.size(), std::uint64_t(at - a.begin())});
}

// -- records

struct Listed {
    const Vlr* vlr;
    bool matched = false;
};

/// Without the record on compression, and of an octree that both files have without the record of its nodes, which
/// the container is compared by.
std::vector<Listed> listed(const SourceFile& s, bool octrees)
{
    std::vector<Listed> list;
    for (const auto* records : {&s.vlrs, &s.evlrs})
        for (const Vlr& vlr : *records)
            if (!isLaszip(vlr) && !(octrees && isCopcHierarchy(vlr))) list.push_back({&vlr});
    return list;
}

/// The data of a record, but for places in the file.
std::vector<std::byte> contentOf(const Vlr& vlr)
{
    std::vector<std::byte> data = vlr.data;
    if (vlr.is(kCopcUser, kCopcInfoId) && data.size() == copc::kInfoBytes)
        std::fill_n(data.begin() + copc::kRootOffsetAt, copc::kFirstTimeAt - copc::kRootOffsetAt, std::byte(0));
    return data;
}

RecordDifference changeOf(const Vlr& a, const Vlr& b)
{
    RecordDifference r;
    r.user = fixedText(std::as_bytes(std::span(a.userId)));
    r.id = a.recordId;
    r.lengthA = a.data.size();
    r.lengthB = b.data.size();
    r.extendedA = a.extended;
    r.extendedB = b.extended;
    r.frameDiffers = a.reserved != b.reserved || a.userId != b.userId || a.description != b.description;
    const std::vector<std::byte> x = contentOf(a), y = contentOf(b);
    const auto at = std::mismatch(x.begin(), x.end(), y.begin(), y.end()).first;
    if (at != x.end() || x.size() != y.size()) r.firstDataByte = std::uint64_t(at - x.begin());
    return r;
}

RecordDifference only(const Vlr& vlr, RecordDifference::Change change)
{
    RecordDifference r;
    r.change = change;
    r.user = fixedText(std::as_bytes(std::span(vlr.userId)));
    r.id = vlr.recordId;
    (change == RecordDifference::Change::Removed ? r.lengthA : r.lengthB) = vlr.data.size();
    (change == RecordDifference::Change::Removed ? r.extendedA : r.extendedB) = vlr.extended;
    return r;
}

/// Records of the same user and id belong together, in the order in which they come; equal ones first, so that
/// one that goes from among several of its kind does not make the others look changed.
void compareRecords(const SourceFile& a, const SourceFile& b, Difference& d)
{
    const bool octrees = a.copc && b.copc;
    std::vector<Listed> as = listed(a, octrees), bs = listed(b, octrees);
    std::vector<std::size_t> partner(as.size(), bs.size());
    const auto match = [&](auto&& fit) {
        for (std::size_t i = 0; i < as.size(); ++i) {
            if (as[i].matched) continue;
            for (std::size_t k = 0; k < bs.size(); ++k) {
                if (bs[k].matched || !fit(*as[i].vlr, *bs[k].vlr)) continue;
                as[i].matched = bs[k].matched = true;
                partner[i] = k;
                break;
            }
        }
    };
    const auto kin = [](const Vlr& x, const Vlr& y) { return x.recordId == y.recordId && x.user() == y.user(); };
    match([&](const Vlr& x, const Vlr& y) {
        return kin(x, y) && x.extended == y.extended && contentOf(x) == contentOf(y) && x.userId == y.userId &&
               x.reserved == y.reserved && x.description == y.description;
    });
    match(kin);
    std::size_t last = 0;
    for (std::size_t i = 0; i < as.size(); ++i) {
        if (!as[i].matched) {
            d.records.push_back(only(*as[i].vlr, RecordDifference::Change::Removed));
            continue;
        }
        const Vlr& other = *bs[partner[i]].vlr;
        RecordDifference change = changeOf(*as[i].vlr, other);
        if (change.firstDataByte || change.frameDiffers || change.extendedA != change.extendedB)
            d.records.push_back(std::move(change));
        else if (partner[i] < last)
            d.recordsReordered = true;
        last = std::max(last, partner[i]);
    }
    for (const Listed& l : bs)
        if (!l.matched) d.records.push_back(only(*l.vlr, RecordDifference::Change::Added));
}

// -- container

std::string storage(const SourceFile& s)
{
    return s.compressed ? "LAZ" : "LAS";
}

/// The laszip record in words; all of its bytes when it is too short for them.
std::string compressionText(std::span<const std::byte> data)
{
    constexpr std::size_t kHead = 34, kItem = 6;
    if (data.size() < kHead) return "0x" + hex(data);
    const auto u16 = [&](std::size_t at) {
        return std::to_integer<unsigned>(data[at]) | std::to_integer<unsigned>(data[at + 1]) << 8;
    };
    std::uint32_t chunk = 0;
    std::memcpy(&chunk, data.data() + LazInfo::kChunkSizeAt, sizeof chunk);
    std::string text = "type " + std::to_string(u16(0)) + ", chunks of " +
                       (chunk == kVariableChunks || chunk == 0 ? "any size" : std::to_string(chunk)) + ", versions";
    for (std::size_t at = kHead; at + kItem <= data.size(); at += kItem) text += " " + std::to_string(u16(at + 4));
    return text;
}

std::uint64_t recordsAnnounced(const SourceFile& s)
{
    const auto laszip = std::uint64_t(std::count_if(s.vlrs.begin(), s.vlrs.end(), isLaszip));
    const auto announced = std::uint64_t(s.header.get(at::kVlrCount));
    return announced - std::min(announced, laszip);
}

/// Where a position lies, in terms that hold for the other container as well.
struct Meaning {
    bool set = false;
    std::optional<std::size_t> evlr;
    std::int64_t fromPointsEnd = 0;
    friend bool operator==(const Meaning&, const Meaning&) = default;
};

Meaning meaningOf(const SourceFile& s, at::Field<std::uint64_t> field)
{
    const std::uint64_t position = s.header.get(field);
    const bool waveform = field.offset == at::kWaveformStart.offset;
    Meaning m;
    if (s.header.standardEnd() < field.offset + sizeof position || position == 0) return m;
    // Where no record is announced, the position of the first one says nothing.
    if (!waveform && s.header.get(at::kEvlrCount) == 0) return m;
    m.set = true;
    if (waveform && s.waveformEvlr)
        m.evlr = s.waveformEvlr;
    else
        m.fromPointsEnd = std::int64_t(position - s.pointDataEnd);
    return m;
}

void comparePosition(const char* name, at::Field<std::uint64_t> field, const SourceFile& a, const SourceFile& b,
                     Difference& d)
{
    const auto x = a.header.get(field), y = b.header.get(field);
    if (!(meaningOf(a, field) == meaningOf(b, field)))
        d.header.push_back({name, kRecordNumbers, x, y});
    else if (x != y)
        d.container.push_back({name, "positions", x, y});
}

void compareContainers(const SourceFile& a, const SourceFile& b, Difference& d)
{
    d.storedA = storage(a);
    d.storedB = storage(b);
    if (d.storedA != d.storedB) d.container.push_back({"stored_as", "container", d.storedA, d.storedB});
    const auto number = [&](const char* name, std::uint64_t x, std::uint64_t y) {
        if (x != y) d.container.push_back({name, "container", x, y});
    };
    number("file_size", a.fileSize, b.fileSize);
    number("point_data_offset", a.header.pointOffset(), b.header.pointOffset());
    comparePosition("waveform_start", at::kWaveformStart, a, b, d);
    // Of 1.3 and before, these bytes are the user's.
    if (a.header.extendedCounts() && b.header.extendedCounts())
        comparePosition("evlr_start", at::kEvlrStart, a, b, d);
    if (const auto x = recordsAnnounced(a), y = recordsAnnounced(b); x != y)
        d.header.push_back({"vlr_count", kRecordNumbers, x, y});

    if (a.copc && b.copc && !sameNodes(*a.copc, *b.copc)) {
        const auto nodes = [](const SourceFile& s) {
            const auto filled = std::count_if(s.copc->nodes.begin(), s.copc->nodes.end(),
                                              [](const CopcNode& node) { return !node.points.empty(); });
            return grouped(std::uint64_t(filled)) + " nodes, " + grouped(s.pointCount) + " points";
        };
        d.container.push_back({"octree", "container", nodes(a), nodes(b)});
    }
    const Vlr *x = a.findVlr(kLaszipUser, kLaszipRecordId), *y = b.findVlr(kLaszipUser, kLaszipRecordId);
    const auto told = [](const Vlr* vlr) -> ToldValue {
        if (vlr == nullptr) return std::monostate{};
        return compressionText(vlr->data);
    };
    if (x != nullptr && y != nullptr ? x->data != y->data : a.compressed && b.compressed)
        d.container.push_back({"compression", "container", told(x), told(y)});
}

}  // namespace

void compareSources(const SourceFile& a, const SourceFile& b, Difference& d)
{
    compareFields(a.header, b.header, d);
    compareContainers(a, b, d);
    compareRecords(a, b, d);
    const auto user = [](const Header& h) { return std::span(h.bytes).subspan(h.standardEnd()); };
    compareBytes("user bytes of the header", user(a.header), user(b.header), d);
    compareBytes("bytes before the points", a.gapBeforePoints, b.gapBeforePoints, d);
    compareBytes("bytes after the points", a.gapAfterPoints, b.gapAfterPoints, d);
    compareBytes("bytes at the end of the file", a.tail, b.tail, d);
}

}  // namespace punctum::las
