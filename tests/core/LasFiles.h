// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/PointFormat.h"
#include "core/las/SourceFile.h"

#include <laszip/laszip_api.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

/// LAS and LAZ files for tests, made byte by byte or by LASzip's own API, which is also the independent reader.
/// Nothing here uses the reader or the writer under test.
namespace lasfiles
{

using Bytes = std::vector<std::byte>;

inline Bytes readFile(const std::filesystem::path& path)
{
    std::ifstream in(path, std::ios::binary);
    if (!in) throw std::runtime_error("cannot read " + path.string());
    std::ostringstream all;
    all << in.rdbuf();
    const std::string s = all.str();
    Bytes bytes(s.size());
    if (!s.empty()) std::memcpy(bytes.data(), s.data(), s.size());
    return bytes;
}

inline void writeFile(const std::filesystem::path& path, const Bytes& bytes)
{
    std::ofstream out(path, std::ios::binary);
    out.write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
    if (!out.flush()) throw std::runtime_error("cannot write " + path.string());
}

template <typename T>
T get(const Bytes& bytes, std::size_t at)
{
    T v{};
    std::memcpy(&v, bytes.data() + at, sizeof v);
    return v;
}

template <typename T>
void set(Bytes& bytes, std::size_t at, T value)
{
    std::memcpy(bytes.data() + at, &value, sizeof value);
}

inline void append(Bytes& to, const Bytes& from)
{
    to.insert(to.end(), from.begin(), from.end());
}

inline std::uint16_t recordLength(std::uint8_t format)
{
    constexpr std::uint16_t kLengths[] = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
    return kLengths[format];
}

inline bool hasTime(std::uint8_t format)
{
    return format == 1 || format >= 3;
}

/// Bytes of a VLR or EVLR.
inline Bytes record(const std::string& user, std::uint16_t id, const Bytes& data, bool extended = false)
{
    Bytes b(extended ? 60 : 54);
    std::memcpy(b.data() + 2, user.data(), std::min<std::size_t>(user.size(), 16));
    set(b, 18, id);
    if (extended)
        set<std::uint64_t>(b, 20, data.size());
    else
        set<std::uint16_t>(b, 20, std::uint16_t(data.size()));
    append(b, data);
    return b;
}

/// A text with its end, as records of text have it.
inline Bytes textBytes(const std::string& text)
{
    Bytes bytes(text.size() + 1);
    std::memcpy(bytes.data(), text.data(), text.size());
    return bytes;
}

/// The record of a coordinate system in WKT.
inline Bytes wktRecord(const std::string& wkt, bool extended = false)
{
    return record("LASF_Projection", 2112, textBytes(wkt), extended);
}

/// A header of LAS 1.minor, zero but for what must be there.
inline Bytes header(std::uint8_t minor, std::uint8_t format, std::uint16_t length, std::uint64_t points)
{
    Bytes b(minor <= 2 ? 227 : minor == 3 ? 235 : minor == 4 ? 375 : 393);
    std::memcpy(b.data(), "LASF", 4);
    set<std::uint8_t>(b, 24, 1);
    set<std::uint8_t>(b, 25, minor);
    std::memcpy(b.data() + 58, "test", 4);
    set<std::uint16_t>(b, 90, 100);
    set<std::uint16_t>(b, 92, 2020);
    set<std::uint16_t>(b, 94, std::uint16_t(b.size()));
    set<std::uint32_t>(b, 96, std::uint32_t(b.size()));
    set<std::uint8_t>(b, 104, format);
    set<std::uint16_t>(b, 105, length);
    if (format < 6) set<std::uint32_t>(b, 107, std::uint32_t(points));
    for (std::size_t k = 0; k < 3; ++k) set<double>(b, 131 + 8 * k, 0.01);
    if (minor >= 4) set<std::uint64_t>(b, 247, points);
    return b;
}

/// Header, VLRs and records put together; point offset and VLR count are filled in.
inline Bytes file(Bytes head, const std::vector<Bytes>& vlrs, const Bytes& records, const Bytes& after = {})
{
    const std::size_t size = head.size();
    for (const Bytes& v : vlrs) append(head, v);
    set<std::uint32_t>(head, 96, std::uint32_t(head.size()));
    set<std::uint32_t>(head, 100, std::uint32_t(vlrs.size()));
    (void)size;
    append(head, records);
    append(head, after);
    return head;
}

inline std::uint8_t minorFor(std::uint8_t format)
{
    return std::uint8_t(format >= 6 ? 4 : format >= 4 ? 3 : 2);
}

/// `count` records of random bits. With `likely`, neighbors resemble each other, as in a survey.
inline Bytes randomRecords(std::uint8_t format, std::uint16_t length, std::size_t count, std::uint32_t seed,
                           bool likely = false)
{
    std::mt19937 random(seed);
    Bytes b(count * length);
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t k = 0; k < length; ++k) {
            std::byte v = std::byte(random() & 0xFF);
            if (likely && i != 0 && random() % 8 != 0) v = b[(i - 1) * length + k];
            b[i * length + k] = v;
        }
    (void)format;
    return b;
}

