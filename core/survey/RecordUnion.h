// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/SourceFile.h"

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace punctum
{

/// How a field of one file's record is kept in a survey.
struct FieldLink {
    /// Index of the survey's column that has its values; -1: none, the file keeps a column of its own.
    std::int32_t column = -1;
    /// Names of the attribute that shows it, in the file by itself and in the survey: extra bytes that have the
    /// same name and another type get another one there.
    std::string ownName, sharedName;
};

/// What the records of one file are in a survey.
struct RecordLinks {
    std::vector<FieldLink> fields;  ///< as layout.fields, then layout.derived
    /// Returns, classes and scan angle are those of formats 0 to 5, the survey's those of 6 to 10: they have no
    /// link, and are converted (PackedFields.h).
    bool converted = false;
};

/// The record that holds what the records of all files of a survey hold.
struct RecordUnion {
    /// What a file of all points would be: the point format that has all standard fields, extra bytes once where
    /// name, type, scale, offset and no-data value agree, the coordinate system of the first file that has one.
    std::shared_ptr<las::SourceFile> source;
    std::vector<RecordLinks> parts;
};

/// `files` are not empty; points of the union: `points`. Bytes that nobody described stay with each file, as do the
/// stored fields of files in compatibility mode. Throws Error when a record cannot hold it all.
RecordUnion uniteRecords(std::span<const std::shared_ptr<const las::SourceFile>> files,
                         const CoordinateScale& coordinates, PointIndex points);

}  // namespace punctum
