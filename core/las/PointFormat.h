// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace punctum::las
{

struct Vlr;

/// Highest point data record format that exists (LAS 1.4 R15, table 16).
constexpr std::uint8_t kLastPointFormat = 10;
constexpr double kScanAngleStep = 0.006;    ///< degrees, formats 6-10 (LAS 1.4 R15, table 13)
constexpr std::uint8_t kOverlapClass = 12;  ///< of formats 0-5, where 6-10 have a flag (table 9)

/// One column's place in the point record.
struct RecordField {
    std::string column;        ///< name of the column ("Returns" for the packed byte, "Red", "Deviation")
    std::uint16_t offset = 0;  ///< bytes from the record's start
    ScalarType type = ScalarType::U8;
    std::uint16_t components = 1;  ///< more than 1 only for undocumented bytes

    std::uint32_t bytes() const { return std::uint32_t(components * sizeOf(type)); }
};

/// Where the fields of LAS 1.4 are in records of an older format: indices into RecordLayout::fields.
struct CompatibleFields {
    std::uint8_t format = 0;  ///< that the records stand for, 6 to 10
    std::int32_t returns = -1, classes = -1, rank = -1;
    std::int32_t angle = -1, extraReturns = -1, extraClass = -1, extraFlags = -1;  ///< in extra bytes
    std::int32_t nir = -1;                                                         ///< -1: none
};

/// What the names of columns end in that are derived from others: "Returns (1.4)".
constexpr const char* kDerivedEnding = " (1.4)";

/// How a point record maps to columns: field k of the record is column k of the cloud. Fields cover the whole
/// record without overlap, in rising order of offset.
///
/// The packed bytes are columns of their own: "Returns" (byte 14 of every format), "Classes" (byte 15 of formats
/// 0-5) and "Flags" (byte 15 of formats 6-10).
struct RecordLayout {
    std::uint8_t format = 0;   ///< point data record format, 0-10
    std::uint16_t length = 0;  ///< record length in bytes, extra bytes included
    std::vector<RecordField> fields;
    std::vector<Attribute> attributes;  ///< without columns: filled by makeColumns
    /// Index into fields per component, then on into `derived`; -1: none.
    std::vector<std::array<std::int32_t, 3>> attributeFields;
    /// Columns of what other columns mean, after those of the fields; not in the record (see Compatible.h).
    std::vector<RecordField> derived;
    std::optional<CompatibleFields> compatible;

    /// Index of the field of that name, -1 when there is none.
    int find(std::string_view column) const noexcept;
    /// The field or derived column that attributeFields names.
    const RecordField& field(std::int32_t index) const
    {
        const auto k = std::size_t(index);
        return k < fields.size() ? fields[k] : derived[k - fields.size()];
    }
    bool isDerived(std::string_view column) const noexcept;
    /// Index of the column that holds the return numbers that are shown.
    std::size_t returnsColumn() const noexcept { return compatible ? fields.size() : std::size_t(find("Returns")); }
    /// The format whose attributes are shown: `format`, but for files in compatibility mode.
    std::uint8_t shownFormat() const noexcept { return compatible ? compatible->format : format; }
};

/// Bytes of the standard part of a record of this format (LAS 1.4 R15, tables 6-16); 0 for unknown formats.
std::uint16_t standardRecordLength(std::uint8_t format) noexcept;

/// What records of a format hold beside the fields that all have.
constexpr bool isExtendedFormat(std::uint8_t format) noexcept
{
    return format >= 6;
}
constexpr bool hasGpsTime(std::uint8_t f) noexcept
{
    return f == 1 || (f >= 3 && f <= kLastPointFormat);
}
constexpr bool hasColor(std::uint8_t f) noexcept
{
    return f == 2 || f == 3 || f == 5 || f == 7 || f == 8 || f == 10;
}
constexpr bool hasNir(std::uint8_t f) noexcept
{
    return f == 8 || f == 10;
}
constexpr bool hasWaveform(std::uint8_t f) noexcept
{
    return f == 4 || f == 5 || f == 9 || f == 10;
}

/// Layout of records of `format` and `length`, with the extra bytes that the descriptor records
/// (LASF_Spec/4, in file order) name. What does not fit is opaque and adds a sentence to `warnings`.
/// Throws Error when `length` is shorter than the format's own fields.
RecordLayout makeLayout(std::uint8_t format, std::uint16_t length, std::span<const Vlr* const> extraBytesRecords,
                        const CoordinateScale& coordinates, std::vector<std::string>& warnings);

/// Adds the layout's columns and attributes (and RGB, Normal) to an empty cloud.
void makeColumns(PointCloud& cloud, const RecordLayout& layout);

}  // namespace punctum::las
