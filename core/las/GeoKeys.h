// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace punctum::las
{

struct Vlr;

/// Records that say a coordinate system in LAS (LAS 1.4 R15, 3.2): WKT, and the keys of GeoTIFF 1.1 (annex B).
namespace geo
{
constexpr const char* kUser = "LASF_Projection";
constexpr std::uint16_t kWktId = 2112;
constexpr const char* kWktDescription = "OGC coordinate system WKT";
constexpr std::uint16_t kKeysId = 34735, kDoublesId = 34736, kAsciiId = 34737;
constexpr std::uint16_t kModelType = 1024, kCitation = 1026, kGeographicType = 2048, kGeographicCitation = 2049,
                        kGeographicLinearUnits = 2052, kAngularUnits = 2054, kAngularUnitSize = 2055,
                        kProjectedType = 3072, kProjectedCitation = 3073, kLinearUnits = 3076,
                        kLinearUnitSize = 3077, kVerticalType = 4096, kVerticalUnits = 4099;
constexpr std::uint16_t kUserDefined = 32767, kModelProjected = 1, kModelGeographic = 2, kModelGeocentric = 3;
}  // namespace geo

/// The GeoTIFF keys of a file: four u16 a key (id, where, count, value), after four of header. Any bytes will do:
/// what is not there is 0 or empty.
class GeoKeys
{
public:
    GeoKeys(const Vlr& keys, const Vlr* ascii, const Vlr* doubles = nullptr);
    /// Whether the header of the keys is what GeoTIFF asks for.
    bool sound() const { return m_words.size() >= 4 && m_words[0] == 1; }
    /// Whether X and Y are angles. Where the keys do not say, the code that is there tells.
    bool geographic() const
    {
        const std::uint16_t model = number(geo::kModelType);
        return model == geo::kModelGeographic ||
               (model == 0 && number(geo::kProjectedType) == 0 && number(geo::kGeographicType) != 0);
    }
    bool geocentric() const { return number(geo::kModelType) == geo::kModelGeocentric; }
    std::uint16_t number(std::uint16_t id) const;
    double real(std::uint16_t id) const;
    std::string text(std::uint16_t id) const;

private:
    const std::uint16_t* find(std::uint16_t id) const;

    std::vector<std::uint16_t> m_words;
    std::string m_ascii;
    std::vector<double> m_doubles;
};

/// GeoTIFF 1.0 named vertical systems by codes that EPSG has for their datums; the unit (EPSG's code of it, 0 where
/// none is stated) tells the system. Other codes are the system's already.
std::uint16_t verticalSystem(std::uint16_t code, std::uint16_t unit) noexcept;

/// The same coordinate system in WKT (version 1, as LAS 1.4 asks for), by the PROJ library and its database. Empty
/// when the keys do not name it by its code, when the code is unknown, or when they state units that are not the
/// system's own: WKT that says something else would be worse than none. `name`: what it is, for people.
std::string wktOf(const GeoKeys& keys, std::string& name);

/// The other way: bytes of a record of keys that name the system of this WKT by its EPSG codes. Empty when it has
/// none, or is not the same as the system that EPSG has under its code. `name`: what it is, for people.
std::vector<std::byte> keysOf(const std::string& wkt, std::string& name);

}  // namespace punctum::las
