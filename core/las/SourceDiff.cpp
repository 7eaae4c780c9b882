// SPDX-License-Identifier: MIT
#include "core/las/SourceDiff.h"

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

/// A field of the public header (LAS 1.4 R15, table 3; 1.5 R00).
struct HeaderField {
    enum class Type { U8, U16, U32, U64, F64, Text, Guid };
    const char* name;
    const char* group;
    Type type;
    std::size_t offset;
    std::size_t bytes;
    std::uint8_t since = 0;  ///< minor version
    std::size_t count = 1;   ///< of an array; numbered from 1
    std::uint8_t mask = 0xFF;
};

using T = HeaderField::Type;
constexpr HeaderField kFields[] = {
    {"file_source_id", "file source id", T::U16, at::kFileSourceId, 2},
    {"global_encoding", "encoding", T::U16, at::kGlobalEncoding, 2},
    {"project_id", "project id", T::Guid, 8, 16},
    {"version_major", "version", T::U8, 24, 1},
    {"version_minor", "version", T::U8, at::kVersionMinor, 1},
    {"system_identifier", "system identifier", T::Text, at::kSystemId, 32},
    {"generating_software", "software", T::Text, at::kSoftware, 32},
    {"creation_day", "creation date", T::U16, at::kCreationDay, 2},
    {"creation_year", "creation date", T::U16, at::kCreationYear, 2},
    {"header_size", "header size", T::U16, at::kHeaderSize, 2},
    {"point_format", "point format", T::U8, at::kPointFormat, 1, 0, 1, 0x3F},
    {"record_length", "record length", T::U16, at::kRecordLength, 2},
    {"legacy_point_count", "point counts", T::U32, at::kLegacyCount, 4},
    {"legacy_points_by_return", "points by return", T::U32, at::kLegacyByReturn, 4, 0, 5},
    {"scale_x", "scale", T::F64, at::kScale, 8},
    {"scale_y", "scale", T::F64, at::kScale + 8, 8},
    {"scale_z", "scale", T::F64, at::kScale + 16, 8},
    {"offset_x", "offset", T::F64, at::kOffset, 8},
    {"offset_y", "offset", T::F64, at::kOffset + 8, 8},
    {"offset_z", "offset", T::F64, at::kOffset + 16, 8},
    {"max_x", "bounds", T::F64, at::kBounds, 8},
    {"min_x", "bounds", T::F64, at::kBounds + 8, 8},
    {"max_y", "bounds", T::F64, at::kBounds + 16, 8},
    {"min_y", "bounds", T::F64, at::kBounds + 24, 8},
    {"max_z", "bounds", T::F64, at::kBounds + 32, 8},
    {"min_z", "bounds", T::F64, at::kBounds + 40, 8},
    {"evlr_count", kRecordNumbers, T::U32, at::kEvlrCount, 4, 4},
    {"point_count", "point counts", T::U64, at::kPointCount, 8, 4},
    {"points_by_return", "points by return", T::U64, at::kByReturn, 8, 4, 15},
    {"max_gps_time", "GPS time range", T::F64, 375, 8, 5},
    {"min_gps_time", "GPS time range", T::F64, 383, 8, 5},
    {"time_offset", "time offset", T::U16, at::kTimeOffset, 2, 5},
};

/// First byte after the standard part of the header.
std::size_t standardEnd(const Header& h)
{
    return std::min<std::size_t>(standardHeaderSize(h.versionMinor()), h.bytes.size());
}

