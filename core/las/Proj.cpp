// SPDX-License-Identifier: MIT
#include "core/las/Proj.h"

#include <cmath>
#include <string_view>

namespace punctum::las::proj
{

Context makeContext()
{
    Context context(proj_context_create());
    if (context) {
        // Levels do not keep it from saying that there is no database.
        proj_log_func(context.get(), nullptr, [](void*, int, const char*) {});
        proj_context_set_enable_network(context.get(), 0);
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
    if (code != nullptr && authority != nullptr && std::string_view(authority) == "EPSG") {
        unsigned number = 0;
        for (const char* p = code; *p >= '0' && *p <= '9' && number < 100000; ++p)
            number = number * 10 + unsigned(*p - '0');
        if (number <= UINT16_MAX) unit.code = std::uint16_t(number);
    }
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
