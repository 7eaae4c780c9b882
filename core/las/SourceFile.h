// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Column.h"
#include "core/cloud/PointCloud.h"
#include "core/las/PointFormat.h"

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace punctum::las {

/// A variable length record, plain (54-byte header) or extended (60), kept byte for byte.
struct Vlr {
    std::uint16_t reserved = 0;
    std::array<char, 16> userId{};
    std::uint16_t recordId = 0;
    std::array<char, 32> description{};
    std::vector<std::byte> data;
    bool extended = false;

    std::string user() const;  ///< userId up to the first NUL
    bool is(std::string_view user, std::uint16_t id) const { return recordId == id && this->user() == user; }
};

/// The public header block (LAS 1.4 R15, table 3): the file's own bytes, with typed access to fields.
/// Bytes beyond the standard's end (user bytes) are kept at the end of `bytes`.
struct Header {
    std::vector<std::byte> bytes;

    template <typename T>
    T get(std::size_t offset) const;       ///< little-endian field; 0 when the header is too short
    template <typename T>
    void set(std::size_t offset, T value); ///< nothing when the header is too short

    std::uint8_t versionMajor() const { return get<std::uint8_t>(24); }
    std::uint8_t versionMinor() const { return get<std::uint8_t>(25); }
    std::uint16_t globalEncoding() const { return get<std::uint16_t>(6); }
    std::uint16_t headerSize() const { return get<std::uint16_t>(94); }
    std::uint32_t pointOffset() const { return get<std::uint32_t>(96); }
    std::uint8_t pointFormat() const { return get<std::uint8_t>(104) & 0x3F; }
    bool compressed() const { return (get<std::uint8_t>(104) & 0x80) != 0; }
    std::uint16_t recordLength() const { return get<std::uint16_t>(105); }
    std::string version() const;           ///< "1.4"
};

/// Everything of a LAS/LAZ file that is not a point, as read: what saving writes back unless it must change.
/// Immutable once made; shared by the reader, the cloud and the writer.
struct SourceFile {
    std::filesystem::path path;
    std::uint64_t fileSize = 0;
    Header header;
    std::vector<Vlr> vlrs;                   ///< laszip's own record included when compressed
    std::vector<std::byte> gapBeforePoints;  ///< bytes between the last VLR and the points
    std::vector<std::byte> gapAfterPoints;   ///< bytes between the points (LAZ: chunk table) and the first EVLR
    std::vector<Vlr> evlrs;
    std::vector<std::byte> tail;             ///< bytes after the last EVLR

    bool compressed = false;
    PointIndex pointCount = 0;     ///< points that can be read: the data decides, not the header
    RecordLayout layout;           ///< record <-> columns
    CoordinateScale coordinates;   ///< scale 1, offset 0 where the header's are unusable (then warned of)
    WorldBounds firstBounds;       ///< a first idea of the extent, from header and sampled records
    RawBounds sampledBounds;       ///< of the sampled records
    std::string crs;               ///< WKT or a line on the GeoTIFF keys; empty when there is none

    std::vector<std::string> warnings;  ///< one sentence each, for the user
    bool recovered = false;             ///< something is missing or damaged: save only under another name

    const Vlr* findVlr(std::string_view user, std::uint16_t id) const;  ///< VLRs, then EVLRs
};

}  // namespace punctum::las
