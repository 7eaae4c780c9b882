// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>


namespace punctum::las {

struct Vlr;

/// One column's place in the point record.
struct RecordField {
    std::string column;            ///< name of the column ("Returns" for the packed byte, "Red", "Deviation")
    std::uint16_t offset = 0;      ///< bytes from the record's start
    ScalarType type = ScalarType::U8;
    std::uint16_t components = 1;  ///< more than 1 only for undocumented bytes

    std::uint32_t bytes() const { return std::uint32_t(components * sizeOf(type)); }
};

/// How a point record maps to columns: field k of the record is column k of the cloud. Fields cover the whole
/// record without overlap, in rising order of offset.
struct RecordLayout {
    std::uint8_t format = 0;       ///< point data record format, 0-10
    std::uint16_t length = 0;      ///< record length in bytes, extra bytes included
    std::vector<RecordField> fields;
    std::vector<Attribute> attributes;          ///< without columns: filled by makeColumns
    std::vector<std::array<std::int32_t, 3>> attributeFields;  ///< index into fields per component, -1: none
};

/// Bytes of the standard part of a record of this format (LAS 1.4 R15, tables 6-16); 0 for unknown formats.
std::uint16_t standardRecordLength(std::uint8_t format) noexcept;

/// Layout of records of `format` and `length`, with the extra bytes that the descriptor records
/// (LASF_Spec/4, in file order) name. What does not fit is opaque and adds a sentence to `warnings`.
RecordLayout makeLayout(std::uint8_t format, std::uint16_t length, std::span<const Vlr* const> extraBytesRecords,
                        const CoordinateScale& coordinates, std::vector<std::string>& warnings);

/// Adds the layout's columns and attributes (and RGB, Normal) to an empty cloud.
void makeColumns(PointCloud& cloud, const RecordLayout& layout);

/// Highest class code that records of this format can hold: 31 or 255.
std::uint32_t maxClass(std::uint8_t format) noexcept;

}  // namespace punctum::las
