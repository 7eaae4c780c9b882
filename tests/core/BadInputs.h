// SPDX-License-Identifier: MIT
#pragma once

#include "core/Text.h"
#include "core/las/ChunkTable.h"
#include "tests/core/LasFiles.h"

#include <cmath>
#include <limits>

/// Files that are damaged or lie, and what is to come of each: the bad-input table of docs/dev/testing.md. Each row
/// begins with its number there. LasBadInputTest holds the reader to it; the fuzz targets begin with these files.
namespace lasfiles
{

struct BadInput {
    std::string name;
    Bytes bytes;
    bool opens = true;
    std::size_t points = 0;   ///< that can be read, damaged ones included
    std::size_t missing = 0;  ///< of these: damaged
    bool recovered = false;
    std::string said;  ///< part of the error's sentence, or of a warning's; empty: no warning at all
};

namespace bad
{

template <typename T>
Bytes with(Bytes b, std::size_t at, T value)
{
    set<T>(b, at, value);
    return b;
}
inline std::size_t pointOffset(const Bytes& b)
{
    return get<std::uint32_t>(b, 96);
}
/// Where the payload of the laszip record begins: it is the first VLR of the files made here.
inline std::size_t laszipAt(const Bytes& b)
{
    return get<std::uint16_t>(b, 94) + 54u;
}
template <typename T>
Bytes withLaszip(Bytes b, std::size_t at, T value)
{
    set<T>(b, laszipAt(b) + at, value);
    return b;
}
inline std::size_t tableAt(const Bytes& b)
{
    return std::size_t(get<std::int64_t>(b, pointOffset(b)));
}

/// A sound LAS 1.2 file of format 3.
inline Bytes plain(std::size_t count)
{
    return file(header(2, 3, 34, count), {}, randomRecords(3, 34, count, 1));
}
/// A sound LAS 1.4 file of format 6, with what is given.
inline Bytes plain14(std::size_t count, const std::vector<Bytes>& vlrs = {})
{
    return file(with<std::uint16_t>(header(4, 6, 30, count), 6, 16), vlrs, randomRecords(6, 30, count, 1));
}
/// A sound LAZ file with about five chunks of lifelike points.
inline Bytes laz(std::size_t count, std::uint8_t format, std::uint32_t chunk, std::uint16_t extra = 0)
{
    const auto length = std::uint16_t(recordLength(format) + extra);
    Bytes b = lazFile(format, length, randomRecords(format, length, count, 1, true), chunk);
    if (format >= 6) set<std::uint16_t>(b, 6, 16);
    return b;
}
/// 10 records of format 0 with 8 extra bytes, and `data` as the record that describes them.
inline Bytes withExtra(const Bytes& data)
{
    return file(header(2, 0, 28, 10), {record("LASF_Spec", 4, data)}, Bytes(280));
}
inline Bytes descriptor(int type, int options, const std::string& name = "x")
{
    Bytes d(192);
    d[2] = std::byte(type);
    d[3] = std::byte(options);
    std::memcpy(d.data() + 4, name.data(), std::min<std::size_t>(name.size(), 32));
    return d;
}
/// The file with another chunk table, and whatever follows it gone.
inline Bytes withTable(Bytes b, const Bytes& table)
{
    b.resize(tableAt(b));
    append(b, table);
    return b;
}
inline std::vector<punctum::las::ChunkEntry> tableOf(const Bytes& b)
{
    const auto entries = punctum::las::decodeChunkTable(std::span(b).subspan(tableAt(b)), false, b.size());
    if (!entries) throw std::runtime_error("the table cannot be read");
    return *entries;
}
/// The first bytes of chunk k, and of the one behind it.
inline std::pair<std::size_t, std::size_t> chunkAt(const Bytes& b, std::size_t k)
{
    const auto entries = tableOf(b);
    std::size_t at = pointOffset(b) + 8;
    for (std::size_t i = 0; i < k; ++i) at += entries[i].bytes;
    return {at, at + entries[k].bytes};
}

}  // namespace bad

/// All rows that are one file each. `count`: points in most of them, at least 30.
inline std::vector<BadInput> badInputs(std::size_t count)
{
    using namespace bad;
    std::vector<BadInput> rows;
    const auto refuse = [&](const std::string& name, Bytes b, const std::string& said) {
        rows.push_back({name, std::move(b), false, 0, 0, false, said});
    };
    const auto open = [&](const std::string& name, Bytes b, std::size_t points, bool recovered,
                          const std::string& said, std::size_t missing = 0) {
        rows.push_back({name, std::move(b), true, points, missing, recovered, said});
    };
    const double inf = std::numeric_limits<double>::infinity(), nan = std::nan("");
    const std::string n = punctum::grouped(count);
    const Bytes las = plain(count), las14 = plain14(count);
    const auto chunk = std::uint32_t(count / 5);  // so there are five or six of them
    const Bytes laz3 = laz(count, 3, chunk), laz7 = laz(count, 7, chunk), laz6 = laz(count, 6, chunk);
    const Bytes one3 = laz(count, 3, 50000), one6 = laz(count, 6, 50000), one7 = laz(count, 7, 50000);
    const auto cut = [](Bytes b, std::size_t size) {
        b.resize(size);
        return b;
    };

    open("0 sound", las, count, false, "");
    open("0 sound 1.4", las14, count, false, "");
    open("0 sound LAZ", laz3, count, false, "");
    open("0 sound layered LAZ", laz7, count, false, "");

    refuse("1 empty", {}, "The file is empty.");
    refuse("2 100 bytes", cut(las, 100), "it has 100 bytes");
    refuse("3 226 bytes", cut(las, 226), "it has 226 bytes");
    refuse("4 LASX", with<char>(las, 3, 'X'), "signature is not LASF");
    refuse("4 a zip", with<std::uint32_t>(las, 0, 0x04034b50),
           "not a LAS file but a ZIP archive; unpack it first.");
    refuse("5 header size 0", with<std::uint16_t>(las, 94, 0), "header size 0 is less than 227");
    refuse("6 header size 226", with<std::uint16_t>(las, 94, 226), "header size 226 is less than 227");
    refuse("7 header size 65535", with<std::uint16_t>(las, 94, 65535),
           las.size() < 65535 ? "header size 65535 is beyond" : "outside the file");
    for (const std::uint32_t offset : {0u, 200u, 0x7FFFFFFFu, 0xFFFFFFFFu})
        refuse("8-10 point offset " + std::to_string(offset), with(las, 96, offset),
               "starts at " + std::to_string(offset) + ", outside the file");
    open("11 VLR count", with<std::uint32_t>(las, 100, 0xFFFFFFFFu), count, false,
         "4,294,967,295 variable length records");
    open("12 VLR length",
         with<std::uint16_t>(
             file(header(2, 3, 34, count), {record("a", 1, Bytes(20))}, randomRecords(3, 34, count, 1)), 227 + 20,
             60000),
         count, false, "1 variable length record is announced, 0");
    for (const std::uint8_t format : {11, 63, 127, 0xC3})
        refuse("13 format " + std::to_string(format), with(las, 104, format), "is not supported");
    refuse("14 record length 0", with<std::uint16_t>(las, 105, 0), "0 bytes long, but point format 3 needs 34");
    refuse("15 record length 20", with<std::uint16_t>(las, 105, 20), "20 bytes long");
    open("16 record length 65535", with<std::uint16_t>(las, 105, 65535), 0, true, "the file holds 0");
    open("16 record length doubled", with<std::uint16_t>(las, 105, 68), count / 2, true,
         "the file holds " + punctum::grouped(count / 2));
    open("17 count 2^32-1", with<std::uint32_t>(las, 107, 0xFFFFFFFFu), count, true,
         "4,294,967,295 points, the file holds " + n);
    open("18 count 2^63", with<std::uint64_t>(las14, 247, 1ull << 63), count, true, "the file holds " + n);
    open("19 two counts", with<std::uint32_t>(las14, 107, 5), count, false, "counts differ");
    Bytes twoCounts = with<std::uint32_t>(las14, 107, 5);
    append(twoCounts, Bytes(4096));
    open("19 two counts and a tail", twoCounts, count, false, "counts differ (" + n + " and 5); the first is used");
    refuse("20 version 2.0", with<std::uint16_t>(las, 24, 0x0002), "version 2.0 is not supported");
    refuse("20 version 1.9", with<std::uint8_t>(las, 25, 9), "version 1.9 is not supported");
    open("20 version 1.5", with<std::uint8_t>(las14, 25, 5), count, false, "LAS 1.5");
    open("21 1.4 with a short header", with<std::uint8_t>(las, 25, 4), count, false, "should have 375");
    open("22 cut in a record", cut(las, las.size() - 50), count - 2, true,
         "the file holds " + punctum::grouped(count - 2));
    open("22 header only", cut(las, 227), 0, true, "the file holds 0");
    for (const double scale : {0.0, nan, inf})
        open("23-24 scale " + std::to_string(scale), with(las, 131, scale), count, false, "scale or offset of X");
    open("25 negative scale", with(las, 139, -0.01), count, false, "scale of Y is negative");
    open("26 offset 1e308", with(las, 155, 1e308), count, false, "scale or offset of X");
    open("27 box NaN", with(las, 179, nan), count, false, "");
    open("27 box upside down", with(las, 187, 1e9), count, false, "");
    open("27 box far", with(las, 179, 1e300), count, false, "");

    const auto evlr = [&](std::uint64_t start, std::uint32_t records) {
        return with(with(las14, 235, start), 243, records);
    };
    open("28 EVLR at 2^40", evlr(1ull << 40, 1), count, true, "1 extended records");
    open("28 EVLR at 2^64-1", evlr(~0ull, 1), count, true, "1 extended records");
    open("28 EVLR before the points", evlr(100, 1), count, true, "1 extended records");
    open("29 EVLR among the points", evlr(375 + 300, 1), count, true, "begin inside the point data");
    {
        Bytes b = las14;
        const std::size_t end = b.size();
        append(b, record("a", 1, Bytes(10), true));
        append(b, record("b", 2, Bytes(10), true));
        set<std::uint64_t>(b, 235, end);
        open("28 EVLR count 2^32-1", with<std::uint32_t>(b, 243, 0xFFFFFFFFu), count, true, "2 are found");
        set<std::uint32_t>(b, 243, 2);
        open("0 two EVLRs", b, count, false, "");
        for (const std::uint64_t lost : {std::uint64_t(0), std::uint64_t(100), std::uint64_t(end + 1), UINT64_MAX})
            open("28 lost EVLRs, said to be at " + std::to_string(lost), with(b, 235, lost), count, false,
                 "but at " + std::to_string(end) + "; they are read there");
        open("28 EVLR length 2^64-1", with<std::uint64_t>(b, end + 70 + 20, ~0ull), count, true, "1 is found");
        open("28 EVLR length wraps", with<std::uint64_t>(b, end + 20, ~0ull - end - 59), count, true,
             "0 are found");
    }

    refuse("30 no laszip record", with<std::uint8_t>(las, 104, 0x83), "compression record is missing");
    refuse("31 no items", withLaszip<std::uint16_t>(laz3, 32, 0), "does not fit");
    refuse("31 65535 items", withLaszip<std::uint16_t>(laz3, 32, 65535), "too short");
    refuse("32 laszip record cut", with<std::uint16_t>(laz3, laszipAt(laz3) - 54 + 20, 30), "too short (30 bytes)");
    refuse("33 two byte items", withLaszip<std::uint16_t>(withLaszip<std::uint16_t>(laz3, 40, 0), 42, 4),
           "does not fit");
    refuse("34 wrong order", withLaszip<std::uint16_t>(withLaszip<std::uint16_t>(laz3, 40, 8), 46, 7),
           "does not fit");
    refuse("34 wrong size", withLaszip<std::uint16_t>(laz3, 36, 24), "does not fit");
    refuse("34 item version 0", withLaszip<std::uint16_t>(laz3, 38, 0), "unsupported version (0)");
    refuse("34 item version 9", withLaszip<std::uint16_t>(laz7, 38, 9), "unsupported version (9)");
    refuse("35 compressor 9", withLaszip<std::uint16_t>(laz3, 0, 9), "unsupported way (compressor 9");
    refuse("35 compressor 0", withLaszip<std::uint16_t>(laz3, 0, 0), "unsupported way (compressor 0");
    refuse("35 coder 15", withLaszip<std::uint16_t>(laz3, 2, 15), "coder 15");
    refuse("36 layered format 3", withLaszip<std::uint16_t>(laz3, 0, 3), "unsupported compressor 3");
    refuse("36 chunked format 6", withLaszip<std::uint16_t>(laz6, 0, 2), "unsupported compressor 2");

    open("37 chunk size 1", withLaszip<std::uint32_t>(laz3, 12, 1), count, false, "chunk size 1 is wrong");
    open("37 chunk size 1, layered", withLaszip<std::uint32_t>(laz7, 12, 1), count, false, "rebuilt");
    open("37 chunk size 0, one chunk", withLaszip<std::uint32_t>(one7, 12, 0), count, false, "rebuilt");
    open("37 chunk size 2^32-2", withLaszip<std::uint32_t>(laz3, 12, 0xFFFFFFFEu), count, false, "is wrong");
    open("37 chunk size 2^32-2, layered", withLaszip<std::uint32_t>(laz7, 12, 0xFFFFFFFEu), count, false,
         "rebuilt");
    for (const Bytes& b : {laz3, laz7}) {
        const std::string kind = &b == &laz3 || get<std::uint8_t>(b, 104) == 0x83 ? "chunked" : "layered";
        const auto own = std::int64_t(pointOffset(b));
        for (const std::int64_t to :
             {std::int64_t(-5), std::int64_t(-1), std::int64_t(0), own, own + 9, std::int64_t(1) << 40, INT64_MAX})
            open("38 table pointer " + std::to_string(to) + ", " + kind, with(b, std::size_t(own), to), count,
                 false, "rebuilt");
        open("39 table of 2^32-1 chunks, " + kind, with<std::uint32_t>(b, tableAt(b) + 4, 0xFFFFFFFFu), count,
             false, "rebuilt");
        open("42 table version 7, " + kind, with<std::uint32_t>(b, tableAt(b), 7), count, false, "rebuilt");
        open("42 table cut, " + kind, cut(b, tableAt(b) + 9), count, false, "rebuilt");
        auto entries = tableOf(b);
        entries[1].bytes = 0;
        open("42 chunk of 0 bytes, " + kind, withTable(b, punctum::las::encodeChunkTable(entries, false)), count,
             false, "rebuilt");
        entries[1].bytes = 0x7FFFFFFF;
        open("42 chunk beyond the table, " + kind, withTable(b, punctum::las::encodeChunkTable(entries, false)),
             count, false, "rebuilt");
    }
    {
        const auto variable = [&](const Bytes& b, bool right) {
            auto entries = tableOf(b);
            for (auto& e : entries) e.count = chunk;
            entries.back().count = std::uint32_t(count - chunk * (entries.size() - 1)) + (right ? 0 : 1);
            return withTable(withLaszip<std::uint32_t>(b, 12, 0xFFFFFFFFu),
                             punctum::las::encodeChunkTable(entries, true));
        };
        open("0 variable chunks", variable(laz3, true), count, false, "");
        open("0 variable chunks, layered", variable(laz7, true), count, false, "");
        // A point too many: the decoder finds out, and what it gave is not believed.
        open("42 counts do not add up", variable(laz3, false), count + 1, false, "points, the file holds",
             count - chunk * (count / chunk) + (count % chunk == 0 ? chunk : 0) + 1);
        open("42 counts do not add up, layered", variable(laz7, false), count, false, "rebuilt");
        const Bytes none(8);
        refuse("40 variable chunks, a table of none", withTable(variable(laz3, true), none), "cannot be rebuilt");
        open("40 variable chunks, a table of none, layered", withTable(variable(laz7, true), none), count, false,
             "rebuilt");
        refuse("41 variable chunks, no table", with<std::int64_t>(variable(laz3, true), pointOffset(laz3), 0),
               "cannot be rebuilt");
        open("41 variable chunks, no table, layered",
             with<std::int64_t>(variable(laz7, true), pointOffset(laz7), 0), count, false, "rebuilt");
    }

    // Heads of layered chunks that LASzip would believe: the first chunk is refused before it sees it.
    for (const Bytes& b : {laz6, laz7}) {
        const std::uint8_t format = get<std::uint8_t>(b, 104) & 0x3F;
        const std::size_t head = pointOffset(b) + 8 + recordLength(format);
        const std::string f = ", format " + std::to_string(format);
        open("43 layers that wrap to their sum" + f,
             with<std::uint32_t>(with<std::uint32_t>(b, head + 4, 0x80000010u), head + 8, 0x80000010u), count,
             false, "its layer sizes cannot be", chunk);
        open("43 layers of 2^32-1 and 2" + f,
             with<std::uint32_t>(with<std::uint32_t>(b, head + 4, 0xFFFFFFFFu), head + 8, 2), count, false,
             "its layer sizes cannot be", chunk);
        Bytes zero = b;
        for (std::size_t k = 0; k < (format == 6 ? 9u : 10u); ++k) set<std::uint32_t>(zero, head + 4 + 4 * k, 0);
        open("44 layers of no bytes" + f, zero, count, false, "do not fill its bytes", chunk);
        for (const std::uint32_t own : {0u, 0xFFFFFFFFu, chunk - 1})
            open("44 chunk of " + std::to_string(own) + " points" + f, with(b, head, own), count, false,
                 own == 0 ? "cannot be" : "points where the table says", chunk);
    }
    refuse("44 the first chunk unsound, no table",
           with<std::uint32_t>(with<std::int64_t>(laz6, pointOffset(laz6), 0), pointOffset(laz6) + 8 + 30,
                               0xFFFFFFFFu),
           "not one can be read");
    refuse("45 ends before the chunks", cut(laz3, pointOffset(laz3) + 4), "ends before its points");
    {
        // How many points a cut leaves depends on the chunk's bytes; layered chunks are whole or gone.
        const std::size_t k = 2;
        open("45 cut behind two chunks, layered", cut(laz7, chunkAt(laz7, k).first + 20), k * chunk, true,
             "the file holds " + std::to_string(k * chunk));
    }
    open("46 count too large, chunked", with<std::uint32_t>(one3, 107, 5000), count, true,
         "5,000 points, the file holds " + n);
    open("46 count too large, layered", with<std::uint64_t>(one6, 247, 5000), count, true,
         "5,000 points, the file holds " + n);
    open("46 count too small, chunked", with<std::uint32_t>(one3, 107, 20), count, false,
         "20 points, the file holds " + n);
    open("46 count too small, layered", with<std::uint64_t>(one6, 247, 20), count, false,
         "20 points, the file holds " + n);
    open("46 count far too large", with<std::uint32_t>(laz3, 107, 0xFFFFFFFFu), count, true, "the file holds " + n);

    for (const Bytes& b : {laz3, laz7}) {
        const std::string kind = get<std::uint8_t>(b, 104) == 0x83 ? "chunked" : "layered";
        Bytes flipped = b;
        flipped[chunkAt(b, 1).second - 30] ^= std::byte(8);
        if (kind == "chunked") open("47 a bit flipped, chunked", flipped, count, false, "damaged", chunk);
        // What a damaged flash memory holds; LASzip calls itself on it until the stack is full.
        for (const std::size_t run : {20u, 100u}) {
            Bytes erased = b;
            const std::size_t end = chunkAt(b, 1).second;
            std::fill(erased.begin() + std::ptrdiff_t(end - run), erased.begin() + std::ptrdiff_t(end),
                      std::byte(0xFF));
            if (kind == "chunked" || run > 20)
                open("47 " + std::to_string(run) + " bytes of 0xFF, " + kind, erased, count, false, "damaged",
                     chunk);
        }
        Bytes zeroed = b;
        const auto [first, last] = chunkAt(b, 1);
        std::fill(zeroed.begin() + std::ptrdiff_t(first), zeroed.begin() + std::ptrdiff_t(last), std::byte(0));
        open("48 chunk of zeros, " + kind, zeroed, count, false, "damaged", chunk);
        Bytes swapped(b.begin(), b.begin() + std::ptrdiff_t(first));
        const auto [second, end] = chunkAt(b, 2);
        swapped.insert(swapped.end(), b.begin() + std::ptrdiff_t(second), b.begin() + std::ptrdiff_t(end));
        swapped.insert(swapped.end(), b.begin() + std::ptrdiff_t(first), b.begin() + std::ptrdiff_t(second));
        swapped.insert(swapped.end(), b.begin() + std::ptrdiff_t(end), b.end());
        open("48 chunks swapped, " + kind, swapped, count, false, "damaged", 2 * chunk);
    }

    {
        // What LAS 1.4 adds, in extra bytes that are not there.
        Bytes compatible(156), extra = descriptor(3, 0, "LAS 1.4 scan angle");
        for (const char* name : {"LAS 1.4 extended returns", "LAS 1.4 classification", "LAS 1.4 flags and channel"})
            append(extra, descriptor(1, 0, name));
        const auto made = [&](const Bytes& payload) {
            return file(header(2, 3, 34, count),
                        {record("lascompatible", 22204, payload), record("LASF_Spec", 4, extra)},
                        randomRecords(3, 34, count, 1));
        };
        open("49 compatibility record, no extra bytes", made(compatible), count, false, "beyond the end");
        open("49 compatibility record cut", made(Bytes(20)), count, false, "beyond the end");
    }

    open("50 no descriptors", withExtra({}), 10, false, "");
    open("50 100 bytes", withExtra(Bytes(100)), 10, false, "not a whole number");
    open("50 type 0 of no bytes", withExtra(descriptor(0, 0)), 10, false, "covers no bytes");
    open("50 type 200", withExtra(descriptor(200, 0)), 10, false, "reserved type 200");
    open("50 too long", withExtra(descriptor(0, 200)), 10, false, "beyond the end");
    {
        Bytes many;
        for (int k = 0; k < 340; ++k) append(many, descriptor(1, 0));
        open("50 340 descriptors", withExtra(many), 10, false, "beyond the end");
        open("50 name without NUL", withExtra(descriptor(10, 0, std::string(32, '\xFF'))), 10, false, "");
        open("50 NaN scale", withExtra(with(descriptor(10, 8), 112, nan)), 10, false, "cannot be used");
    }
    {
        // Points of format 4 that refer to a descriptor that says 2^31 samples, to none, to bytes that are not
        // there.
        Bytes samples(26);
        set<std::uint32_t>(samples, 2, 0x80000000u);
        Bytes points(10 * 57);
        for (std::size_t i = 0; i < 10; ++i) {
            set<std::uint8_t>(points, i * 57 + 28, std::uint8_t(i % 2 == 0 ? 1 : 200));
            set<std::uint64_t>(points, i * 57 + 29, ~0ull - i);
            set<std::uint32_t>(points, i * 57 + 37, 0xFFFFFFFFu);
        }
        Bytes head = with<std::uint16_t>(header(3, 4, 57, 10), 6, 2);
        set<std::uint64_t>(head, 227, head.size() + 54 + 26 + points.size());
        open("51 waveforms that cannot be",
             file(head, {record("LASF_Spec", 100, samples)}, points, record("LASF_Spec", 65535, Bytes(7), true)),
             10, false, "");
        set<std::uint64_t>(head, 227, 1ull << 50);
        open("51 waveform record beyond the file", file(head, {}, points), 10, true, "1 extended records");
    }
    {
        // The hierarchy's only page is its own child, and an entry lies behind the file.
        Bytes info(160), page(64);
        set<std::uint64_t>(info, 40, 1ull << 60);
        set<std::int32_t>(page, 28, -1);
        set<std::int32_t>(page, 56, -4096);
        Bytes b = laz7;
        const Bytes vlr = record("copc", 1, info);
        const std::size_t begin = get<std::uint16_t>(b, 94);
        const std::size_t records = get<std::uint32_t>(b, 96);
        set<std::uint32_t>(b, 96, std::uint32_t(records + vlr.size()));
        set<std::uint32_t>(b, 100, 2);
        set<std::int64_t>(b, records, std::int64_t(tableAt(laz7) + vlr.size()));
        b.insert(b.begin() + std::ptrdiff_t(begin), vlr.begin(), vlr.end());
        set<std::uint64_t>(b, 235, b.size());
        set<std::uint32_t>(b, 243, 1);
        set<std::uint64_t>(page, 16, b.size() + 60);
        append(b, record("copc", 1000, page, true));
        open("52 COPC hierarchy in a circle", b, count, false,
             "The spatial index of the COPC file does not belong");
    }
    {
        const Bytes garbage = randomRecords(0, 60000, 1, 5);
        Bytes nul(40, std::byte('x')), keys(8);
        nul[10] = std::byte(0);
        open("53 WKT of garbage", plain14(count, {record("LASF_Projection", 2112, garbage)}), count, false,
             "cannot be understood");
        open("53 WKT with a NUL", plain14(count, {record("LASF_Projection", 2112, nul)}), count, false,
             "cannot be understood");
        set<std::uint16_t>(keys, 0, 2);
        set<std::uint16_t>(keys, 6, 65535);
        open("53 GeoTIFF keys without end",
             file(header(2, 0, 20, 10), {record("LASF_Projection", 34735, keys)}, Bytes(200)), 10, false,
             "cannot be understood");
    }
    {
        Bytes b = las;
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t a = 0; a < 3; ++a)
                set<std::int32_t>(b, 227 + i * 34 + 4 * a, a == 0 ? INT32_MIN : INT32_MAX);
        open("54 all equal", b, count, false, "");
        open("54 extremes", with<std::int32_t>(b, 227, INT32_MAX), count, false, "");
        open("54 one point", file(header(2, 0, 20, 1), {}, Bytes(20)), 1, false, "");
        open("54 no point", file(header(2, 0, 20, 0), {}, {}), 0, false, "");
    }
    return rows;
}

}  // namespace lasfiles
