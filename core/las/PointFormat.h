// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace punctum::las
{

struct Vlr;

/// Highest point data record format that exists (LAS 1.4 R15, table 16).
constexpr std::uint8_t kLastPointFormat = 10;

/// One column's place in the point record.
struct RecordField {
    std::string column;        ///< name of the column ("Returns" for the packed byte, "Red", "Deviation")
    std::uint16_t offset = 0;  ///< bytes from the record's start
    ScalarType type = ScalarType::U8;
    std::uint16_t components = 1;  ///< more than 1 only for undocumented bytes

    std::uint32_t bytes() const { return std::uint32_t(components * sizeOf(type)); }
};

/// How a point record maps to columns: field k of the record is column k of the cloud. Fields cover the whole
/// record without overlap, in rising order of offset.
///
/// The packed bytes are columns of their own: "Returns" (byte 14 of every format), "Classes" (byte 15 of formats
/// 0-5) and "Flags" (byte 15 of formats 6-10).
struct RecordLayout {
    std::uint8_t format = 0;   ///< point data record format, 0-10
    std::uint16_t length = 0;  ///< record length in bytes, extra bytes included
    std::vector<RecordField> fields;
    std::vector<Attribute> attributes;                         ///< without columns: filled by makeColumns
    std::vector<std::array<std::int32_t, 3>> attributeFields;  ///< index into fields per component, -1: none

    /// Index of the field of that name, -1 when there is none.
    int find(std::string_view column) const noexcept;
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

/// Highest class code that records of this format can hold: 31 or 255.
std::uint32_t maxClass(std::uint8_t format) noexcept;

}  // namespace punctum::las
