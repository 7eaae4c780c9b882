// SPDX-License-Identifier: MIT
#include "core/las/CrsChange.h"

#include "core/las/Proj.h"

#include <cmath>
#include <cstdlib>
#include <limits>
#include <string_view>
#include <utility>

namespace punctum::las
{

namespace
{

constexpr std::string_view kCode = "EPSG:";

proj::Object objectOf(PJ_CONTEXT* context, const std::string& crs)
{
    if (crs.starts_with(kCode)) {
        const unsigned long code = std::strtoul(crs.c_str() + kCode.size(), nullptr, 10);
        return code == 0 || code > UINT16_MAX ? proj::Object() : proj::fromCode(context, std::uint16_t(code));
    }
    if (crs.find('[') == std::string::npos) return {};
    const char* const options[] = {"STRICT=NO", nullptr};
    proj::Object object(proj_create_from_wkt(context, crs.c_str(), options, nullptr, nullptr));
    return object && proj_is_crs(object.get()) != 0 ? std::move(object) : proj::Object();
}

}  // namespace

struct CrsChange::Impl {
    proj::Context context;
    proj::Object change;
};

CrsChange::CrsChange(std::unique_ptr<Impl> impl) : m_impl(std::move(impl)) {}

CrsChange::~CrsChange() = default;

std::unique_ptr<CrsChange> CrsChange::between(const std::string& from, const std::string& to)
{
    auto impl = std::make_unique<Impl>();
    impl->context = proj::makeContext();
    PJ_CONTEXT* const context = impl->context.get();
    if (context == nullptr) return nullptr;
    const proj::Object a = objectOf(context, from), b = objectOf(context, to);
    if (!a || !b) return nullptr;
    const proj::Object change(proj_create_crs_to_crs_from_pj(context, a.get(), b.get(), nullptr, nullptr));
    if (!change) return nullptr;
    impl->change.reset(proj_normalize_for_visualization(context, change.get()));
    if (!impl->change) return nullptr;
    return std::unique_ptr<CrsChange>(new CrsChange(std::move(impl)));
}

void CrsChange::operator()(std::span<glm::dvec3> points) const
{
    if (points.empty()) return;
    constexpr std::size_t kStep = sizeof(glm::dvec3);
    proj_trans_generic(m_impl->change.get(), PJ_FWD, &points[0].x, kStep, points.size(), &points[0].y, kStep,
                       points.size(), &points[0].z, kStep, points.size(), nullptr, 0, 0);
    for (glm::dvec3& p : points)
        if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
            p = glm::dvec3(std::numeric_limits<double>::quiet_NaN());
}

bool sameCrs(const std::string& a, const std::string& b)
{
    if (a == b) return true;
    const proj::Context context = proj::makeContext();
    if (!context) return false;
    const proj::Object x = objectOf(context.get(), a), y = objectOf(context.get(), b);
    return x && y &&
           proj_is_equivalent_to_with_ctx(context.get(), x.get(), y.get(),
                                          PJ_COMP_EQUIVALENT_EXCEPT_AXIS_ORDER_GEOGCRS) != 0;
}

bool isInUnitsOf(const CoordinateUnits& units, const std::string& crs)
{
    constexpr double kSame = 1e-7;
    if (units.horizontalSize <= 0.0) return true;
    const proj::Context context = proj::makeContext();
    if (!context) return true;
    proj::Object object = objectOf(context.get(), crs);
    if (object && proj_get_type(object.get()) == PJ_TYPE_COMPOUND_CRS)
        object.reset(proj_crs_get_sub_crs(context.get(), object.get(), 0));
    if (object && proj_get_type(object.get()) == PJ_TYPE_BOUND_CRS)
        object.reset(proj_get_source_crs(context.get(), object.get()));
    const double size = object ? proj::unitOfAxis(context.get(), object.get(), 0).size : 0.0;
    return size <= 0.0 || std::abs(size / units.horizontalSize - 1.0) < kSame;
}

std::string crsName(const std::string& crs)
{
    const proj::Context context = proj::makeContext();
    if (!context) return crs;
    const proj::Object object = objectOf(context.get(), crs);
    const char* const name = object ? proj_get_name(object.get()) : nullptr;
    return name != nullptr && *name != '\0' ? std::string(name) : crs;
}

}  // namespace punctum::las