std::span<const std::byte> bytesOf(const Header& h, const HeaderField& f, std::size_t k)
{
    const std::size_t at = f.offset + k * f.bytes;
    if (h.versionMinor() < f.since || at + f.bytes > standardEnd(h)) return {};
    return std::span(h.bytes).subspan(at, f.bytes);
}

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
    for (const HeaderField& f : kFields)
        for (std::size_t k = 0; k < f.count; ++k) {
            const auto x = bytesOf(a, f, k), y = bytesOf(b, f, k);
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

void compareBytes(const std::string& what, std::span<const std::byte> a, std::span<const std::byte> b,
                  Difference& d)
{
    const auto at = std::mismatch(a.begin(), a.end(), b.begin(), b.end()).first;
    if (at == a.end() && a.size() == b.size()) return;
    d.bytes.push_back({what, a.size(), b.size(), std::uint64_t(at - a.begin())});
}

bool isLaszip(const Vlr& vlr)
{
    return vlr.is(kLaszipUser, kLaszipRecordId);
}

// -- records

struct Listed {
    const Vlr* vlr;
    bool matched = false;
};

std::vector<Listed> listed(const SourceFile& s)
{
    std::vector<Listed> list;
    for (const auto* records : {&s.vlrs, &s.evlrs})
        for (const Vlr& vlr : *records)
            if (!isLaszip(vlr)) list.push_back({&vlr});
    return list;
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
    const auto at = std::mismatch(a.data.begin(), a.data.end(), b.data.begin(), b.data.end()).first;
    if (at != a.data.end() || a.data.size() != b.data.size()) r.firstDataByte = std::uint64_t(at - a.data.begin());
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
    std::vector<Listed> as = listed(a), bs = listed(b);
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
        return kin(x, y) && x.extended == y.extended && x.data == y.data && x.userId == y.userId &&
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
    constexpr std::size_t kHead = 34, kItem = 6, kChunkSizeAt = 12;
    if (data.size() < kHead) return "0x" + hex(data);
    const auto u16 = [&](std::size_t at) {
        return std::to_integer<unsigned>(data[at]) | std::to_integer<unsigned>(data[at + 1]) << 8;
    };
    std::uint32_t chunk = 0;
    std::memcpy(&chunk, data.data() + kChunkSizeAt, sizeof chunk);
    std::string text = "type " + std::to_string(u16(0)) + ", chunks of " +
                       (chunk == kVariableChunks || chunk == 0 ? "any size" : std::to_string(chunk)) + ", versions";
    for (std::size_t at = kHead; at + kItem <= data.size(); at += kItem) text += " " + std::to_string(u16(at + 4));
    return text;
}

std::uint64_t recordsAnnounced(const SourceFile& s)
{
    const auto laszip = std::uint64_t(std::count_if(s.vlrs.begin(), s.vlrs.end(), isLaszip));
    const auto announced = std::uint64_t(s.header.get<std::uint32_t>(at::kVlrCount));
    return announced - std::min(announced, laszip);
}

/// Where a position lies, in terms that hold for the other container as well.
struct Meaning {
    bool set = false;
    std::optional<std::size_t> evlr;
    std::int64_t fromPointsEnd = 0;
    friend bool operator==(const Meaning&, const Meaning&) = default;
};

Meaning meaningOf(const SourceFile& s, std::size_t field)
{
    const auto position = s.header.get<std::uint64_t>(field);
    Meaning m;
    if (standardEnd(s.header) < field + 8 || position == 0) return m;
    m.set = true;
    if (field == at::kWaveformStart && s.waveformEvlr)
        m.evlr = s.waveformEvlr;
    else
        m.fromPointsEnd = std::int64_t(position - s.pointDataEnd);
    return m;
}

void comparePosition(const char* name, std::size_t field, const SourceFile& a, const SourceFile& b, Difference& d)
{
    const auto x = a.header.get<std::uint64_t>(field), y = b.header.get<std::uint64_t>(field);
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
    const auto user = [](const Header& h) { return std::span(h.bytes).subspan(standardEnd(h)); };
    compareBytes("user bytes of the header", user(a.header), user(b.header), d);
    compareBytes("bytes before the points", a.gapBeforePoints, b.gapBeforePoints, d);
    compareBytes("bytes after the points", a.gapAfterPoints, b.gapAfterPoints, d);
    compareBytes("bytes at the end of the file", a.tail, b.tail, d);
}

}  // namespace punctum::las
