// SPDX-License-Identifier: MIT
#include "core/las/Crs.h"

#include "core/las/GeoKeys.h"
#include "core/las/Proj.h"
#include "core/las/SourceFile.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

namespace punctum::las
{

namespace
{

using Kind = CoordinateUnits::Kind;

constexpr std::size_t kLongestWkt = 1 << 20;  ///< bytes; real ones have a few thousand

/// The record's text: up to the first NUL, without a byte order mark and blanks at its ends.
std::string wktText(const Vlr& record)
{
    const char* const begin = reinterpret_cast<const char*>(record.data.data());
    std::string_view text(begin, std::min(record.data.size(), kLongestWkt));
    text = text.substr(0, text.find('\0'));
    constexpr std::string_view kMark = "\xEF\xBB\xBF", kBlanks = " \t\r\n\v\f";
    if (text.starts_with(kMark)) text.remove_prefix(kMark.size());
    const std::size_t first = text.find_first_not_of(kBlanks);
    if (first == std::string_view::npos) return {};
    return std::string(text.substr(first, text.find_last_not_of(kBlanks) - first + 1));
}

/// Whether people can read it, at least.
bool isPlainText(const std::string& text)
{
    return text.find('[') != std::string::npos && std::all_of(text.begin(), text.end(), [](char ch) {
               const auto c = static_cast<unsigned char>(ch);
               return c >= 0x20 || c == '\n' || c == '\r' || c == '\t';
           });
}

std::string nameOf(const proj::Unit& unit)
{
    if (!unit.angle) return lengthName(unit.size, unit.name);
    constexpr double kDegree = 0.017453292519943295;
    return std::abs(unit.size / kDegree - 1.0) < 1e-6 ? "deg" : unit.name;
}

void setHorizontal(CoordinateUnits& units, const proj::Unit& unit)
{
    units.horizontal = nameOf(unit);
    units.horizontalSize = unit.size;
    units.kind = unit.angle ? Kind::Degrees : Kind::Lengths;
}

void setVertical(CoordinateUnits& units, const proj::Unit& unit)
{
    if (unit.angle || unit.size <= 0.0) return;
    units.vertical = nameOf(unit);
    units.verticalSize = unit.size;
}

/// Heights of which nothing is said: in the unit of X and Y, or in meters beside angles (LAS 1.4 R15, 2.6).
void assumeVertical(CoordinateUnits& units)
{
    if (units.verticalSize > 0.0 || units.kind == Kind::Unknown) return;
    const bool angles = units.kind == Kind::Degrees;
    units.vertical = angles ? "m" : units.horizontal;
    units.verticalSize = angles ? 1.0 : units.horizontalSize;
}

/// Units of a coordinate system of any kind; those that are not said in it stay unknown.
void addUnits(PJ_CONTEXT* context, const PJ* crs, CoordinateUnits& units)
{
    switch (proj_get_type(crs)) {
        case PJ_TYPE_BOUND_CRS:
            if (const proj::Object inner{proj_get_source_crs(context, crs)}) addUnits(context, inner.get(), units);
            return;
        case PJ_TYPE_COMPOUND_CRS:
            for (int k = 0; k < 3; ++k)
                if (const proj::Object part{proj_crs_get_sub_crs(context, crs, k)})
                    addUnits(context, part.get(), units);
            return;
        case PJ_TYPE_VERTICAL_CRS:
            setVertical(units, proj::unitOfAxis(context, crs, 0));
            return;
        case PJ_TYPE_GEOCENTRIC_CRS:
            setHorizontal(units, proj::unitOfAxis(context, crs, 0));
            setVertical(units, proj::unitOfAxis(context, crs, 2));
            units.kind = Kind::Geocentric;
            return;
        case PJ_TYPE_TEMPORAL_CRS:
            return;
        default:
            if (const proj::Unit unit = proj::unitOfAxis(context, crs, 0); unit.size > 0.0) {
                setHorizontal(units, unit);
                setVertical(units, proj::unitOfAxis(context, crs, 2));
            }
    }
}

/// "The record ... cannot be understood", with PROJ's reason where that is short enough to be one.
std::string notUnderstood(const std::string& reason)
{
    return "The record on the coordinate system cannot be understood" +
           (reason.empty() ? "" : " (" + reason + ")") + "; its units are unknown.";
}

std::string firstOf(PROJ_STRING_LIST list)
{
    constexpr std::size_t kLongest = 80;
    const std::string text = list != nullptr && *list != nullptr ? *list : "";
    return text.size() <= kLongest && text.find('\n') == std::string::npos && isPlainText(text + "[") ? text : "";
}

/// What a record of WKT says. `info` is left as it is when that is nothing.
bool readWkt(PJ_CONTEXT* context, const Vlr& record, CrsInfo& info, std::string& reason)
{
    const std::string text = wktText(record);
    if (text.empty()) return false;
    const char* const options[] = {"STRICT=NO", nullptr};
    PROJ_STRING_LIST warnings = nullptr, errors = nullptr;
    const proj::Object crs(proj_create_from_wkt(context, text.c_str(), options, &warnings, &errors));
    if (!crs) reason = firstOf(errors);
    proj_string_list_destroy(warnings);
    proj_string_list_destroy(errors);
    if (!crs || proj_is_crs(crs.get()) == 0) {
        if (reason.empty() && !crs) reason = "it is no WKT";
        return false;
    }
    info.text = text;
    reason.clear();
    addUnits(context, crs.get(), info.units);
    return true;
}

/// The unit that the keys state; unknown when they do not. `size`: the key of its size, where a user defined it.
proj::Unit statedUnit(PJ_CONTEXT* context, const GeoKeys& keys, std::uint16_t id, std::uint16_t size, bool angle)
{
    proj::Unit unit;
    const std::uint16_t code = keys.number(id);
    if (code == geo::kUserDefined && size != 0) {
        const double value = keys.real(size);
        if (std::isfinite(value) && value > 0.0) unit = {value, "user-defined unit", 0, angle};
    } else if (code != 0) {
        unit = proj::unitOfCode(context, code);
    }
    return unit.angle == angle ? unit : proj::Unit{};
}

/// ESRI's programs write the system's WKT into a citation.
proj::Object fromCitation(PJ_CONTEXT* context, const std::string& citation)
{
    const std::size_t begin = citation.find("ESRI PE String = ");
    if (begin == std::string::npos) return {};
    proj::Object crs(
        proj_create_from_wkt(context, citation.c_str() + citation.find('=', begin) + 2, nullptr, nullptr, nullptr));
    return crs && proj_is_crs(crs.get()) != 0 ? std::move(crs) : proj::Object{};
}

bool readGeoTiff(PJ_CONTEXT* context, const GeoKeys& keys, CrsInfo& info)
{
    const bool geographic = keys.geographic(), geocentric = keys.geocentric();
    const std::uint16_t code = keys.number(geographic || geocentric ? geo::kGeographicType : geo::kProjectedType);
    std::string citation = keys.text(geographic ? geo::kGeographicCitation : geo::kProjectedCitation);
    if (citation.empty()) citation = keys.text(geo::kCitation);
    const bool coded = code != 0 && code != geo::kUserDefined;
    info.text = citation;
    if (coded) info.text = "EPSG:" + std::to_string(code) + (citation.empty() ? "" : " (" + citation + ")");

    proj::Object crs = coded ? proj::fromCode(context, code) : fromCitation(context, citation);
    if (coded && !crs) {
        if (proj::hasDatabase(context))
            info.warnings.push_back("The coordinate system EPSG:" + std::to_string(code) + " is not known.");
        else
            info.warnings.push_back(
                "The database of the PROJ library (proj.db) is not found, so that EPSG:" + std::to_string(code) +
                " cannot be looked up: install it (package proj-data), or name its folder in "
                "PROJ_DATA.");
    }
    CoordinateUnits& units = info.units;
    if (geocentric) {
        proj::Unit unit = statedUnit(context, keys, geo::kGeographicLinearUnits, 0, false);
        if (unit.size <= 0.0) unit = {1.0, "metre", 0, false};
        setHorizontal(units, unit);
        setVertical(units, unit);
        units.kind = Kind::Geocentric;
        return !info.text.empty();
    }
    if (crs) addUnits(context, crs.get(), units);
    const proj::Unit stated = geographic
                                  ? statedUnit(context, keys, geo::kAngularUnits, geo::kAngularUnitSize, true)
                                  : statedUnit(context, keys, geo::kLinearUnits, geo::kLinearUnitSize, false);
    // A geographic system is meant in degrees by its code; the key is about the angles in other keys.
    if (stated.size > 0.0 && !(geographic && units.kind == Kind::Degrees)) {
        const std::string own = units.kind == Kind::Lengths ? units.horizontal : "";
        setHorizontal(units, stated);
        if (coded && !own.empty() && own != units.horizontal)
            info.warnings.push_back("The coordinate system EPSG:" + std::to_string(code) + " is in " + own +
                                    ", but the file states " + units.horizontal + ", which is believed.");
    }
    const std::uint16_t vertical = keys.number(geo::kVerticalType);
    const proj::Unit height = statedUnit(context, keys, geo::kVerticalUnits, 0, false);
    if (height.size > 0.0) {
        setVertical(units, height);
    } else if (vertical != 0 && vertical != geo::kUserDefined) {
        const proj::Object system = proj::fromCode(context, verticalSystem(vertical, 0));
        if (system && proj_get_type(system.get()) == PJ_TYPE_VERTICAL_CRS)
            setVertical(units, proj::unitOfAxis(context, system.get(), 0));
    }
    return !info.text.empty() || units.kind != Kind::Unknown;
}

/// All of a file that tells of its coordinate system.
struct CrsRecords {
    const Vlr* wkt;
    const Vlr* keys;
    const Vlr* ascii;    ///< of the keys
    const Vlr* doubles;  ///< likewise
    bool wktFirst;

