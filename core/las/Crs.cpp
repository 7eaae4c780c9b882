// SPDX-License-Identifier: MIT
#include "core/las/Crs.h"

#include "core/las/GeoKeys.h"
#include "core/las/SourceFile.h"

#include <algorithm>
#include <vector>

namespace punctum::las
{

namespace
{

std::string upper(std::string text)
{
    for (char& c : text)
        if (c >= 'a' && c <= 'z') c = char(c - 'a' + 'A');
    return text;
}

std::string lengthUnit(const std::string& name)
{
    const std::string u = upper(name);
    return u.find("FOOT") != std::string::npos || u.find("FEET") != std::string::npos || u.starts_with("FT") ? "ft"
                                                                                                             : "m";
}

/// Text of the record up to the first NUL, if it looks like WKT at all.
std::string wktText(const Vlr& record)
{
    std::string text(reinterpret_cast<const char*>(record.data.data()), record.data.size());
    text.resize(std::min(text.find('\0'), text.size()));
    const bool printable = std::all_of(text.begin(), text.end(), [](char ch) {
        const auto c = static_cast<unsigned char>(ch);
        return c >= 0x20 || c == '\n' || c == '\r' || c == '\t';
    });
    const std::size_t start = text.find_first_not_of(" \t\r\n");
    if (!printable || start == std::string::npos || text.find('[') == std::string::npos) return {};
    const char c = text[start];
    if (!((c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'))) return {};
    return text;
}

/// Name in quotes of the last UNIT that stands directly inside the first element of one of these kinds.
/// Empty when there is no such element.
std::string unitInside(const std::string& wkt, std::initializer_list<const char*> kinds)
{
    const std::string text = upper(wkt);
    std::size_t begin = std::string::npos;
    for (const char* kind : kinds) {
        const std::size_t found = text.find(std::string(kind) + "[");
        begin = std::min(begin, found);
    }
    if (begin == std::string::npos) return {};
    int depth = 0;
    std::string unit;
    for (std::size_t i = text.find('[', begin); i < text.size(); ++i) {
        if (text[i] == '"') {
            i = text.find('"', i + 1);
            if (i == std::string::npos) break;
        } else if (text[i] == '[') {
            ++depth;
        } else if (text[i] == ']') {
            if (--depth == 0) break;
        } else if (depth == 1 &&
                   (text.compare(i, 6, "UNIT[\"") == 0 || text.compare(i, 12, "LENGTHUNIT[\"") == 0)) {
            const std::size_t quote = text.find('"', i);
            const std::size_t end = text.find('"', quote + 1);
            if (end == std::string::npos) break;
            unit = text.substr(quote + 1, end - quote - 1);
            i = text.find('[', i) - 1;
        }
    }
    return unit.empty() ? "METRE" : unit;
}

bool readWkt(const Vlr& record, CrsInfo& info)
{
    info.text = wktText(record);
    if (info.text.empty()) return false;
    const std::string projected =
        unitInside(info.text, {"PROJCS", "PROJCRS", "PROJECTEDCRS", "ENGCRS", "LOCAL_CS"});
    const std::string vertical = unitInside(info.text, {"VERT_CS", "VERTCRS", "VERTICALCRS"});
    const std::string kind = upper(info.text);
    if (!projected.empty())
        info.horizontalUnit = lengthUnit(projected);
    else if (kind.find("GEOGCS[") != std::string::npos || kind.find("GEOGCRS[") != std::string::npos ||
             kind.find("GEODCRS[") != std::string::npos)
        info.horizontalUnit = "deg";
    if (!vertical.empty())
        info.verticalUnit = lengthUnit(vertical);
    else
        info.verticalUnit = info.horizontalUnit == "deg" ? "m" : info.horizontalUnit;
    return true;
}

std::string geoTiffUnit(std::uint16_t code)
{
    return code == 9002 || code == 9003 ? "ft" : "m";
}

bool readGeoTiff(const Vlr& record, const Vlr* ascii, CrsInfo& info)
{
    const GeoKeys keys(record, ascii);
    const bool geographic = keys.geographic();
    const std::uint16_t code = keys.number(geographic ? geo::kGeographicType : geo::kProjectedType);
    std::string citation = keys.text(geographic ? geo::kGeographicCitation : geo::kProjectedCitation);
    if (citation.empty()) citation = keys.text(geo::kCitation);
    if (code != 0 && code != geo::kUserDefined) {
        info.text = "EPSG:" + std::to_string(code);
        if (!citation.empty()) info.text += " (" + citation + ")";
    } else {
        info.text = citation;
    }
    info.horizontalUnit = geographic ? "deg" : geoTiffUnit(keys.number(geo::kLinearUnits));
    const std::uint16_t vertical = keys.number(geo::kVerticalUnits);
    info.verticalUnit = vertical != 0 ? geoTiffUnit(vertical) : geographic ? "m" : info.horizontalUnit;
    return !info.text.empty();
}

}  // namespace

CrsInfo readCrs(const SourceFile& source)
{
    const Vlr* wkt = source.findVlr(geo::kUser, geo::kWktId);
    if (wkt == nullptr) wkt = source.findVlr("liblas", geo::kWktId);
    const Vlr* keys = source.findVlr(geo::kUser, geo::kKeysId);
    const Vlr* ascii = source.findVlr(geo::kUser, geo::kAsciiId);
    const bool wktFirst = source.header.says(encoding::kWkt) || isExtendedFormat(source.layout.shownFormat());

    CrsInfo info;
    const auto tryWkt = [&] { return wkt != nullptr && readWkt(*wkt, info); };
    const auto tryKeys = [&] { return keys != nullptr && readGeoTiff(*keys, ascii, info); };
    const bool found = wktFirst ? tryWkt() || tryKeys() : tryKeys() || tryWkt();
    if (!found) {
        info.text.clear();
        // Keys that are sound but name nothing are no damage.
        const bool soundKeys = keys != nullptr && GeoKeys(*keys, ascii).sound();
        info.unreadable =
            (wkt != nullptr && !wkt->data.empty()) || (keys != nullptr && !keys->data.empty() && !soundKeys);
    }
    return info;
}

}  // namespace punctum::las
