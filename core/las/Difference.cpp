// SPDX-License-Identifier: MIT
#include "core/las/Difference.h"

#include "core/las/Header.h"

#include "core/Text.h"
#include "core/cloud/ValueText.h"

#include <algorithm>

namespace punctum::las
{

namespace
{

constexpr std::size_t kMostInSummary = 6;  ///< attributes or records named one by one
constexpr std::size_t kMostValue = 40;     ///< columns that a value of the report takes
constexpr std::size_t kMostColumn = 100;   ///< that a column is padded to: paths of files are long

std::string name(const RecordDifference& r)
{
    return r.user + "/" + std::to_string(r.id);
}

std::string bytesText(std::uint64_t n)
{
    return n == 1 ? "1 byte" : grouped(n) + " bytes";
}

using Row = std::vector<std::string>;

/// Rows under a heading, columns as wide as they need.
void addTable(std::string& out, const std::string& heading, const std::vector<Row>& rows)
{
    if (rows.empty()) return;
    out += "\n  " + printable(heading) + "\n" + textTable(rows, {{}, 4, kMostColumn});
}

std::string shortened(const std::string& text)
{
    return cutToWidth(text, kMostValue);
}

/// A row for each field, and one for all elements of an array that differ.
std::vector<Row> fieldRows(const std::vector<FieldDifference>& fields, const std::string& a, const std::string& b)
{
    std::vector<Row> rows;
    if (!fields.empty()) rows.push_back({"", a, b});
    for (std::size_t k = 0; k < fields.size();) {
        const std::string base = fields[k].name.substr(0, fields[k].name.find('['));
        std::size_t end = k + 1;
        if (base != fields[k].name)
            while (end < fields.size() && fields[end].name.starts_with(base + '[')) ++end;
        Row row{base, "", ""};
        if (base != fields[k].name) {
            row[0] = fields[k].name;
            const std::string& last = fields[end - 1].name;
            if (end - k > 1) row[0] = row[0].substr(0, row[0].size() - 1) + " to " + last.substr(base.size() + 1);
        }
        const auto join = [&](std::string& text, const ToldValue& value) {
            if (std::holds_alternative<std::monostate>(value) && !text.empty()) return;
            text += (text.empty() ? "" : " ") + toText(value);
        };
        for (; k < end; ++k) {
            join(row[1], fields[k].a);
            join(row[2], fields[k].b);
        }
        row[1] = shortened(row[1]);
        row[2] = shortened(row[2]);
        rows.push_back(std::move(row));
    }
    return rows;
}

std::string describe(const AttributeDifference& d, const std::string& a, const std::string& b)
{
    std::string text;
    if (d.change != AttributeDifference::Change::Changed) {
        text = "only in " + (d.change == AttributeDifference::Change::Removed ? a : b);
        return text + (d.points == 0 ? ", zero for all points" : ", not zero for " + pointsText(d.points));
    }
    if (d.points != 0)
        text = pointsText(d.points) + (d.points == 1 ? " differs" : " differ") + "; point " + grouped(d.first) +
               ": " + toText(d.a) + " -> " + toText(d.b);
    if (d.typeDiffers())
        text += (text.empty() ? "same values" : "") + std::string("; stored as ") + d.typeA + " -> " + d.typeB;
    return text;
}

std::string describe(const RecordDifference& r, const std::string& a, const std::string& b)
{
    switch (r.change) {
        case RecordDifference::Change::Removed:
            return "only in " + a + ", " + bytesText(r.lengthA);
        case RecordDifference::Change::Added:
            return "only in " + b + ", " + bytesText(r.lengthB);
        case RecordDifference::Change::Changed:
            break;
    }
    std::string text =
        r.lengthA == r.lengthB ? bytesText(r.lengthA) : bytesText(r.lengthA) + " -> " + bytesText(r.lengthB);
    if (r.firstDataByte) text += ", the data differ from byte " + grouped(*r.firstDataByte);
    if (r.frameDiffers) text += ", the description or reserved bytes differ";
    if (r.extendedA != r.extendedB) text += r.extendedB ? ", becomes extended" : ", is no longer extended";
    return text;
}

/// "a, b and c", at most kMostInSummary of them.
std::string list(std::vector<std::string> names)
{
    if (names.size() > kMostInSummary) {
        const std::size_t rest = names.size() - (kMostInSummary - 1);
        names.resize(kMostInSummary - 1);
        names.push_back(std::to_string(rest) + " more");
    }
    std::string text;
    for (std::size_t k = 0; k < names.size(); ++k)
        text += (k == 0 ? "" : k + 1 == names.size() ? " and " : ", ") + names[k];
    return text;
}

}  // namespace

std::string toText(const ToldValue& value)
{
    struct Visitor {
        std::string operator()(std::monostate) const { return "none"; }
        std::string operator()(const std::string& s) const { return s.empty() ? "\"\"" : s; }
        std::string operator()(std::int64_t v) const { return std::to_string(v); }
        std::string operator()(std::uint64_t v) const { return std::to_string(v); }
        std::string operator()(double v) const { return shortestText(v); }
    };
    return std::visit(Visitor{}, value);
}

std::string report(const Difference& d, const std::string& a, const std::string& b)
{
    std::string out;
    if (d.contentEqual())
        out = a + " and " + b + " hold the same: points, records and header are equal.\n";
    else
        out = a + " and " + b + " differ.\n";

    std::vector<Row> points;
    points.push_back({a, pointsText(d.pointsA)});
    points.push_back({b, pointsText(d.pointsB)});
    if (d.unreadableA != 0) points.push_back({a, pointsText(d.unreadableA) + " cannot be read"});
    if (d.unreadableB != 0) points.push_back({b, pointsText(d.unreadableB) + " cannot be read"});
    if (d.onlyA != 0) points.push_back({b, "lacks " + pointsText(d.onlyA)});
    if (d.onlyB != 0) points.push_back({a, "lacks " + pointsText(d.onlyB)});
    points.push_back({"compared", pointsText(d.compared) + ", " + grouped(d.differing) + " differ"});
    addTable(out, "Points", points);

    std::vector<Row> attributes;
    for (const AttributeDifference& x : d.attributes) attributes.push_back({x.name, describe(x, a, b)});
    addTable(out, "Attributes", attributes);
    addTable(out, "Header", fieldRows(d.header, a, b));
    std::vector<Row> records;
    for (const RecordDifference& r : d.records) records.push_back({name(r), describe(r, a, b)});
    if (d.recordsReordered) records.push_back({"order", "the records are in another order"});
    addTable(out, "Records (VLRs)", records);
    std::vector<Row> bytes;
    for (const BytesDifference& x : d.bytes)
        bytes.push_back({x.what, bytesText(x.lengthA) + " -> " + bytesText(x.lengthB) + ", differ from byte " +
                                     grouped(x.firstByte)});
    addTable(out, "Other bytes", bytes);

    if (!d.containerEqual()) {
        std::vector<Row> stored = fieldRows(d.container, a, b);
        if (d.firstByte) stored.push_back({"the files differ from byte " + grouped(*d.firstByte)});
        addTable(out,
                 d.storedA == d.storedB
                     ? "Stored (no difference of content)"
                     : "Stored as " + d.storedA + " and " + d.storedB + " (no difference of content)",
                 stored);
    }
    return out;
}

std::string summary(const Difference& d)
{
    std::vector<std::string> parts;
    // Attributes whose counts are equal are told together: Red, Green and Blue of 5 points.
    std::vector<std::pair<std::uint64_t, std::vector<std::string>>> changed;
    std::vector<std::string> added, removed, retyped;
    for (const AttributeDifference& x : d.attributes) {
        if (x.change == AttributeDifference::Change::Added) {
            added.push_back(x.name);
        } else if (x.change == AttributeDifference::Change::Removed) {
            removed.push_back(x.name);
        } else if (x.points == 0) {
            retyped.push_back(x.name);
        } else if (!changed.empty() && changed.back().first == x.points) {
            changed.back().second.push_back(x.name);
        } else {
            changed.push_back({x.points, {x.name}});
        }
    }
    parts.reserve(parts.size() + changed.size());
    for (const auto& [points, names] : changed) parts.push_back(list(names) + " of " + pointsText(points));
    if (!added.empty()) parts.push_back("new: " + list(added));
    if (!removed.empty()) parts.push_back("no longer there: " + list(removed));
    if (!retyped.empty()) parts.push_back("other types, same values: " + list(retyped));
    if (d.onlyA != 0) parts.push_back(pointsText(d.onlyA) + " left out");
    if (d.onlyB != 0) parts.push_back(pointsText(d.onlyB) + " added");
    if (!d.header.empty()) {
        std::vector<std::string> groups;
        for (const FieldDifference& f : d.header) {
            if (!d.records.empty() && f.group == kRecordNumbers) continue;  // the records themselves are named
            if (std::find(groups.begin(), groups.end(), f.group) == groups.end()) groups.push_back(f.group);
        }
        if (!groups.empty()) parts.push_back(list(groups) + " in the header");
    }
    std::vector<std::string> records[3];
    for (const RecordDifference& r : d.records) {
        auto& names = records[std::size_t(r.change)];
        if (std::find(names.begin(), names.end(), name(r)) == names.end()) names.push_back(name(r));
    }
    const char* const kWhat[] = {" removed", " added", " changed"};
    for (std::size_t k = 0; k < 3; ++k)
        if (!records[k].empty())
            parts.push_back((records[k].size() == 1 ? "record " : "records ") + list(records[k]) + kWhat[k]);
    if (d.recordsReordered) parts.push_back("order of the records");
    for (const BytesDifference& x : d.bytes) parts.push_back(x.what);
    std::string text;
    for (const std::string& part : parts) text += (text.empty() ? "" : "; ") + part;
    return text;
}

}  // namespace punctum::las
