// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Units.h"

#include <map>
#include <mutex>
#include <string>
#include <vector>

namespace punctum
{
struct CoordinateScale;
struct WorldBounds;
}  // namespace punctum

namespace punctum::las
{

struct SourceFile;

/// What a file says of its coordinate system.
struct CrsInfo {
    std::string text;  ///< WKT, or "EPSG:26910 (NAD83 / UTM zone 10N)"; empty when unknown
    CoordinateUnits units;
    std::vector<std::string> warnings;  ///< one sentence each: what cannot be understood, or contradicts itself
};

/// Looks at the WKT record when the global encoding or the point format asks for it, else at the GeoTIFF keys, and
/// falls back to the other (LAS 1.4 R15, 2.2 and 3.2). WKT is read, and codes are looked up, by the PROJ library.
/// Never throws for what a file holds: garbage is "unknown".
CrsInfo readCrs(const SourceFile& source);

/// The same for many files, of which most have the same records: PROJ takes milliseconds to look a code up. Any
/// thread.
class KnownCrs
{
public:
    CrsInfo of(const SourceFile& source);

private:
    std::mutex m_mutex;
    std::map<std::string, CrsInfo> m_known;  ///< by all that readCrs() looks at; guarded by m_mutex
};

/// Holds the units against the points' box, which decides: where no system is stated, and X and Y look like
/// degrees, they are taken as such; a system that is geocentric by the file's word, with points far from the
/// earth's surface, is none. Adds a sentence to `warnings` when something changes, and for geocentric clouds, in
/// which Z is no height.
CoordinateUnits likelyUnits(const CoordinateUnits& stated, const CoordinateScale& coordinates,
                            const WorldBounds& bounds, std::vector<std::string>& warnings);

}  // namespace punctum::las