/// The record of a point that LASzip read. Written from the standard's tables, not from the program's code.
inline void toRecord(const laszip_point& p, std::uint8_t format, std::byte* r)
{
    std::size_t at = 0;
    const auto put = [&](const void* v, std::size_t n) {
        std::memcpy(r + at, v, n);
        at += n;
    };
    const auto byte = [&](unsigned v) { r[at++] = std::byte(v & 0xFF); };
    put(&p.X, 4);
    put(&p.Y, 4);
    put(&p.Z, 4);
    put(&p.intensity, 2);
    if (format < 6) {
        byte(p.return_number | p.number_of_returns << 3 | p.scan_direction_flag << 6 | p.edge_of_flight_line << 7);
        byte(p.classification | p.synthetic_flag << 5 | p.keypoint_flag << 6 | p.withheld_flag << 7);
        put(&p.scan_angle_rank, 1);
        put(&p.user_data, 1);
        put(&p.point_source_ID, 2);
        if (format == 1 || format >= 3) put(&p.gps_time, 8);
        if (format == 2 || format == 3 || format == 5) put(p.rgb, 6);
        if (format == 4 || format == 5) put(p.wave_packet, 29);
    } else {
        byte(p.extended_return_number | p.extended_number_of_returns << 4);
        byte(p.extended_classification_flags | p.extended_scanner_channel << 4 | p.scan_direction_flag << 6 |
             p.edge_of_flight_line << 7);
        byte(p.extended_classification);
        put(&p.user_data, 1);
        put(&p.extended_scan_angle, 2);
        put(&p.point_source_ID, 2);
        put(&p.gps_time, 8);
        if (format == 7 || format == 8 || format == 10) put(p.rgb, 6);
        if (format == 8 || format == 10) put(&p.rgb[3], 2);
        if (format == 9 || format == 10) put(p.wave_packet, 29);
    }
    if (p.num_extra_bytes > 0) put(p.extra_bytes, std::size_t(p.num_extra_bytes));
}

inline void check(laszip_POINTER laszip, laszip_I32 rc)
{
    if (rc == 0) return;
    laszip_CHAR* text = nullptr;
    laszip_get_error(laszip, &text);
    throw std::runtime_error(std::string("LASzip: ") + (text != nullptr ? text : "?"));
}

/// Calls f(point) for the first `count` points of a file, read serially through LASzip's own API.
template <typename F>
void forEachByLaszip(const std::filesystem::path& path, std::size_t count, F&& f)
{
    laszip_POINTER laszip = nullptr;
    laszip_create(&laszip);
    laszip_BOOL compressed = 0;
    check(laszip, laszip_open_reader(laszip, path.c_str(), &compressed));
    laszip_point* point = nullptr;
    check(laszip, laszip_get_point_pointer(laszip, &point));
    for (std::size_t i = 0; i < count; ++i) {
        check(laszip, laszip_read_point(laszip));
        f(*point);
    }
    laszip_close_reader(laszip);
    laszip_destroy(laszip);
}

inline Bytes recordsByLaszip(const std::filesystem::path& path, std::uint8_t format, std::uint16_t length,
                             std::size_t count)
{
    Bytes records(count * length);
    std::size_t i = 0;
    forEachByLaszip(path, count,
                    [&](const laszip_point& p) { toRecord(p, format, records.data() + i++ * length); });
    return records;
}

