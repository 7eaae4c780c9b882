// SPDX-License-Identifier: MIT
#include "core/las/Header.h"

#include <chrono>

namespace punctum::las
{

namespace
{

using Type = HeaderField::Type;

template <typename T>
constexpr Type typeOf()
{
    if constexpr (std::is_same_v<T, std::uint8_t>)
        return Type::U8;
    else if constexpr (std::is_same_v<T, std::uint16_t>)
        return Type::U16;
    else if constexpr (std::is_same_v<T, std::uint32_t>)
        return Type::U32;
    else if constexpr (std::is_same_v<T, std::uint64_t>)
        return Type::U64;
    else if constexpr (std::is_same_v<T, double>)
        return Type::F64;
    else if constexpr (std::is_same_v<T, at::Guid>)
        return Type::Guid;
    else
        return Type::Text;
}

/// A row of the table; what the field itself says of its place is not said again.
template <typename T, std::size_t Count>
constexpr HeaderField row(const char* name, const char* group, at::Field<T, Count> field, std::uint8_t since = 0,
                          HeaderField::Kind kind = HeaderField::Kind::Content, std::uint8_t mask = 0xFF)
{
    return {name, group, typeOf<T>(), kind, field.offset, sizeof(T), Count, since, mask};
}

constexpr HeaderField kFields[] = {
    row("file_source_id", "file source id", at::kFileSourceId),
    row("global_encoding", "encoding", at::kGlobalEncoding),
    row("project_id", "project id", at::kProjectId),
    row("version_major", "version", at::kVersionMajor),
    row("version_minor", "version", at::kVersionMinor),
    row("system_identifier", "system identifier", at::kSystemId),
    row("generating_software", "software", at::kSoftware),
    row("creation_day", "creation date", at::kCreationDay),
    row("creation_year", "creation date", at::kCreationYear),
    row("header_size", "header size", at::kHeaderSize),
    row("point_data_offset", "container", at::kPointOffset, 0, HeaderField::Kind::Place),
    row("vlr_count", kRecordNumbers, at::kVlrCount, 0, HeaderField::Kind::Place),
    row("point_format", "point format", at::kPointFormat, 0, HeaderField::Kind::Content, 0x3F),
    row("record_length", "record length", at::kRecordLength),
    row("legacy_point_count", "point counts", at::kLegacyCount),
    row("legacy_points_by_return", "points by return", at::kLegacyByReturn),
    row("scale_x", "scale", at::kScale[0]),
    row("scale_y", "scale", at::kScale[1]),
    row("scale_z", "scale", at::kScale[2]),
    row("offset_x", "offset", at::kOffset[0]),
    row("offset_y", "offset", at::kOffset[1]),
    row("offset_z", "offset", at::kOffset[2]),
    row("max_x", "bounds", at::kMax[0]),
    row("min_x", "bounds", at::kMin[0]),
    row("max_y", "bounds", at::kMax[1]),
    row("min_y", "bounds", at::kMin[1]),
    row("max_z", "bounds", at::kMax[2]),
    row("min_z", "bounds", at::kMin[2]),
    row("waveform_start", "positions", at::kWaveformStart, 3, HeaderField::Kind::Place),
    row("evlr_start", "positions", at::kEvlrStart, 4, HeaderField::Kind::Place),
    row("evlr_count", kRecordNumbers, at::kEvlrCount, 4),
    row("point_count", "point counts", at::kPointCount, 4),
    row("points_by_return", "points by return", at::kByReturn, 4),
    row("max_gps_time", "GPS time range", at::kMaxGpsTime, 5),
    row("min_gps_time", "GPS time range", at::kMinGpsTime, 5),
    row("time_offset", "time offset", at::kTimeOffset, 5),
};

}  // namespace

std::uint16_t standardHeaderSize(std::uint8_t versionMinor) noexcept
{
    if (versionMinor <= 2) return 227;
    if (versionMinor == 3) return 235;
    return versionMinor == 4 ? 375 : 393;
}

Header Header::of(std::span<const std::byte> file)
{
    Header header{{file.begin(), file.end()}};
    header.bytes.resize(std::min<std::size_t>(header.headerSize(), file.size()));
    return header;
}

std::string Header::version() const
{
    return std::to_string(versionMajor()) + "." + std::to_string(versionMinor());
}

void Header::setCreation()
{
    const auto today = std::chrono::floor<std::chrono::days>(std::chrono::system_clock::now());
    const auto year = std::chrono::year_month_day(today).year();
    const auto newYear = std::chrono::sys_days(year / std::chrono::January / 1);
    set(at::kCreationDay, std::uint16_t((today - newYear).count() + 1));
    set(at::kCreationYear, std::uint16_t(int(year)));
}

std::span<const std::byte> HeaderField::in(const Header& header, std::size_t k) const
{
    const std::size_t at = offset + k * bytes;
    if (k >= count || header.versionMinor() < since || at + bytes > header.standardEnd()) return {};
    return std::span(header.bytes).subspan(at, bytes);
}

std::span<const HeaderField> headerFields() noexcept
{
    return kFields;
}

}  // namespace punctum::las
