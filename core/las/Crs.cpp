// SPDX-License-Identifier: MIT
#include "core/las/Crs.h"

#include "core/las/SourceFile.h"

#include <algorithm>
#include <vector>

namespace punctum::las
{

namespace
{

constexpr std::uint16_t kWktId = 2112, kGeoKeysId = 34735, kGeoAsciiId = 34737;
constexpr const char* kProjection = "LASF_Projection";

// GeoTIFF 1.1, annex B
constexpr std::uint16_t kModelType = 1024, kCitation = 1026, kGeographicType = 2048, kGeographicCitation = 2049,
                        kProjectedType = 3072, kProjectedCitation = 3073, kLinearUnits = 3076,
                        kVerticalUnits = 4099;
constexpr std::uint16_t kUserDefined = 32767, kModelGeographic = 2;

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

/// GeoTIFF keys: four u16 a key (id, where, count, value), after four of header.
class GeoKeys
{
public:
    GeoKeys(const Vlr& keys, const Vlr* ascii)
    {
        m_words.resize(keys.data.size() / 2);
        if (!m_words.empty()) std::memcpy(m_words.data(), keys.data.data(), m_words.size() * 2);
        if (ascii != nullptr) {
            m_ascii.assign(reinterpret_cast<const char*>(ascii->data.data()), ascii->data.size());
        }
    }
    /// Whether the header of the keys is what GeoTIFF asks for.
    bool sound() const { return m_words.size() >= 4 && m_words[0] == 1; }
    std::uint16_t number(std::uint16_t id) const
    {
        const std::uint16_t* key = find(id);
        return key != nullptr && key[1] == 0 ? key[3] : std::uint16_t(0);
    }
    std::string text(std::uint16_t id) const
    {
        const std::uint16_t* key = find(id);
        if (key == nullptr || key[1] != kGeoAsciiId || key[3] >= m_ascii.size()) return {};
        const std::string raw = m_ascii.substr(key[3], key[2]);
        std::string t = fixedText(std::as_bytes(std::span(raw)));
        while (!t.empty() && (t.back() == '|' || t.back() == ' ')) t.pop_back();
        return t;
    }

private:
    const std::uint16_t* find(std::uint16_t id) const
    {
        if (m_words.size() < 8) return nullptr;
        // The count in the header may be anything; the record's size decides.
        const std::size_t count = std::min<std::size_t>(m_words[3], m_words.size() / 4 - 1);
        for (std::size_t k = 1; k <= count; ++k)
            if (m_words[k * 4] == id) return &m_words[k * 4];
        return nullptr;
    }
    std::vector<std::uint16_t> m_words;
    std::string m_ascii;
};

std::string geoTiffUnit(std::uint16_t code)
{
    return code == 9002 || code == 9003 ? "ft" : "m";
}

bool readGeoTiff(const Vlr& record, const Vlr* ascii, CrsInfo& info)
{
    const GeoKeys keys(record, ascii);
    const bool geographic = keys.number(kModelType) == kModelGeographic;
    const std::uint16_t code = keys.number(geographic ? kGeographicType : kProjectedType);
    std::string citation = keys.text(geographic ? kGeographicCitation : kProjectedCitation);
    if (citation.empty()) citation = keys.text(kCitation);
    if (code != 0 && code != kUserDefined) {
        info.text = "EPSG:" + std::to_string(code);
        if (!citation.empty()) info.text += " (" + citation + ")";
    } else {
        info.text = citation;
    }
    info.horizontalUnit = geographic ? "deg" : geoTiffUnit(keys.number(kLinearUnits));
    const std::uint16_t vertical = keys.number(kVerticalUnits);
    info.verticalUnit = vertical != 0 ? geoTiffUnit(vertical) : geographic ? "m" : info.horizontalUnit;
    return !info.text.empty();
}

}  // namespace

CrsInfo readCrs(const SourceFile& source)
{
    const Vlr* wkt = source.findVlr(kProjection, kWktId);
    if (wkt == nullptr) wkt = source.findVlr("liblas", kWktId);
    const Vlr* keys = source.findVlr(kProjection, kGeoKeysId);
    const Vlr* ascii = source.findVlr(kProjection, kGeoAsciiId);
    const bool wktFirst = (source.header.globalEncoding() & 16) != 0 || isExtendedFormat(source.layout.format);

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
