// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/PointFormat.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace punctum::las
{

struct SourceFile;

/// LAS 1.4 stored as LAS 1.2 or 1.3, as LASzip's compatibility mode does it: records of formats 1, 3, 4 and 5 with
/// what formats 6 to 10 have beyond them in extra bytes, and a record of user "lascompatible" that says so.
///
/// In memory the fields of the file's records stay columns as they are. Beside them there are columns of what they
/// mean ("Returns (1.4)", "Flags (1.4)", "Classification (1.4)", "ScanAngle (1.4)"), which the attributes show and
/// edits change. Before writing, storeCompatible() brings the stored columns up to date, where they mean something
/// else than the others say: so that what nobody edited keeps its bytes.
///
/// LASzip finds the extra bytes by offsets from the record without a check. Here they are fields of the layout, by
/// their names, which lie inside the record.

constexpr const char* kCompatibleUser = "lascompatible";
constexpr std::uint16_t kCompatibleRecordId = 22204;

/// Makes the layout of records of an older format one that is shown as LAS 1.4, when the file has the record and
/// the fields. False, with a sentence in `warnings`, when it has the record only.
bool useCompatibility(const SourceFile& source, RecordLayout& layout, std::vector<std::string>& warnings);

/// Fills the columns of what is meant from those of what is stored: columns[k] is where field k of the first of
/// `count` points is, those of layout.derived after those of layout.fields.
void decodeCompatible(const RecordLayout& layout, std::span<std::byte* const> columns, std::size_t count);

/// `record`, and behind it what it means: layout.length + 5 bytes, at the offsets of layout.derived.
void expandCompatible(const RecordLayout& layout, const std::byte* record, std::byte* expanded);

/// Brings the stored columns up to date with the others, in parallel; changes no value that anybody sees. Takes
/// cloud.mutex() alone when the cloud is of such a file, else does nothing.
void storeCompatible(const PointCloud& cloud);

/// The same points as a cloud whose records are of LAS 1.4, for writing them in that form: columns are shared but
/// for the derived ones, which are copied under their standard names; the source has the LAS 1.4 header that the
/// record kept. Null unless the cloud is of such a file and `format`, which is asked for, is one of LAS 1.4. Hold
/// cloud.mutex(). Throws Error.
std::shared_ptr<PointCloud> nativeCloud(const PointCloud& cloud, std::optional<std::uint8_t> format);

/// Makes the counts of points in the record's copy of the LAS 1.4 header those of the points that are written.
void setCompatibleCounts(Vlr& record, PointIndex points, std::span<const std::uint64_t, 16> byReturn);

}  // namespace punctum::las
