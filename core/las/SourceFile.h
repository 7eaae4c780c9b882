// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Column.h"
#include "core/cloud/KeptPoints.h"
#include "core/cloud/PointCloud.h"
#include "core/las/Copc.h"
#include "core/las/ExtraBytes.h"
#include "core/las/File.h"
#include "core/las/GpsTime.h"
#include "core/las/Header.h"
#include "core/las/PointFormat.h"

#include <array>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace punctum::las
{

/// A variable length record, plain (54-byte header) or extended (60), kept byte for byte.
struct Vlr {
    static constexpr std::size_t kHeaderSize = 54;
    static constexpr std::size_t kExtendedHeaderSize = 60;

    std::uint16_t reserved = 0;
    std::array<char, 16> userId{};
    std::uint16_t recordId = 0;
    std::array<char, 32> description{};
    std::vector<std::byte> data;
    bool extended = false;

    std::string user() const;  ///< userId up to the first NUL
    bool is(std::string_view user, std::uint16_t id) const { return recordId == id && this->user() == user; }
    std::uint64_t bytesInFile() const { return (extended ? kExtendedHeaderSize : kHeaderSize) + data.size(); }
};

/// A record of our own; user and description are cut to 16 and 32 bytes.
Vlr makeVlr(std::string_view user, std::uint16_t id, std::string_view description, std::vector<std::byte> data,
            bool extended = false);

/// A value that any thread may take a copy of, or replace.
template <typename T>
class Guarded
{
public:
    T get() const
    {
        const std::lock_guard lock(m_mutex);
        return m_value;
    }
    void set(T value)
    {
        const std::lock_guard lock(m_mutex);
        m_value = std::move(value);
    }

private:
    mutable std::mutex m_mutex;
    T m_value;
};

/// What the points were when they were read, from which saving tells whether the header's figures still hold.
/// Filled by Reader::read.
struct PointsAsRead {
    bool complete = false;                     ///< all points were looked at
    RawBounds bounds;                          ///< of the points that could be read
    std::array<std::uint64_t, 16> byReturn{};  ///< points of return number 0 to 15
    std::vector<PointRange> missing;           ///< damaged: their values are 0 and mean nothing
    std::vector<ExtraBytesRange> extra;        ///< see extraBytesRanges
    GpsRange gps;                              ///< of files whose header has one: LAS 1.5
    TimeExtent times;                          ///< of COPC files
};

/// The points of a cloud without those that are missing, as ranges.
std::vector<PointRange> readable(PointIndex points, const std::vector<PointRange>& missing);

/// The file that holds the cloud at present: the one it was read from, later the one it was last saved to.
/// Saving looks there whether somebody else changed that file meanwhile, and for compressed chunks that no edit
/// touched.
struct CurrentFile {
    std::filesystem::path path;  ///< empty: a cloud made here, never saved
    FileStamp stamp;
    bool saved = false;    ///< written by us: it holds the points that a save writes, not those that were read
    bool pristine = true;  ///< its points and their places are those of the file that was read
    std::shared_ptr<const KeptPoints> kept;  ///< the points of the cloud that it holds; null: all
};

/// Everything of a LAS/LAZ file that is not a point, as read: what saving writes back unless it must change.
/// Immutable once made (but for `asRead` and `current`); shared by the reader, the cloud and the writer.
struct SourceFile {
    std::filesystem::path path;  ///< empty for a cloud made here
    std::uint64_t fileSize = 0;
    Header header;
    std::vector<Vlr> vlrs;                   ///< laszip's own record included when compressed
    std::vector<std::byte> gapBeforePoints;  ///< bytes between the last VLR and the points
    std::vector<std::byte> gapAfterPoints;   ///< bytes between the points (LAZ: chunk table) and the first EVLR
    std::vector<Vlr> evlrs;                  ///< of 1.3: the waveform record, when it is in the file
    std::uint64_t pointDataEnd = 0;          ///< first byte after the points (LAZ: chunk table) in the file
    std::vector<std::byte> tail;             ///< bytes after the last EVLR (or after the points if there is none)

    bool compressed = false;
    PointIndex pointCount = 0;              ///< points that can be read: the data decides, not the header
    RecordLayout layout;                    ///< record <-> columns
    CoordinateScale coordinates;            ///< scale 1, offset 0 where the header's are unusable (then warned of)
    WorldBounds firstBounds;                ///< a first idea of the extent, from header and sampled records
    RawBounds sampledBounds;                ///< of the sampled records
    CoordinateUnits units;                  ///< of the coordinates, as the coordinate system says
    std::shared_ptr<const CopcIndex> copc;  ///< of a COPC file whose octree belongs to its points; else null
    std::string copcTrouble;                ///< why a COPC file has none: the end of a sentence
    std::string crs;                        ///< WKT or a line on the GeoTIFF keys; empty when there is none

    std::vector<std::string> warnings;  ///< one sentence each, for the user
    std::vector<std::string> losses;    ///< those of the warnings that tell of what is missing or damaged
    bool recovered = false;             ///< there are losses: save only under another name

    std::shared_ptr<Guarded<PointsAsRead>> asRead = std::make_shared<Guarded<PointsAsRead>>();
    std::shared_ptr<Guarded<CurrentFile>> current = std::make_shared<Guarded<CurrentFile>>();

    /// Of the coordinates, and of the attributes X, Y and Z.
    void setUnits(const CoordinateUnits& coordinateUnits);
    const Vlr* findVlr(std::string_view user, std::uint16_t id) const;  ///< VLRs, then EVLRs
    /// All Extra Bytes records, VLRs then EVLRs, in file order.
    std::vector<const Vlr*> extraBytesRecords() const;
    /// Index into `evlrs` of the record that the header's waveform start points at.
    std::optional<std::size_t> waveformEvlr;
};

/// The non-point part of a cloud made here: LAS 1.4, uncompressed, `format` with these extra bytes, the WKT (may be
/// empty) as a VLR. Counts and bounds are written when the cloud is saved. Throws Error on an unknown format.
///
/// Example:
///     auto source = las::makeSource(7, fields, coordinates, wkt, n);
///     auto cloud = std::make_shared<PointCloud>(n, coordinates);
///     las::makeColumns(*cloud, source->layout);
///     cloud->setSource(source);
std::shared_ptr<SourceFile> makeSource(std::uint8_t format, std::span<const ExtraBytesField> extraBytes,
                                       const CoordinateScale& coordinates, std::string_view wkt, PointIndex points);
/// The same with all its records, extra bytes among them, as they will be written; `bits`: of the global encoding.
std::shared_ptr<SourceFile> makeSource(std::uint8_t format, std::vector<Vlr> records,
                                       const CoordinateScale& coordinates, std::uint16_t bits, PointIndex points);

}  // namespace punctum::las
