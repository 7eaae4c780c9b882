// SPDX-License-Identifier: MIT
#include "core/las/CrsPlan.h"

#include "core/las/GeoKeys.h"
#include "core/las/WritePlan.h"

#include <algorithm>
#include <cstring>

namespace punctum::las
{

namespace
{

bool isGeoTiff(const Vlr& v)
{
    return v.is(geo::kUser, geo::kKeysId) || v.is(geo::kUser, geo::kDoublesId) || v.is(geo::kUser, geo::kAsciiId);
}

const Vlr* find(const WritePlan& plan, std::uint16_t id)
{
    for (const auto* list : {&plan.vlrs, &plan.evlrs})
        for (const Vlr& v : *list)
            if (v.is(geo::kUser, id)) return &v;
    return nullptr;
}

/// GeoTIFF keys into WKT, in their place. False when there are none, or when they cannot be translated: then they
/// stay. `asked`: who asks for WKT.
bool keysToWkt(WritePlan& plan, const std::string& asked)
{
    const Vlr* const keys = find(plan, geo::kKeysId);
    if (keys == nullptr) return false;
    std::string name;
    const std::string wkt = wktOf(GeoKeys(*keys, find(plan, geo::kAsciiId)), name);
    if (wkt.empty()) {
        plan.notes.push_back(
            "The coordinate system stays in GeoTIFF keys, which cannot be translated into the WKT that " + asked +
            " asks for; some programs will not find it.");
        return false;
    }
    std::vector<std::byte> data(wkt.size() + 1);  // with the NUL that the standard asks for
    std::memcpy(data.data(), wkt.data(), wkt.size());
    const auto isKeys = [](const Vlr& v) { return v.is(geo::kUser, geo::kKeysId); };
    const auto place = std::find_if(plan.vlrs.begin(), plan.vlrs.end(), isKeys);
    plan.vlrs.insert(place, makeVlr(geo::kUser, geo::kWktId, geo::kWktDescription, std::move(data)));
    plan.dropRecords(isGeoTiff);
    plan.notes.push_back("The coordinate system was translated from GeoTIFF keys to WKT: " + name + ".");
    return true;
}

/// WKT into GeoTIFF keys; both are kept. False when keys could not say the same.
bool wktToKeys(WritePlan& plan, const std::string& wkt)
{
    if (find(plan, geo::kKeysId) != nullptr) return true;
    std::string name;
    std::vector<std::byte> keys = keysOf(wkt, name);
    if (keys.empty()) return false;
    plan.vlrs.push_back(makeVlr(geo::kUser, geo::kKeysId, "GeoTiff GeoKeyDirectoryTag", std::move(keys)));
    plan.notes.push_back("The coordinate system was translated from WKT, which is kept, to GeoTIFF keys: " + name +
                         ".");
    return true;
}

}  // namespace

void planCrs(WritePlan& plan, const SourceFile& source, std::uint8_t format, std::uint8_t minor, Header& header)
{
    std::uint16_t bits = header.globalEncoding();
    const std::uint8_t before = source.header.versionMinor();
    const std::string version = "LAS 1." + std::to_string(minor);
    const bool becomesExtended = isExtendedFormat(format) && !isExtendedFormat(source.layout.format);
    const bool becomesNewest = minor >= 5 && before < 5;
    bool hasWkt = find(plan, geo::kWktId) != nullptr;
    if ((becomesExtended || becomesNewest) && !hasWkt)
        hasWkt = keysToWkt(plan, becomesNewest ? version : "point format " + std::to_string(format));
    if (becomesExtended && hasWkt) bits |= encoding::kWkt;
    if (becomesNewest) {
        bits |= encoding::kWkt;  // must be set: LAS 1.5, table 4
        bits &= std::uint16_t(~encoding::kTimeOffset);
        if (!hasWkt && find(plan, geo::kKeysId) == nullptr)
            plan.notes.push_back(version + " asks for a coordinate system in WKT, which the file does not have.");
        if (hasWkt && plan.dropRecords(isGeoTiff) != 0)
            plan.notes.push_back("The GeoTIFF keys are left out, since " + version + " knows WKT alone.");
    }
    if (minor < 5 && before >= 5) bits &= std::uint16_t(~encoding::kTimeOffset);
    if (minor < 4 && before >= 4 && (bits & encoding::kWkt) != 0) {
        bits &= std::uint16_t(~encoding::kWkt);
        if (hasWkt && !source.crs.empty() && !wktToKeys(plan, source.crs))
            plan.notes.push_back(version +
                                 " cannot announce the coordinate system in WKT, and GeoTIFF keys could "
                                 "not say the same; its record is kept.");
    }
    header.set(at::kGlobalEncoding, bits);
}

}  // namespace punctum::las
