// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace punctum::las
{

struct SourceFile;

/// What a file says of its coordinate system.
struct CrsInfo {
    std::string text;                  ///< WKT, or "EPSG:26910 (NAD83 / UTM zone 10N)"; empty when unknown
    std::string horizontalUnit = "m";  ///< of X and Y: "m", "ft" or "deg"
    std::string verticalUnit = "m";    ///< of Z
    bool unreadable = false;           ///< there is a record, but nothing can be made of it
};

/// Looks at the WKT record when the global encoding or the point format asks for it, else at the GeoTIFF keys, and
/// falls back to the other (LAS 1.4 R15, 2.2 and 3.2). Never throws: garbage is "unknown".
CrsInfo readCrs(const SourceFile& source);

}  // namespace punctum::las
