// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace punctum::las
{

struct Header;
struct SourceFile;
struct WritePlan;

/// Brings records on the coordinate system and the encoding bits to what a point format and version ask for that
/// are not the source's: WKT for the formats 6-10 and for LAS 1.5, GeoTIFF keys before LAS 1.4. What cannot be
/// translated stays, and the plan's notes say so. `header`: of LAS 1.minor already.
void planCrs(WritePlan& plan, const SourceFile& source, std::uint8_t format, std::uint8_t minor, Header& header);

}  // namespace punctum::las
