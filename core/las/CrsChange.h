// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Units.h"

#include <glm/vec3.hpp>

#include <memory>
#include <span>
#include <string>

namespace punctum::las
{

/// From one coordinate system to another, as the PROJ library does it: X and Y in the order east, north, whatever
/// the system says of its axes. One thread at a time.
///
/// Systems are named as SourceFile::crs does: WKT, or "EPSG:26910 (NAD83 / UTM zone 10N)".
class CrsChange
{
public:
    /// Null where one of them is not understood, or PROJ knows no way.
    static std::unique_ptr<CrsChange> between(const std::string& from, const std::string& to);
    ~CrsChange();
    CrsChange(const CrsChange&) = delete;
    CrsChange& operator=(const CrsChange&) = delete;

    /// In place. What cannot be converted becomes NaN.
    void operator()(std::span<glm::dvec3> points) const;

private:
    struct Impl;
    explicit CrsChange(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> m_impl;
};

/// Whether two such names mean the same system: equal texts, or what PROJ holds for equivalent.
bool sameCrs(const std::string& a, const std::string& b);

/// "NAD83 / UTM zone 10N"; the text itself where it is not understood.
std::string crsName(const std::string& crs);

/// Whether X and Y are in the unit of the system, and not in another that the file states beside it; true where one
/// of them is not known.
bool isInUnitsOf(const CoordinateUnits& units, const std::string& crs);

}  // namespace punctum::las
