// SPDX-License-Identifier: MIT
#include "core/las/Alignment.h"

#include "core/las/Reader.h"
#include "core/las/SourceFile.h"
#include "core/task/Progress.h"

#include <array>
#include <cstring>
#include <span>
#include <utility>
#include <vector>

namespace punctum::las
{

namespace
{

/// Bytes of a record.
struct Part {
    std::size_t first = 0;
    std::size_t count = 0;
};

/// 64 bits of these parts of a record; that two points share them by chance is not to be expected.
std::uint64_t digest(const std::byte* record, std::span<const Part> parts) noexcept
{
    std::uint64_t sum = 0x9E3779B97F4A7C15u;
    for (const Part& part : parts)
        for (std::size_t at = 0; at < part.count; at += sizeof sum) {
            std::uint64_t word = 0;
            std::memcpy(&word, record + part.first + at, std::min(sizeof word, part.count - at));
            sum = (sum ^ word) * 0xFF51AFD7ED558CCDu;
            sum ^= sum >> 32;
        }
    return sum;
}

/// Of each point; empty when some cannot be read.
std::vector<std::uint64_t> digests(const Reader& reader, std::span<const Part> parts, Progress& progress)
{
    const std::size_t length = reader.source()->layout.length;
    std::vector<std::uint64_t> sums(std::size_t(reader.source()->pointCount));
    progress.begin("Looking for the same points", sums.size());
    const ReadResult result =
        reader.visitRecords(progress, [&](PointRange range, std::span<const std::byte> records) {
            for (PointIndex i = range.first; i < range.last; ++i)
                sums[std::size_t(i)] = digest(records.data() + (i - range.first) * length, parts);
        });
    return result.missing.empty() ? std::move(sums) : std::vector<std::uint64_t>();
}

/// Takes each point of the shorter one for the next like it: if there is a way to match all, this is one.
std::optional<KeptPoints> match(const std::vector<std::uint64_t>& longer, const std::vector<std::uint64_t>& shorter)
{
    std::vector<PointRange> ranges;
    PointIndex at = 0;
    for (const std::uint64_t sum : shorter) {
        while (at < longer.size() && longer[std::size_t(at)] != sum) ++at;
        if (at == longer.size()) return {};
        if (ranges.empty() || ranges.back().last != at) ranges.push_back({at, at});
        ranges.back().last = ++at;
    }
    return KeptPoints(std::move(ranges));
}

std::vector<Part> placeAndTime(const RecordLayout& layout)
{
    std::vector<Part> parts{{0, 12}};
    if (const int k = layout.find("GpsTime"); k >= 0)
        parts.push_back({layout.fields[std::size_t(k)].offset, layout.fields[std::size_t(k)].bytes()});
    return parts;
}

}  // namespace

std::optional<KeptPoints> partOf(const Reader& longer, const Reader& shorter, Progress& progress)
{
    const SourceFile &a = *longer.source(), &b = *shorter.source();
    if (a.pointCount <= b.pointCount || a.coordinates.scale != b.coordinates.scale ||
        a.coordinates.offset != b.coordinates.offset)
        return {};
    const auto compared = [&](std::span<const Part> ofA, std::span<const Part> ofB) {
        const auto sums = digests(longer, ofA, progress);
        return sums.empty() ? std::nullopt : match(sums, digests(shorter, ofB, progress));
    };
    if (a.layout.format == b.layout.format && a.layout.length == b.layout.length) {
        const std::array<Part, 1> whole{{{0, a.layout.length}}};
        if (auto found = compared(whole, whole)) return found;
    }
    const auto ofA = placeAndTime(a.layout), ofB = placeAndTime(b.layout);
    return ofA.size() == ofB.size() ? compared(ofA, ofB) : std::nullopt;
}

}  // namespace punctum::las
