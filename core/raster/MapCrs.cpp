// SPDX-License-Identifier: MIT
#include "core/raster/MapCrs.h"

#include "core/cloud/PointCloud.h"
#include "core/las/CrsChange.h"
#include "core/las/GeoKeys.h"
#include "core/las/Proj.h"
#include "core/las/SourceFile.h"

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <string_view>

namespace punctum
{

namespace
{

namespace proj = las::proj;

constexpr std::string_view kEpsgPrefix = "EPSG:";
constexpr int kSure = 90;  ///< per cent of confidence from which PROJ's identification is believed

/// EPSG's code of a system, that it names itself or that PROJ finds to be the same; 0: none.
std::uint16_t epsgCode(PJ_CONTEXT* context, const PJ* crs)
{
    if (const std::uint16_t own = proj::codeOf(context, crs); own != 0) return own;
    int* confidence = nullptr;
    PJ_OBJ_LIST* const found = proj_identify(context, crs, "EPSG", nullptr, &confidence);
    std::uint16_t code = 0;
    if (found != nullptr && proj_list_get_count(found) > 0 && confidence[0] >= kSure) {
        const proj::Object best(proj_list_get(context, found, 0));
        if (best) code = proj::codeOf(context, best.get());
    }
    proj_int_list_destroy(confidence);
    proj_list_destroy(found);
    return code;
}

void addWktOfMap(PJ_CONTEXT* context, MapCrs& map)
{
    const char* const options[] = {"STRICT=NO", nullptr};
    proj::Object crs(proj_create_from_wkt(context, map.text.c_str(), options, nullptr, nullptr));
    if (crs && proj_get_type(crs.get()) == PJ_TYPE_BOUND_CRS) crs.reset(proj_get_source_crs(context, crs.get()));
    if (!crs) return;
    map.name = proj_get_name(crs.get());
    proj::Object height;
    if (proj_get_type(crs.get()) == PJ_TYPE_COMPOUND_CRS) {
        height.reset(proj_crs_get_sub_crs(context, crs.get(), 1));
        crs.reset(proj_crs_get_sub_crs(context, crs.get(), 0));
        if (!crs) return;
        if (proj_get_type(crs.get()) == PJ_TYPE_BOUND_CRS) crs.reset(proj_get_source_crs(context, crs.get()));
        if (!crs) return;
    }
    const PJ_TYPE type = proj_get_type(crs.get());
    map.geographic = type == PJ_TYPE_GEOGRAPHIC_2D_CRS || type == PJ_TYPE_GEOGRAPHIC_3D_CRS;
    map.horizontal = epsgCode(context, crs.get());
    map.unit = proj::unitOfAxis(context, crs.get(), 0).code;
    if (height) {
        map.vertical = epsgCode(context, height.get());
        map.verticalUnit = proj::unitOfAxis(context, height.get(), 0).code;
    }
    if (map.horizontal == 0)
        if (const char* const wkt = proj_as_wkt(context, crs.get(), PJ_WKT1_ESRI, nullptr)) {
            for (const char* p = wkt; *p != '\0'; ++p)
                if (*p != '\n') map.wkt += *p;
        }
}

/// The keys of a system that the file defines by itself.
void addKeysOfMap(const las::SourceFile& file, MapCrs& map)
{
    constexpr std::uint16_t kFirstKey = las::geo::kModelType, kRasterType = 1025, kLastKey = 4099;
    const las::Vlr* const record = file.findVlr(las::geo::kUser, las::geo::kKeysId);
    if (record == nullptr) return;
    const las::GeoKeys keys(*record, file.findVlr(las::geo::kUser, las::geo::kAsciiId),
                            file.findVlr(las::geo::kUser, las::geo::kDoublesId));
    if (!keys.sound()) return;
    for (std::uint16_t id = kFirstKey; id <= kLastKey; ++id) {
        if (id == kRasterType) continue;
        if (const std::uint16_t number = keys.number(id); number != 0)
            map.keys.push_back({id, number});
        else if (const double real = keys.real(id); std::isfinite(real) && real != 0.0)
            map.keys.push_back({id, real});
        else if (std::string text = keys.text(id); !text.empty())
            map.keys.push_back({id, std::move(text)});
    }
    map.name = map.text;
}

}  // namespace

MapCrs mapCrs(const PointCloud& cloud)
{
    MapCrs map;
    map.units = cloud.units();
    map.geographic = map.units.kind == CoordinateUnits::Kind::Degrees;
    const auto source = cloud.source();  // NOLINT(performance-unnecessary-copy-initialization): may be replaced
    if (!source || source->crs.empty()) return map;
    map.text = source->crs;
    const proj::Context context = proj::makeContext();
    if (!context) return map;
    if (!map.text.starts_with(kEpsgPrefix)) {
        if (map.text.find('[') != std::string::npos && !map.text.starts_with("ESRI PE"))
            addWktOfMap(context.get(), map);
        else
            addKeysOfMap(*source, map);
        return map;
    }
    map.horizontal = std::uint16_t(std::strtoul(map.text.c_str() + kEpsgPrefix.size(), nullptr, 10));
    map.name = las::crsName(map.text);
    if (const proj::Object crs = proj::fromCode(context.get(), map.horizontal))
        map.unit = proj::unitOfAxis(context.get(), crs.get(), 0).code;
    const auto keysOfFile = [&](const las::SourceFile& file) {
        const las::Vlr* const record = file.findVlr(las::geo::kUser, las::geo::kKeysId);
        if (record == nullptr) return;
        const las::GeoKeys keys(*record, file.findVlr(las::geo::kUser, las::geo::kAsciiId));
        const std::uint16_t stated = keys.number(las::geo::kLinearUnits);
        if (stated != 0 && stated != las::geo::kUserDefined && !keys.geographic()) map.unit = stated;
        map.verticalUnit = keys.number(las::geo::kVerticalUnits);
        const std::uint16_t vertical = las::verticalSystem(keys.number(las::geo::kVerticalType), map.verticalUnit);
        const proj::Object height = vertical == 0 ? proj::Object() : proj::fromCode(context.get(), vertical);
        if (height && proj_get_type(height.get()) == PJ_TYPE_VERTICAL_CRS) map.vertical = vertical;
    };
    keysOfFile(*source);
    return map;
}

}  // namespace punctum
