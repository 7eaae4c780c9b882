// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Column.h"

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace punctum::las
{

/// A value as it is told: exact numbers, or text. monostate: there is no such field.
using ToldValue = std::variant<std::monostate, std::int64_t, std::uint64_t, double, std::string>;

/// As text: "none" where there is no such field; doubles with the digits that tell them apart.
std::string toText(const ToldValue& value);

/// A field of the header (or of the container) whose values differ.
struct FieldDifference {
    std::string name;   ///< "generating_software", "max_x", "points_by_return[2]"
    std::string group;  ///< what it is about, for short summaries: "software", "bounds"
    ToldValue a, b;
};

/// A VLR or EVLR that only one file has, or that differs.
struct RecordDifference {
    enum class Change { Removed, Added, Changed };  ///< only in A, only in B, in both
    Change change = Change::Changed;
    std::string user;
    std::uint16_t id = 0;
    std::uint64_t lengthA = 0, lengthB = 0;  ///< bytes of data; 0 where there is no such record
    bool extendedA = false, extendedB = false;
    bool frameDiffers = false;                   ///< reserved word, description, or bytes after the user id
    std::optional<std::uint64_t> firstDataByte;  ///< where the data begin to differ
};

/// Bytes outside header fields, records and points.
struct BytesDifference {
    std::string what;  ///< "bytes before the points"
    std::uint64_t lengthA = 0, lengthB = 0;
    std::uint64_t firstByte = 0;
};

/// An attribute that only one file has, or whose values or type differ.
struct AttributeDifference {
    enum class Change { Removed, Added, Changed };  ///< only in A, only in B, in both
    Change change = Change::Changed;
    std::string name;
    std::uint64_t points = 0;  ///< whose values differ; where one file has it: whose value is not zero
    PointIndex first = 0;      ///< of these
    ToldValue a, b;            ///< values there
    std::string typeA, typeB;  ///< "uint8"; "3 bits" for bit fields; empty where there is none
    bool typeDiffers() const { return change == Change::Changed && typeA != typeB; }
};

/// What differs between two clouds on disk, A and B. Content is all that a reader of the points and of the file's
/// records can notice; the container is how it is stored: LAS or LAZ, and the positions that follow from that.
struct Difference {
    PointIndex pointsA = 0, pointsB = 0;
    PointIndex onlyA = 0, onlyB = 0;  ///< points that the other lacks
    PointIndex compared = 0;          ///< points that are in both and could be read
    PointIndex differing = 0;         ///< of these, points of which some attribute differs that both files have
    PointIndex unreadableA = 0, unreadableB = 0;
    std::vector<FieldDifference> header;
    std::vector<RecordDifference> records;
    bool recordsReordered = false;
    std::vector<BytesDifference> bytes;
    std::vector<AttributeDifference> attributes;

    std::string storedA, storedB;            ///< "LAS", "LAZ"
    std::vector<FieldDifference> container;  ///< positions, sizes and the compression record
    std::optional<std::uint64_t> firstByte;  ///< of the files, where asked for; empty: byte for byte the same

    bool contentEqual() const
    {
        return onlyA == 0 && onlyB == 0 && differing == 0 && unreadableA == 0 && unreadableB == 0 &&
               header.empty() && records.empty() && !recordsReordered && bytes.empty() && attributes.empty();
    }
    bool containerEqual() const { return container.empty() && !firstByte; }
};

/// The whole report, in lines: what `punctum diff` prints and the window shows. `a`, `b`: what the two are called.
std::string report(const Difference& difference, const std::string& a, const std::string& b);

/// In one line without a full stop: "Classification of 1,204 points; creation date and software in the header".
/// Empty when the contents are equal.
std::string summary(const Difference& difference);

}  // namespace punctum::las
