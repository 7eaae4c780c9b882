// SPDX-License-Identifier: MIT
#include "core/las/GeoKeys.h"

#include "core/las/Proj.h"
#include "core/las/SourceFile.h"

#include <algorithm>
#include <cstring>

namespace punctum::las
{

namespace
{

constexpr std::uint16_t kMetre = 9001, kFoot = 9002, kSurveyFoot = 9003;

}  // namespace

GeoKeys::GeoKeys(const Vlr& keys, const Vlr* ascii, const Vlr* doubles)
{
    m_words.resize(keys.data.size() / 2);
    if (!m_words.empty()) std::memcpy(m_words.data(), keys.data.data(), m_words.size() * 2);
    if (ascii != nullptr) m_ascii.assign(reinterpret_cast<const char*>(ascii->data.data()), ascii->data.size());
    if (doubles != nullptr) {
        m_doubles.resize(doubles->data.size() / sizeof(double));
        if (!m_doubles.empty())
            std::memcpy(m_doubles.data(), doubles->data.data(), m_doubles.size() * sizeof(double));
    }
}

std::uint16_t GeoKeys::number(std::uint16_t id) const
{
    const std::uint16_t* key = find(id);
    return key != nullptr && key[1] == 0 ? key[3] : std::uint16_t(0);
}

double GeoKeys::real(std::uint16_t id) const
{
    const std::uint16_t* key = find(id);
    return key != nullptr && key[1] == geo::kDoublesId && key[3] < m_doubles.size() ? m_doubles[key[3]] : 0.0;
}

std::string GeoKeys::text(std::uint16_t id) const
{
    const std::uint16_t* key = find(id);
    if (key == nullptr || key[1] != geo::kAsciiId || key[3] >= m_ascii.size()) return {};
    const std::string raw = m_ascii.substr(key[3], key[2]);
    std::string t = fixedText(std::as_bytes(std::span(raw)));
    while (!t.empty() && (t.back() == '|' || t.back() == ' ')) t.pop_back();
    return t;
}

const std::uint16_t* GeoKeys::find(std::uint16_t id) const
{
    if (m_words.size() < 8) return nullptr;
    // The count in the header may be anything; the record's size decides.
    const std::size_t count = std::min<std::size_t>(m_words[3], m_words.size() / 4 - 1);
    for (std::size_t k = 1; k <= count; ++k)
        if (m_words[k * 4] == id) return &m_words[k * 4];
    return nullptr;
}

std::uint16_t verticalSystem(std::uint16_t code, std::uint16_t unit) noexcept
{
    struct Old {
        std::uint16_t code, unit, system;
    };
    constexpr Old kOld[] = {{5103, kMetre, 5703}, {5103, 0, 5703},           {5103, kSurveyFoot, 6360},
                            {5103, kFoot, 8228},  {5102, kSurveyFoot, 5702}, {5102, kMetre, 7968}};
    for (const Old& old : kOld)
        if (old.code == code && old.unit == unit) return old.system;
    return code;
}

std::string wktOf(const GeoKeys& keys, std::string& name)
{
    const proj::Context context = proj::makeContext();
    if (!context) return {};

    const bool geographic = keys.geographic();
    const std::uint16_t code = keys.number(geographic ? geo::kGeographicType : geo::kProjectedType);
    if (!keys.sound() || code == 0 || code == geo::kUserDefined) return {};
    proj::Object crs = proj::fromCode(context.get(), code);
    if (!crs) return {};
    const PJ_TYPE type = proj_get_type(crs.get());
    if (type != (geographic ? PJ_TYPE_GEOGRAPHIC_2D_CRS : PJ_TYPE_PROJECTED_CRS)) return {};
    const std::uint16_t unit = proj::unitOfAxis(context.get(), crs.get(), 0).code;
    const std::uint16_t stated = keys.number(geo::kLinearUnits);
    if (!geographic && stated != 0 && stated != unit) return {};

    const std::uint16_t vertical = keys.number(geo::kVerticalType);
    const std::uint16_t verticalUnit = keys.number(geo::kVerticalUnits);
    if (vertical != 0) {
        const std::uint16_t heightCode = verticalSystem(vertical, verticalUnit);
        const proj::Object height = proj::fromCode(context.get(), heightCode);
        if (!height || proj_get_type(height.get()) != PJ_TYPE_VERTICAL_CRS) return {};
        if (verticalUnit != 0 && verticalUnit != proj::unitOfAxis(context.get(), height.get(), 0).code) return {};
        const std::string both = "EPSG:" + std::to_string(code) + "+" + std::to_string(heightCode);
        crs.reset(proj_create(context.get(), both.c_str()));
        if (!crs) return {};
    } else if (verticalUnit != 0 && verticalUnit != (geographic ? kMetre : unit)) {
        return {};  // heights in a unit that WKT has no place for without a vertical system
    }
    const char* const wkt = proj_as_wkt(context.get(), crs.get(), PJ_WKT1_GDAL, nullptr);
    if (wkt == nullptr) return {};
    name = proj_get_name(crs.get());
    std::string text;  // in one line, as other programs write it
    for (const char* p = wkt; *p != '\0'; ++p) {
        if (*p != '\n')
            text += *p;
        else
            while (p[1] == ' ') ++p;
    }
    return text;
}

std::vector<std::byte> keysOf(const std::string& wkt, std::string& name)
{
    const proj::Context context = proj::makeContext();
    if (!context || wkt.empty()) return {};
    proj::Object crs(proj_create_from_wkt(context.get(), wkt.c_str(), nullptr, nullptr, nullptr));
    if (crs && proj_get_type(crs.get()) == PJ_TYPE_BOUND_CRS)
        crs.reset(proj_get_source_crs(context.get(), crs.get()));
    if (!crs) return {};
    name = proj_get_name(crs.get());
    proj::Object height;
    if (proj_get_type(crs.get()) == PJ_TYPE_COMPOUND_CRS) {
        height.reset(proj_crs_get_sub_crs(context.get(), crs.get(), 1));
        crs.reset(proj_crs_get_sub_crs(context.get(), crs.get(), 0));
        if (!height || !crs) return {};
    }
    const bool projected = proj_get_type(crs.get()) == PJ_TYPE_PROJECTED_CRS;
    if (!projected && proj_get_type(crs.get()) != PJ_TYPE_GEOGRAPHIC_2D_CRS) return {};
    const std::uint16_t code = proj::codeOf(context.get(), crs.get());
    const std::uint16_t heightCode = height ? proj::codeOf(context.get(), height.get()) : std::uint16_t(0);
    if (code == 0 || (height && heightCode == 0)) return {};
    const auto unitOf = [&](const PJ* part) {
        const std::uint16_t own = proj::codeOf(context.get(), part);
        const proj::Object known = proj::fromCode(context.get(), own);
        return proj::unitOfAxis(context.get(), known.get(), 0).code;
    };
    std::vector<std::uint16_t> words{1, 1, 0, 0};
    const auto add = [&](std::uint16_t id, std::uint16_t value) {
        words.insert(words.end(), {id, 0, 1, value});
        ++words[3];
    };
    add(geo::kModelType, projected ? geo::kModelProjected : geo::kModelGeographic);
    add(projected ? geo::kProjectedType : geo::kGeographicType, code);
    if (projected) add(geo::kLinearUnits, unitOf(crs.get()));
    if (height) {
        add(geo::kVerticalType, heightCode);
        add(geo::kVerticalUnits, unitOf(height.get()));
    }
    std::vector<std::byte> bytes(words.size() * sizeof(std::uint16_t));
    std::memcpy(bytes.data(), words.data(), bytes.size());
    return bytes;
}

}  // namespace punctum::las