    explicit CrsRecords(const SourceFile& source)
        : wkt(source.findVlr(geo::kUser, geo::kWktId)),
          keys(source.findVlr(geo::kUser, geo::kKeysId)),
          ascii(source.findVlr(geo::kUser, geo::kAsciiId)),
          doubles(source.findVlr(geo::kUser, geo::kDoublesId)),
          wktFirst(source.header.says(encoding::kWkt) || isExtendedFormat(source.layout.shownFormat()))
    {
        if (wkt == nullptr) wkt = source.findVlr("liblas", geo::kWktId);
    }

    /// Equal where all that is read is equal.
    std::string key() const
    {
        std::string text(1, wktFirst ? 'w' : 'k');
        for (const Vlr* record : {wkt, keys, ascii, doubles}) {
            text += record == nullptr ? "-" : std::to_string(record->data.size()) + ":";
            if (record != nullptr)
                text.append(reinterpret_cast<const char*>(record->data.data()), record->data.size());
        }
        return text;
    }
};

CrsInfo readRecords(const CrsRecords& records)
{
    const auto& [wkt, keysRecord, ascii, doubles, wktFirst] = records;
    CrsInfo info;
    if (wkt == nullptr && keysRecord == nullptr) return info;
    const proj::Context plain = proj::makeContext(proj::Database::Unused), context = proj::makeContext();
    if (!plain || !context) return info;

    std::optional<GeoKeys> keys;
    if (keysRecord != nullptr) keys.emplace(*keysRecord, ascii, doubles);
    std::string reason;
    const auto tryWkt = [&, record = wkt] {
        return record != nullptr &&
               (readWkt(plain.get(), *record, info, reason) || readWkt(context.get(), *record, info, reason));
    };
    const auto tryKeys = [&] { return keys && readGeoTiff(context.get(), *keys, info); };
    if (!(wktFirst ? tryWkt() || tryKeys() : tryKeys() || tryWkt())) {
        info.text.clear();
        // A record of nothing, and keys that are sound but name nothing, are no damage.
        const std::string text = wkt != nullptr ? wktText(*wkt) : std::string();
        const bool damaged = keysRecord != nullptr && !keysRecord->data.empty() && !keys->sound();
        if (!text.empty() || damaged) info.warnings.push_back(notUnderstood(reason));
        if (isPlainText(text)) info.text = text;
    } else if (wktFirst && !reason.empty()) {
        info.warnings.push_back("The coordinate system in WKT cannot be understood (" + reason +
                                "); its GeoTIFF keys are used.");
    }
    assumeVertical(info.units);
    return info;
}

}  // namespace

CrsInfo readCrs(const SourceFile& source)
{
    return readRecords(CrsRecords(source));
}

CrsInfo KnownCrs::of(const SourceFile& source)
{
    const CrsRecords records(source);
    const std::string key = records.key();
    {
        const std::lock_guard lock(m_mutex);
        if (const auto known = m_known.find(key); known != m_known.end()) return known->second;
    }
    CrsInfo info = readRecords(records);
    const std::lock_guard lock(m_mutex);
    return m_known.emplace(key, std::move(info)).first->second;
}

CoordinateUnits likelyUnits(const CoordinateUnits& stated, const CoordinateScale& coordinates,
                            const WorldBounds& bounds, std::vector<std::string>& warnings)
{
    CoordinateUnits units = stated;
    if (bounds.empty()) return units;
    if (units.kind == Kind::Geocentric) {
        // Heights between the deepest trench and satellites just above the air.
        constexpr double kLeast = 6.34e6, kMost = 6.6e6;
        const double radius = glm::length((bounds.min + bounds.max) * 0.5) * units.horizontalSize;
        if (radius > kLeast && radius < kMost) {
            warnings.emplace_back(
                "The coordinate system is geocentric: X, Y and Z are from the middle of the earth, "
                "and Z is no height.");
        } else {
            units.kind = Kind::Lengths;
            warnings.emplace_back(
                "The coordinate system is geocentric by the file's word, but its points are not "
                "near the earth's surface; they are shown with Z upwards.");
        }
        return units;
    }
    if (units.kind != Kind::Unknown) return units;
    // Steps of 1e-5 degrees are a meter. Close scans have such steps as well, but then in all three axes, and are
    // not many times as high as wide.
    constexpr double kLargestStep = 1.0001e-5, kHeightStep = 50.0, kHeightRatio = 50.0;
    const glm::dvec3 step = glm::abs(coordinates.scale), size = bounds.max - bounds.min;
    const double across = std::max(size.x, size.y);
    const bool inRange =
        bounds.min.x >= -180.0 && bounds.max.x <= 360.0 && bounds.min.y >= -90.0 && bounds.max.y <= 90.0;
    const bool fine = step.x <= kLargestStep && step.y <= kLargestStep;
    const bool otherHeights = step.z >= kHeightStep * step.x || size.z >= kHeightRatio * across;
    if (!inRange || !fine || !otherHeights || across <= 0.0) return units;
    units = CoordinateUnits::degreesAndMeters();
    units.guessed = true;
    if (stated.verticalSize > 0.0) {
        units.vertical = stated.vertical;
        units.verticalSize = stated.verticalSize;
    }
    warnings.push_back(
        "No coordinate system is stated, but X and Y look like degrees of longitude and latitude; "
        "they are taken as such, and heights as " +
        units.vertical + ".");
    return units;
}

}  // namespace punctum::las