/// Fills LASzip's point from a record.
inline void setPoint(laszip_point& point, const std::byte* r, std::uint8_t format, std::uint16_t length)
{
    auto u8 = [&](std::size_t at) { return unsigned(r[at]); };
    std::memcpy(&point.X, r, 4);
    std::memcpy(&point.Y, r + 4, 4);
    std::memcpy(&point.Z, r + 8, 4);
    std::memcpy(&point.intensity, r + 12, 2);
    std::size_t at = 20;
    point.scan_direction_flag = laszip_U8(u8(format < 6 ? 14 : 15) >> 6 & 1);
    point.edge_of_flight_line = laszip_U8(u8(format < 6 ? 14 : 15) >> 7);
    if (format < 6) {
        point.return_number = laszip_U8(u8(14) & 7);
        point.number_of_returns = laszip_U8(u8(14) >> 3 & 7);
        point.classification = laszip_U8(u8(15) & 31);
        point.synthetic_flag = laszip_U8(u8(15) >> 5 & 1);
        point.keypoint_flag = laszip_U8(u8(15) >> 6 & 1);
        point.withheld_flag = laszip_U8(u8(15) >> 7);
        std::memcpy(&point.scan_angle_rank, r + 16, 1);
        point.user_data = laszip_U8(u8(17));
        std::memcpy(&point.point_source_ID, r + 18, 2);
    } else {
        point.extended_point_type = 1;
        point.extended_return_number = laszip_U8(u8(14) & 15);
        point.extended_number_of_returns = laszip_U8(u8(14) >> 4);
        point.return_number = laszip_U8(std::min(7u, u8(14) & 15));
        point.number_of_returns = laszip_U8(std::min(7u, u8(14) >> 4));
        point.extended_classification_flags = laszip_U8(u8(15) & 15);
        point.extended_scanner_channel = laszip_U8(u8(15) >> 4 & 3);
        point.synthetic_flag = laszip_U8(u8(15) & 1);
        point.keypoint_flag = laszip_U8(u8(15) >> 1 & 1);
        point.withheld_flag = laszip_U8(u8(15) >> 2 & 1);
        point.extended_classification = laszip_U8(u8(16));
        point.classification = laszip_U8(u8(16) < 32 ? u8(16) : 0);
        point.user_data = laszip_U8(u8(17));
        std::memcpy(&point.extended_scan_angle, r + 18, 2);
        std::memcpy(&point.point_source_ID, r + 20, 2);
        at = 22;
    }
    const auto take = [&](void* to, std::size_t n) {
        std::memcpy(to, r + at, n);
        at += n;
    };
    if (format == 1 || format >= 3) take(&point.gps_time, 8);
    if (format == 2 || format == 3 || format == 5 || format == 7 || format == 8 || format == 10) take(point.rgb, 6);
    if (format == 8 || format == 10) take(&point.rgb[3], 2);
    if (format == 4 || format == 5 || format == 9 || format == 10) take(point.wave_packet, 29);
    if (length > recordLength(format)) take(point.extra_bytes, length - recordLength(format));
}

/// The point part of a LAZ file (table position relative to its start, chunks, table) as LASzip writes it serially.
inline Bytes compressedByLaszip(std::uint8_t format, std::uint16_t length, const Bytes& records,
                                std::uint32_t chunkSize, Bytes* vlr = nullptr)
{
    laszip_POINTER laszip = nullptr;
    laszip_create(&laszip);
    std::ostringstream out;
    check(laszip, laszip_set_point_type_and_size(laszip, format, length));
    check(laszip, laszip_request_native_extension(laszip, 1));
    check(laszip, laszip_set_chunk_size(laszip, chunkSize));
    if (vlr != nullptr) {
        laszip_U8* p = nullptr;
        laszip_U32 n = 0;
        check(laszip, laszip_create_laszip_vlr(laszip, &p, &n));
        vlr->resize(n);
        std::memcpy(vlr->data(), p, n);
    }
    check(laszip, laszip_open_writer_stream(laszip, out, 1, 1));
    laszip_point* point = nullptr;
    check(laszip, laszip_get_point_pointer(laszip, &point));
    for (std::size_t i = 0; i * length < records.size(); ++i) {
        const std::byte* r = records.data() + i * length;
        setPoint(*point, r, format, length);
        check(laszip, laszip_write_point(laszip));
    }
    check(laszip, laszip_close_writer(laszip));
    laszip_destroy(laszip);
    const std::string s = out.str();
    Bytes bytes(s.size());
    if (!s.empty()) std::memcpy(bytes.data(), s.data(), s.size());
    return bytes;
}

/// A whole LAZ file; the table position is made absolute.
inline Bytes lazFile(std::uint8_t format, std::uint16_t length, const Bytes& records,
                     std::uint32_t chunkSize = 50000, std::uint8_t minor = 0)
{
    Bytes vlr;
    Bytes points = compressedByLaszip(format, length, records, chunkSize, &vlr);
    Bytes head =
        header(minor != 0 ? minor : minorFor(format), std::uint8_t(format | 0x80), length, records.size() / length);
    if (format >= 6)
        set<std::uint32_t>(head, 107, 0);
    else
        set<std::uint32_t>(head, 107, std::uint32_t(records.size() / length));
    Bytes all = file(head, {vlr}, points);
    const std::size_t at = all.size() - points.size();
    set<std::int64_t>(all, at, get<std::int64_t>(all, at) + std::int64_t(at));
    return all;
}

/// Files of the shared test data that can be opened; empty when the folder is not there.
inline std::vector<std::filesystem::path> sharedFiles(const std::filesystem::path& folder)
{
    std::vector<std::filesystem::path> files;
    std::error_code ec;
    for (const auto& entry : std::filesystem::directory_iterator(folder, ec)) {
        const auto ending = entry.path().extension();
        if ((ending == ".las" || ending == ".laz") && !entry.path().filename().string().starts_with("broken_"))
            files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    return files;
}

}  // namespace lasfiles
