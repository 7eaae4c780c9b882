// SPDX-License-Identifier: MIT
#include "core/las/HeaderWords.h"

#include "core/Text.h"
#include "core/las/Compatible.h"
#include "core/las/GeoKeys.h"
#include "core/las/GpsTime.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>

namespace punctum::las
{

namespace
{

using std::chrono::sys_days;

std::string dayText(sys_days day)
{
    const std::chrono::year_month_day date(day);
    char text[24];
    std::snprintf(text, sizeof text, "%04d-%02u-%02u", int(date.year()), unsigned(date.month()),
                  unsigned(date.day()));
    return text;
}

struct Known {
    const char* user;
    std::uint16_t id;
    const char* words;
};

/// LAS 1.4 R15, 2.5 and 3; LASzip, COPC 1.0 and LAStools for what is theirs.
constexpr Known kKnown[] = {
    {geo::kUser, geo::kWktId, "Coordinate system in WKT"},
    {geo::kUser, 2111, "Math transform in WKT"},
    {geo::kUser, geo::kKeysId, "GeoTIFF keys"},
    {geo::kUser, geo::kDoublesId, "Numbers of the GeoTIFF keys"},
    {geo::kUser, geo::kAsciiId, "Texts of the GeoTIFF keys"},
    {"liblas", geo::kWktId, "Coordinate system in WKT, by libLAS"},
    {"LASF_Spec", 0, "Names of classes"},
    {"LASF_Spec", 2, "Histogram"},
    {"LASF_Spec", 3, "Text"},
    {"LASF_Spec", kExtraBytesRecordId, "Descriptions of extra bytes"},
    {"LASF_Spec", 7, "Superseded"},
    {"LASF_Spec", 65535, "Waveforms"},
    {"laszip encoded", 22204, "How the points are compressed"},
    {kCompatibleUser, kCompatibleRecordId, "Header of LAS 1.4, for LASzip's compatibility mode"},
    {"LAStools", 10, "Tile of LAStools"},
    {"LAStools", 30, "Index of LAStools"},
    {"copc", 1, "COPC: how the octree lies"},
    {"copc", 10000, "COPC: extents of a draft"},
    {"copc", 1000, "COPC: the nodes of the octree"},
};

constexpr std::uint16_t kFirstWaveform = 100, kLastWaveform = 355;  ///< LASF_Spec: descriptors of wave packets

}  // namespace

template <std::size_t N>
std::string headerText(const Header& header, at::Field<at::Text<N>> field)
{
    const at::Text<N> chars = header.get(field);
    std::string text = fixedText(std::as_bytes(std::span(chars)));
    text.erase(text.find_last_not_of(' ') + 1);
    return text;
}
template std::string headerText(const Header&, at::Field<at::Text<32>>);

std::string guidText(const Header& header)
{
    const at::Guid id = header.get(at::kProjectId);
    if (std::all_of(id.begin(), id.end(), [](std::byte b) { return b == std::byte(0); })) return {};
    // a number of 32 bits, two of 16, and eight bytes (LAS 1.4 R15, table 3)
    constexpr int kOrder[] = {3, 2, 1, 0, -1, 5, 4, -1, 7, 6, -1, 8, 9, -1, 10, 11, 12, 13, 14, 15};
    std::string text;
    for (const int k : kOrder) text += k < 0 ? "-" : hexText(std::to_integer<std::uint64_t>(id[std::size_t(k)]), 2);
    std::transform(text.begin(), text.end(), text.begin(),
                   [](char c) { return c >= 'a' ? char(c - 'a' + 'A') : c; });
    return text;
}

std::string creationText(const Header& header)
{
    const unsigned day = header.get(at::kCreationDay), year = header.get(at::kCreationYear);
    if (day == 0 || day > 366 || year < 1900 || year > 9999) return {};
    return dayText(sys_days(std::chrono::year(int(year)) / std::chrono::January / 1) +
                   std::chrono::days(int(day) - 1));
}

std::vector<std::string> encodingWords(const Header& header)
{
    std::vector<std::string> words;
    const std::uint8_t format = header.pointFormat();
    if (hasGpsTime(format)) words.push_back("GPS times are " + gpsClockText(header));
    if (header.says(encoding::kInternalWaveform)) words.emplace_back("waveforms are in this file");
    if (header.says(encoding::kExternalWaveform)) words.emplace_back("waveforms are in a .wdp file");
    if (header.says(encoding::kSyntheticReturns)) words.emplace_back("return numbers are synthetic");
    words.push_back(header.says(encoding::kWkt) ? "the coordinate system is given in WKT"
                                                : "the coordinate system, if any, is given in GeoTIFF keys");
    const unsigned known = 31u | (header.versionMinor() >= 5 ? encoding::kTimeOffset : 0u);
    if (const unsigned rest = header.globalEncoding() & ~known; rest != 0)
        words.push_back("other bits: 0x" + hexText(rest, 4));
    return words;
}

std::string gpsDay(double adjusted)
{
    using namespace std::chrono;
    constexpr double kShift = 1e9;     // s, LAS 1.4 R15, 2.4
    constexpr double kLargest = 1e11;  // s: some thousand years
    constexpr sys_days kEpoch = year(1980) / January / 6;
    if (!(std::abs(adjusted) < kLargest)) return {};
    return dayText(kEpoch + floor<days>(seconds(std::llround(std::floor(adjusted + kShift)))));
}

std::string gpsDay(const Header& header, double time)
{
    switch (gpsClock(header)) {
        case GpsClock::Week:
            break;
        case GpsClock::Adjusted:
            return gpsDay(time);
        case GpsClock::Offset:
            return gpsDay(time + header.get(at::kTimeOffset) * 1e6 - 1e9);
    }
    return {};
}

std::string unitsText(const CoordinateUnits& units)
{
    using Kind = CoordinateUnits::Kind;
    const auto orUnknown = [](const std::string& name) { return name.empty() ? std::string("not known") : name; };
    std::string text = orUnknown(units.horizontal);
    if (units.kind == Kind::Geocentric) return text + ", from the middle of the earth";
    if (units.vertical != units.horizontal) text += ", heights in " + orUnknown(units.vertical);
    return units.guessed ? text + " (nothing is stated, it looks like it)" : text;
}

std::string recordWords(const Vlr& record)
{
    const std::string user = record.user();
    for (const Known& known : kKnown)
        if (record.recordId == known.id && user == known.user) return known.words;
    if (user == "LASF_Spec" && record.recordId >= kFirstWaveform && record.recordId <= kLastWaveform)
        return "Description of wave packets";
    std::string own = fixedText(std::as_bytes(std::span(record.description)));
    own.erase(own.find_last_not_of(' ') + 1);
    return own;
}

}  // namespace punctum::las
