// SPDX-License-Identifier: MIT
#include "core/las/Proj.h"

#include <cmath>
#include <string_view>

namespace punctum::las::proj
{

namespace
{

/// 0 where it is no number of 16 bits.
std::uint16_t codeFrom(const char* text)
{
    unsigned number = 0;
    for (; *text >= '0' && *text <= '9' && number <= UINT16_MAX; ++text)
        number = number * 10 + unsigned(*text - '0');
    return *text == '\0' && number <= UINT16_MAX ? std::uint16_t(number) : std::uint16_t(0);
}

}  // namespace

Context makeContext(Database database)
{
    Context context(proj_context_create());
    if (context) {
        // Levels do not keep it from saying that there is no database.
        proj_log_func(context.get(), nullptr, [](void*, int, const char*) {});
        proj_context_set_enable_network(context.get(), 0);
        if (database == Database::Unused)
            proj_context_set_file_finder(
                context.get(), [](PJ_CONTEXT*, const char*, void*) { return "/dev/null/unused"; }, nullptr);
    }
    return context;
}

bool hasDatabase(PJ_CONTEXT* context)
{
    return proj_context_get_database_metadata(context, "EPSG.VERSION") != nullptr;
}

Object fromCode(PJ_CONTEXT* context, std::uint16_t code)
{
    return Object(
        proj_create_from_database(context, "EPSG", std::to_string(code).c_str(), PJ_CATEGORY_CRS, 0, nullptr));
}

std::uint16_t codeOf(PJ_CONTEXT* context, const PJ* crs)
{
    const char* const authority = proj_get_id_auth_name(crs, 0);
    const char* const text = proj_get_id_code(crs, 0);
    if (authority == nullptr || text == nullptr || std::string_view(authority) != "EPSG") return 0;
    const std::uint16_t code = codeFrom(text);
    const Object known = fromCode(context, code);
    const bool same = known && proj_is_equivalent_to_with_ctx(context, crs, known.get(),
                                                              PJ_COMP_EQUIVALENT_EXCEPT_AXIS_ORDER_GEOGCRS) != 0;
    return same ? code : std::uint16_t(0);
}

Unit unitOfAxis(PJ_CONTEXT* context, const PJ* crs, int axis)
{
    Unit unit;
    const Object system(proj_crs_get_coordinate_system(context, crs));
    const char *name = nullptr, *authority = nullptr, *code = nullptr;
    double size = 0.0;
    if (!system || axis >= proj_cs_get_axis_count(context, system.get()) ||
        !proj_cs_get_axis_info(context, system.get(), axis, nullptr, nullptr, nullptr, &size, &name, &authority,
                               &code))
        return unit;
    if (!std::isfinite(size) || size <= 0.0) return unit;
    unit.size = size;
    if (name != nullptr) unit.name = name;
    if (code != nullptr && authority != nullptr && std::string_view(authority) == "EPSG")
        unit.code = codeFrom(code);
    const PJ_COORDINATE_SYSTEM_TYPE type = proj_cs_get_type(context, system.get());
    unit.angle = axis < 2 && (type == PJ_CS_TYPE_ELLIPSOIDAL || type == PJ_CS_TYPE_SPHERICAL);
    return unit;
}

Unit unitOfCode(PJ_CONTEXT* context, std::uint16_t code)
{
    Unit unit;
    const char *name = nullptr, *category = nullptr;
    double size = 0.0;
    if (!proj_uom_get_info_from_database(context, "EPSG", std::to_string(code).c_str(), &name, &size, &category) ||
        !std::isfinite(size) || size <= 0.0 || category == nullptr)
        return unit;
    const std::string_view kind(category);
    if (kind != "linear" && kind != "angular") return unit;
    unit = {size, name != nullptr ? name : "", code, kind == "angular"};
    return unit;
}

}  // namespace punctum::las::proj
